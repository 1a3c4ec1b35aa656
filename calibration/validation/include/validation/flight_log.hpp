#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "online_controller/reference/reference_schedule.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// Messages that a controller node received and sent in one flight, without ROS types.
struct FlightLog {
  enum class EventKind {
    kOdometry,   ///< index into `odometry`
    kReference,  ///< index into `references`
    kSilence,    ///< index into `silences`
  };

  /// What the controller reacted to.
  struct Event {
    EventKind kind = EventKind::kOdometry;
    std::size_t index = 0;
  };

  /// A trajectory as it came in; see ReferenceSchedule::set.
  struct TimedReference {
    ReferenceTrajectory trajectory;
    std::optional<double> start;  ///< [s]; with the next odometry if there is none
  };

  struct Command {
    double stamp = 0.0;  ///< of the odometry that it answers [s]
    AttitudeCommand command;
  };

  /// The node's own account of a step.
  struct Status {
    double stamp = 0.0;  ///< of the odometry [s]
    ControlStatus status = ControlStatus::kNoReference;
    ControlReason reason = ControlReason::kNoReference;
    std::array<std::int64_t, 3> region{{-1, -1, -1}};  ///< used by each axis, or -1
    std::array<std::vector<double>, 3> theta;          ///< parameters of each axis, as assembled in flight
    double step_time = 0.0;                            ///< wall time of the control step in flight [s]
  };

  /// The disturbance that acted, as a simulator knows it.
  struct Disturbance {
    double stamp = 0.0;                                      ///< [s]
    Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< in W [m/s^2]
  };

  std::string source;  ///< file it came from, for messages and titles
  /// Every irregularity of the file, in sentences without its name.
  std::vector<std::string> remarks;
  std::vector<VehicleState> odometry;
  std::vector<TimedReference> references;
  std::vector<double> silences;  ///< times at which the node noticed silent odometry [s]
  std::vector<Event> events;     ///< in the order of the record
  std::vector<Command> commands;
  std::vector<Status> statuses;           ///< empty if not recorded
  std::vector<Disturbance> disturbances;  ///< empty if not recorded

  void add(const VehicleState& state) {
    events.push_back({EventKind::kOdometry, odometry.size()});
    odometry.push_back(state);
  }
  void add(ReferenceTrajectory trajectory, std::optional<double> start) {
    events.push_back({EventKind::kReference, references.size()});
    references.push_back({std::move(trajectory), start});
  }
  void addSilence(double stamp) {
    events.push_back({EventKind::kSilence, silences.size()});
    silences.push_back(stamp);
  }
};

}  // namespace polyfly
