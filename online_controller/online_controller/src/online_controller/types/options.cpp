#include "online_controller/types/options.hpp"

#include <algorithm>
#include <sstream>

#include "online_controller/types/flight_options.hpp"
#include "online_controller/types/moment_model.hpp"
#include "online_controller/types/node_options.hpp"
#include "online_controller/types/option_groups.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/options_text.hpp"
#include "polyfly_base/range_check.hpp"

namespace polyfly {
void checkOptions(const MultirotorOptions& options) {
  visitOptions(options, RangeCheck{});
  if (!(options.thrust_min < options.gravity && options.gravity < options.thrust_max)) {
    std::ostringstream text;
    text
        << "controller/thrust_min, controller/thrust_max: vehicle/gravity (hover) must lie between them, got "
        << options.thrust_min << " and " << options.thrust_max << " m/s^2";
    throw Error(text.str());
  }
}

void checkMomentModel(const MomentModel& moments) { visitMomentModel(moments, RangeCheck{}); }

void checkFlightOptions(const FlightOptions& options) { visitFlightOptions(options, RangeCheck{}); }

void checkOutputOptions(const OutputOptions& options) {
  if (!options.roll_pitch_yawrate_thrust && !options.attitude_target)
    throw Error("output: one of roll_pitch_yawrate_thrust and attitude_target must be true");
}

std::vector<std::string> ownGroups() {
  std::vector<std::string> groups(kOptionGroups.begin(), kOptionGroups.end());
  groups.erase(std::find(groups.begin(), groups.end(), kSharedGroup));
  return groups;
}

std::vector<std::string> knownGroups() {
  std::vector<std::string> groups(kOptionGroups.begin(), kOptionGroups.end());
  groups.push_back(kInForceGroup);
  return groups;
}

}  // namespace polyfly
