#pragma once

#include <cstdint>

namespace polyfly {

/// What the vehicle is about.
enum class FlightState : std::uint8_t {
  kInactive = 0,       ///< nothing has started it yet
  kTakeOff = 1,        ///< rises over the point where it stood
  kPositionHold = 2,   ///< holds a pose
  kTrajectory = 3,     ///< follows a trajectory
  kRemoteControl = 4,  ///< the sticks are attitude and thrust; no law flies
  kTeleoperation = 5,  ///< the sticks move the pose that is held
  kLanding = 6,        ///< descends until it stands
  kLanded = 7,         ///< stands, motors off
  kFailsafe = 8,       ///< no usable odometry or no answer of the law: see FailsafePolicy
};
constexpr int kFlightStateCount = 9;

/// What happens to it.
enum class FlightEvent : std::uint8_t {
  kPose = 0,             ///< a pose to hold came
  kTrajectory = 1,       ///< a trajectory came
  kTrajectoryEnded = 2,  ///< its last point is reached in time
  kTakeOff = 3,          ///< asked for
  kTakeOffDone = 4,
  kTakeOffFailed = 5,  ///< the height is not reached in twice its time
  kHold = 6,           ///< position hold is asked for
  kLand = 7,           ///< asked for
  kTouchdown = 8,
  kManual = 9,        ///< the pilot's mode switch stands at manual
  kSticks = 10,       ///< at position, with a stick moved
  kSticksIdle = 11,   ///< at position, sticks at rest
  kPilotLost = 12,    ///< the remote control is off or silent
  kSilence = 13,      ///< no odometry
  kBadOdometry = 14,  ///< odometry refused for longer than the last command is held
  kNoAnswer = 15,     ///< the law has no answer for longer than that
  kRecovered = 16,    ///< the law answers again
};
constexpr int kFlightEventCount = 17;

/// What a transition depends on besides state and event.
struct FlightSituation {
  bool pilot = false;                                    ///< the remote control is there, or is demanded
  bool odometry = false;                                 ///< the last odometry is fresh
  FlightState interrupted = FlightState::kPositionHold;  ///< what a failsafe goes on with
};

/// Where an event leads. An event that has no meaning in a state stays there; one that is asked for and must
/// not be granted says why.
struct FlightTransition {
  FlightState to = FlightState::kInactive;
  const char* refusal = nullptr;
};

FlightTransition transition(FlightState state, FlightEvent event, const FlightSituation& situation) noexcept;

/// `Inactive`, `TakeOff`, `PositionHold`, `Trajectory`, `RemoteControl`, `RcTeleOp`, `Landing`, `Landed`,
/// `Failsafe`: those that mav_control_rw has bear its names.
const char* flightStateName(FlightState state) noexcept;

/// "a trajectory came", for status and logs.
const char* describe(FlightEvent event) noexcept;

}  // namespace polyfly
