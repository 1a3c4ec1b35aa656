#pragma once

#include <std_msgs/Header.h>

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <vector>

#include "online_controller/laws/law_switch.hpp"
#include "online_controller/realtime/latency_histogram.hpp"
#include "online_controller/realtime/triple_buffer.hpp"
#include "online_controller/types/types.hpp"
#include "online_controller_ros/answered.hpp"

namespace polyfly_ros {

/// What the flight looked like after one step, for those who watch.
struct FlightSnapshot {
  std_msgs::Header header;
  polyfly::Law law = polyfly::Law::kExplicitLinear;
  polyfly::ControlReport report;
  double kkt_residual = -1.0;
  double odometry_age = 0.0;  ///< [s]
  StageTimes times;
  double stage_period = 0.0;                  ///< between the points that follow [s]
  std::vector<polyfly::Reference> reference;  ///< the first one at the sample; as many as count
  int reference_count = 0;                    ///< 0 without a reference
  std::vector<Eigen::Vector3d> predicted;     ///< in the world [m]
  int predicted_count = 0;
};

/// What the control thread counts and leaves for the other thread to read, without a lock.
struct FlightRecord {
  explicit FlightRecord(std::size_t points) : latest(blank(points)) {}

  polyfly::TripleBuffer<FlightSnapshot> latest;
  std::atomic<bool> wanted{true};       ///< somebody waits for a snapshot
  std::atomic<bool> show_paths{false};  ///< with reference and prediction
  std::atomic<bool> commands{false};    ///< were sent, since the start or since it landed

  polyfly::LatencyHistogram latency;      ///< odometry to command
  polyfly::LatencyHistogram step;         ///< the law alone
  std::atomic<std::int64_t> overruns{0};  ///< periods that took longer than the control period
  std::atomic<std::int64_t> lost{0};      ///< odometry missing between two that came
  std::atomic<std::int64_t> waited{0};    ///< odometry that came while something else was done

 private:
  static FlightSnapshot blank(std::size_t points) {
    FlightSnapshot snapshot;
    snapshot.reference.resize(points);
    snapshot.predicted.resize(points);
    return snapshot;
  }
};

}  // namespace polyfly_ros
