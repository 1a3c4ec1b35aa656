#pragma once

#include <std_msgs/Header.h>

#include <Eigen/Core>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <vector>

#include "online_controller/laws/law_switch.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly_ros {

/// Times the stages of a control period, from its construction on.
class StageClock {
 public:
  /// Since the last call [ns].
  std::int64_t lap() noexcept {
    const Clock::time_point now = Clock::now();
    const auto spent = std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_).count();
    last_ = now;
    return spent;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

/// How long the stages of one control period took [ns].
struct StageTimes {
  /// Message to state, with references looked up.
  std::int64_t input = 0;
  /// Step of the law.
  std::int64_t step = 0;
  /// Command to message, published.
  std::int64_t output = 0;
  /// Status published, laws exchanged, next step prepared.
  std::int64_t prepare = 0;

  std::int64_t latency() const noexcept { return input + step + output; }
  std::int64_t whole() const noexcept { return latency() + prepare; }
};

/// One command, or the decision to send none, as it is reported after it was sent. Allocates only where a frame's name is
/// longer than those before.
struct Answered {
  /// Header of the command.
  std_msgs::Header header;
  polyfly::Law law{};
  polyfly::ControlReport report;
  /// True when the command of the report was sent.
  bool sends = false;
  StageTimes times;
  double odometry_age = 0.0;  ///< [s]
  /// Number of commands before this one.
  std::uint32_t sequence = 0;

  /// True: in answer to odometry. False: in its silence, or by the sticks.
  bool by_odometry = false;
  /// Odometry; valid only with `by_odometry`, like the next two members.
  polyfly::VehicleState state;
  /// True when the odometry was good enough to be flown on.
  bool accepted = false;
  /// Value of FlightSupervisor::restarted().
  bool restarted = false;
};

/// What the flight looked like after one step, for those who watch.
struct FlightSnapshot {
  Answered answered;
  double kkt_residual = -1.0;
  /// Time between the points of reference and prediction [s].
  double stage_period = 0.0;
  /// References, the first one at the sample; the first `reference_count` are valid.
  std::vector<polyfly::Reference> reference;
  /// Number of valid references; 0 without a reference.
  int reference_count = 0;
  /// Predicted positions in the world [m].
  std::vector<Eigen::Vector3d> predicted;
  int predicted_count = 0;
};

/// What the control thread counts and leaves for the other thread to read, without a lock.
struct FlightRecord {
  explicit FlightRecord(std::size_t points) : snapshot(blank(points)) {}

  /// The control thread's while a snapshot is wanted, then the other thread's until it wants the next one.
  FlightSnapshot snapshot;
  std::atomic<bool> wanted{true};
  /// True when a snapshot needs reference and prediction.
  std::atomic<bool> show_paths{false};
  /// True when commands were sent, since the start or since the vehicle landed.
  std::atomic<bool> commands{false};

  /// Number of odometry messages that were answered.
  std::atomic<std::int64_t> steps{0};
  /// Greatest time from odometry to command [ns].
  std::atomic<std::int64_t> greatest_latency{0};
  /// Greatest time of the law alone [ns].
  std::atomic<std::int64_t> greatest_step{0};
  /// Number of periods that took longer than the control period.
  std::atomic<std::int64_t> overruns{0};
  /// Number of samples that a map did not hold, see polyfly::isOutsideMap.
  std::atomic<std::int64_t> outside_map{0};
  /// Number of samples whose parameters were clipped to the maps' ranges.
  std::atomic<std::int64_t> clipped{0};
  /// Number of samples of the robust law at which no plan met all bounds.
  std::atomic<std::int64_t> without_plan{0};
  /// Number of odometry messages that are missing between two that came.
  std::atomic<std::int64_t> lost{0};

 private:
  static FlightSnapshot blank(std::size_t points) {
    FlightSnapshot snapshot;
    snapshot.reference.resize(points);
    snapshot.predicted.resize(points);
    return snapshot;
  }
};

}  // namespace polyfly_ros
