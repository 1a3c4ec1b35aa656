#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bags/recording_share.hpp"
#include "identification/header_clock.hpp"
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
    /// Stamp of the odometry that the command answers [s].
    double stamp = 0.0;
    AttitudeCommand command;
  };

  /// The node's own account of a step.
  struct Status {
    /// Stamp of the odometry [s].
    double stamp = 0.0;
    /// Number of steps before this one.
    std::uint32_t sequence = 0;
    ControlStatus status = ControlStatus::kNoReference;
    ControlReason reason = ControlReason::kNoReference;
    /// Region that each axis used; -1: none.
    std::array<std::int64_t, 3> region{{-1, -1, -1}};
    /// Parameters of each axis, as assembled in flight.
    std::array<std::vector<double>, 3> theta;
    /// Input of each axis, before anything of the vehicle is corrected [rad or m/s^2].
    std::array<double, 3> input{};
    /// The observer's estimate for each axis [m/s^2].
    std::array<double, 3> disturbance{};
    /// Wall time of the control step in flight [s].
    double step_time = 0.0;
  };

  /// The disturbance that acted, as a simulator knows it.
  struct Disturbance {
    double stamp = 0.0;  ///< [s]
    /// Acceleration in W [m/s^2].
    Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
  };

  /// The stamps of a topic against the recorder's times.
  struct TopicClock {
    std::string topic;
    HeaderClock clock;
    /// Receive time of the topic's first message [s].
    double start = 0.0;
  };

  /// All parameters of the controller as it told them, see validation/parameters_told.hpp.
  struct Parameters {
    /// Receive time of the recorder [s].
    double time = 0.0;
    /// YAML.
    std::string text;
  };

  /// File of the record, for messages and titles.
  std::string source;
  /// Every irregularity of the file, as clauses without its name.
  std::vector<std::string> remarks;
  /// How much of the recording was read, with the messages of the flight's topics. None if the log is no file.
  std::optional<RecordingShare> share;
  /// The parts that are known to be lost: stamps of the odometry before and after each [s].
  std::vector<TimeSpan> lost;
  /// What the stamps of odometry and commands are worth. Empty if the log is no file.
  std::vector<TopicClock> clocks;
  std::vector<VehicleState> odometry;
  std::vector<TimedReference> references;
  /// Times at which the node noticed silent odometry [s].
  std::vector<double> silences;
  /// Events in the order of the record.
  std::vector<Event> events;
  std::vector<Command> commands;
  /// Status messages. Empty if not recorded.
  std::vector<Status> statuses;
  /// Parameters in force. Empty if not recorded.
  std::vector<Parameters> parameters;
  /// True disturbances. Empty if not recorded.
  std::vector<Disturbance> disturbances;

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

  /// The last command with each stamp.
  std::map<double, const AttitudeCommand*> commandsByStamp() const {
    std::map<double, const AttitudeCommand*> by_stamp;
    for (const Command& command : commands) by_stamp[command.stamp] = &command.command;
    return by_stamp;
  }

  /// The account of each step by the stamp of its odometry. Those of silences are none.
  std::map<double, const Status*> statusesByStamp() const {
    std::map<double, const Status*> by_stamp;
    for (const Status& status : statuses) {
      if (status.reason != ControlReason::kStale) by_stamp[status.stamp] = &status;
    }
    return by_stamp;
  }
};

}  // namespace polyfly
