#include "online_controller/flight/flight_state.hpp"

#include <array>
#include <cstddef>

namespace polyfly {
namespace {

using State = FlightState;
using Event = FlightEvent;

constexpr std::array<const char*, kFlightStateCount> kStateNames{
    "Inactive", "TakeOff", "PositionHold", "Trajectory", "RemoteControl",
    "RcTeleOp", "Landing", "Landed",       "Failsafe"};

constexpr std::array<const char*, kFlightEventCount> kEventWords{
    "a pose came",
    "a trajectory came",
    "the trajectory has ended",
    "take-off was asked for",
    "the take-off height is reached",
    "the take-off height was not reached",
    "position hold was asked for",
    "landing was asked for",
    "it stands on the ground",
    "the remote control is in manual mode",
    "the sticks of the remote control were moved",
    "the remote control is in position mode",
    "the remote control is off or silent",
    "odometry is silent",
    "odometry is not usable",
    "the law has no answer",
    "the law answers again",
    "the autopilot is guided in the air",
    "the autopilot is not guided in the air any more",
};

constexpr const char* kPilotHasIt = "the remote control has the vehicle";
constexpr const char* kNoOdometry = "there is no fresh odometry";
constexpr const char* kNotFlying = "it does not fly";
constexpr const char* kFlies = "it flies already";
constexpr const char* kLands = "it lands";
constexpr const char* kIsLanded = "it has landed: take off first";
constexpr const char* kInFailsafe = "it is in failsafe";

bool lawFlies(State state) noexcept {
  switch (state) {
    case State::kTakeOff:
    case State::kPositionHold:
    case State::kTrajectory:
    case State::kTeleoperation:
    case State::kLanding:
      return true;
    case State::kInactive:
    case State::kRemoteControl:
    case State::kLanded:
    case State::kFailsafe:
      return false;
  }
  return false;
}

FlightTransition onReference(State state, State wanted, const FlightSituation& situation) noexcept {
  switch (state) {
    case State::kInactive:
      return situation.pilot ? FlightTransition{state, kPilotHasIt} : FlightTransition{wanted};
    case State::kPositionHold:
    case State::kTrajectory:
      return {wanted};
    case State::kTakeOff:   // flown when the height is reached
    case State::kFailsafe:  // flown when the data are back
      return {state};
    case State::kRemoteControl:
    case State::kTeleoperation:
      return {state, kPilotHasIt};
    case State::kLanding:
      return {state, kLands};
    case State::kLanded:
      return {state, kIsLanded};
  }
  return {state};
}

FlightTransition onTakeOff(State state, const FlightSituation& situation) noexcept {
  if (state != State::kInactive && state != State::kLanded) {
    return {state, state == State::kFailsafe        ? kInFailsafe
                   : state == State::kRemoteControl ? kPilotHasIt
                                                    : kFlies};
  }
  if (situation.pilot) return {state, kPilotHasIt};
  if (!situation.odometry) return {state, kNoOdometry};
  return {State::kTakeOff};
}

FlightTransition onHold(State state) noexcept {
  if (lawFlies(state)) return {State::kPositionHold};
  return {state, state == State::kFailsafe        ? kInFailsafe
                 : state == State::kRemoteControl ? kPilotHasIt
                                                  : kNotFlying};
}

FlightTransition onLand(State state) noexcept {
  if (lawFlies(state) || state == State::kFailsafe) {
    return {state == State::kFailsafe ? state : State::kLanding};  // a failsafe lands when the data are back
  }
  return {state, state == State::kRemoteControl ? kPilotHasIt : kNotFlying};
}

// Only from manual mode does the switch hand over to a law: a switch that is forgotten at a law's position starts none.
FlightTransition onSwitchAtPosition(State state, State wanted, const FlightSituation& situation) noexcept {
  if (state == State::kRemoteControl) return {situation.odometry ? wanted : state};
  if (wanted == State::kTeleoperation && lawFlies(state)) return {wanted};
  return {state};
}

FlightTransition onPilotLost(State state, const FlightSituation& situation) noexcept {
  if (state == State::kTeleoperation) return {State::kPositionHold};
  if (state != State::kRemoteControl) return {state};
  return {situation.odometry ? State::kLanding : State::kFailsafe};
}

}  // namespace

FlightTransition transition(State state, Event event, const FlightSituation& situation) noexcept {
  switch (event) {
    case Event::kPose:
      return onReference(state, State::kPositionHold, situation);
    case Event::kTrajectory:
      return onReference(state, State::kTrajectory, situation);
    case Event::kTrajectoryEnded:
      return {state == State::kTrajectory ? State::kPositionHold : state};
    case Event::kTakeOff:
      return onTakeOff(state, situation);
    case Event::kTakeOffDone:
      return {state == State::kTakeOff ? State::kPositionHold : state};
    case Event::kTakeOffFailed:
      return {state == State::kTakeOff ? State::kLanding : state};
    case Event::kHold:
      return onHold(state);
    case Event::kLand:
      return onLand(state);
    case Event::kTouchdown:
      return {state == State::kLanding ? State::kLanded : state};
    case Event::kManual:
      return {State::kRemoteControl};
    case Event::kSticks:
      return onSwitchAtPosition(state, State::kTeleoperation, situation);
    case Event::kSticksIdle:
      return onSwitchAtPosition(state, State::kPositionHold, situation);
    case Event::kPilotLost:
      return onPilotLost(state, situation);
    case Event::kSilence:
    case Event::kBadOdometry:
    case Event::kNoAnswer:
      return {lawFlies(state) ? State::kFailsafe : state};
    case Event::kRecovered:
      return {state == State::kFailsafe ? situation.interrupted : state};
    case Event::kGuided:
      return {state == State::kInactive && !situation.pilot ? State::kPositionHold : state};
    case Event::kGuidedEnded:
      return {state == State::kPositionHold || state == State::kFailsafe ? State::kInactive : state};
  }
  return {state};
}

bool isRequest(Event event) noexcept {
  return event == Event::kPose || event == Event::kTrajectory || event == Event::kTakeOff ||
         event == Event::kHold || event == Event::kLand;
}

const char* flightStateName(State state) noexcept { return kStateNames[static_cast<std::size_t>(state)]; }

const char* describe(Event event) noexcept { return kEventWords[static_cast<std::size_t>(event)]; }

}  // namespace polyfly
