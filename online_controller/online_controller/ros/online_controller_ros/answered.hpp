#pragma once

#include <std_msgs/Header.h>

#include <cstdint>

#include "online_controller/laws/law_switch.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly_ros {

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

}  // namespace polyfly_ros
