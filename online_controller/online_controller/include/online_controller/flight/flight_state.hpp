#pragma once

#include <cstdint>

namespace polyfly {

/// What the vehicle is about.
enum class FlightState : std::uint8_t {
  /// Nothing has started the vehicle yet.
  kInactive = 0,
  /// The vehicle rises over the point where it stood.
  kTakeOff = 1,
  /// The vehicle holds a pose.
  kPositionHold = 2,
  /// The vehicle follows a trajectory.
  kTrajectory = 3,
  /// The sticks are attitude and thrust; no law flies.
  kRemoteControl = 4,
  /// The sticks move the pose that is held.
  kTeleoperation = 5,
  /// The vehicle descends until it stands.
  kLanding = 6,
  /// The vehicle stands, motors off.
  kLanded = 7,
  /// There is no usable odometry or no answer of the law: see FailsafePolicy.
  kFailsafe = 8,
};
constexpr int kFlightStateCount = 9;

/// What happens to it.
enum class FlightEvent : std::uint8_t {
  /// A pose to hold was received.
  kPose = 0,
  /// A trajectory was received.
  kTrajectory = 1,
  /// The time of the trajectory's last point is reached.
  kTrajectoryEnded = 2,
  /// A take-off is requested.
  kTakeOff = 3,
  kTakeOffDone = 4,
  /// The height is not reached in twice the take-off time.
  kTakeOffFailed = 5,
  /// Position hold is requested.
  kHold = 6,
  /// A landing is requested.
  kLand = 7,
  kTouchdown = 8,
  /// The pilot's mode switch is at manual.
  kManual = 9,
  /// The mode switch is at position, and a stick is moved.
  kSticks = 10,
  /// The mode switch is at position, and the sticks are at rest.
  kSticksIdle = 11,
  /// The remote control is off or silent.
  kPilotLost = 12,
  /// There is no odometry.
  kSilence = 13,
  /// Odometry was refused for longer than the last command is held.
  kBadOdometry = 14,
  /// The law had no answer for longer than the last command is held.
  kNoAnswer = 15,
  /// The law answers again.
  kRecovered = 16,
  /// The autopilot takes set-points in the air, and holds as long as nothing else is asked for.
  kGuided = 17,
  /// That has ended.
  kGuidedEnded = 18,
};
constexpr int kFlightEventCount = 19;

/// What a transition depends on besides state and event.
struct FlightSituation {
  /// True when the remote control is present, or is required.
  bool pilot = false;
  /// True when the last odometry is fresh.
  bool odometry = false;
  /// State to which a failsafe returns.
  FlightState interrupted = FlightState::kPositionHold;
};

/// Where an event leads. An event that has no meaning in a state stays there; one that is asked for and must
/// not be granted says why.
struct FlightTransition {
  FlightState to = FlightState::kInactive;
  const char* refusal = nullptr;
};

FlightTransition transition(FlightState state, FlightEvent event, const FlightSituation& situation) noexcept;

/// Whether a person or a planner asks for it. Everything else comes of itself.
bool isRequest(FlightEvent event) noexcept;

/// `Inactive`, `TakeOff`, `PositionHold`, `Trajectory`, `RemoteControl`, `RcTeleOp`, `Landing`, `Landed`,
/// `Failsafe`: those that mav_control_rw has bear its names.
const char* flightStateName(FlightState state) noexcept;

/// "a trajectory came", for status and logs.
const char* describe(FlightEvent event) noexcept;

}  // namespace polyfly
