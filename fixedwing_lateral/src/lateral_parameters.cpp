#include "fixedwing_lateral/lateral_parameters.hpp"

#include <vector>

#include "fixedwing_lateral/turn_limits.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/options_from_yaml.hpp"
#include "polyfly_base/options_text.hpp"

namespace polyfly {

void finishParameters(LateralParameters* parameters, const std::string& where) {
  if (parameters->loiter_direction == 0)
    throw Error(where + ": path/loiter_direction: must be 1 (right) or -1 (left)");
  parameters->guidance.loiter.direction =
      parameters->loiter_direction > 0 ? TurnDirection::kRight : TurnDirection::kLeft;
  tightTurnsOf(parameters->tight_turns, where + ": path/tight_turns");
  checkGuidance(parameters->guidance, where);
}

LateralParameters parseLateralParameters(const std::string& text, const std::string& source) {
  OptionsFromYaml reader(text, source);
  LateralParameters parameters;
  visitLateralParameters(parameters, reader);
  const std::vector<std::string> own(kLateralGroups.begin(), kLateralGroups.end());
  std::vector<std::string> known = own;
  known.push_back(kInForceGroup);
  reader.refuseUnknownGroups(known, {"provenance"});
  reader.refuseUnknownKeys(own);
  finishParameters(&parameters, source);
  return parameters;
}

}  // namespace polyfly
