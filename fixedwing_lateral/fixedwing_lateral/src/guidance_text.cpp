#include "fixedwing_lateral/guidance.hpp"

namespace polyfly {

const char* toString(GuidanceMode mode) noexcept {
  switch (mode) {
    case GuidanceMode::kTracking:
      return "tracking";
    case GuidanceMode::kHoldHorizon:
      return "flying the last horizon";
    case GuidanceMode::kUpwind:
      return "into the wind";
    case GuidanceMode::kLevel:
      return "wings level";
    case GuidanceMode::kStandby:
      return "standby";
    case GuidanceMode::kFallback:
      return "L1 guidance";
  }
  return "unknown";
}

const char* toString(GuidanceReason reason) noexcept {
  switch (reason) {
    case GuidanceReason::kNone:
      return "nominal";
    case GuidanceReason::kNotEngaged:
      return "the autopilot is in another mode";
    case GuidanceReason::kNoMission:
      return "no mission";
    case GuidanceReason::kNotFinite:
      return "a state that is not finite or rolled too far";
    case GuidanceReason::kStale:
      return "a stale state";
    case GuidanceReason::kJump:
      return "a jump of position, heading or roll";
    case GuidanceReason::kSolver:
      return "the optimisation failed";
    case GuidanceReason::kLowAirspeed:
      return "low airspeed";
    case GuidanceReason::kStrongWind:
      return "wind near or above the airspeed";
    case GuidanceReason::kAirspeedAssumed:
      return "no airspeed: the nominal one is assumed";
    case GuidanceReason::kWindAssumed:
      return "no wind estimate: taken from the ground velocity";
    case GuidanceReason::kTooSteep:
      return "the segment asks for more roll in this wind than is allowed";
    case GuidanceReason::kNotConverging:
      return "the optimisation does not lead to the path: check model, airspeed and weights";
  }
  return "unknown";
}

}  // namespace polyfly
