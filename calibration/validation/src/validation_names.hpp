#pragma once

#include <iterator>

#include "online_controller/types/types.hpp"

namespace polyfly {

// Words for what is counted, in the order of ControlStatus, LookupStatus and the fields of AttitudeCommand.
constexpr const char* kStatusNames[] = {"optimal",      "clipped",    "hold_last",      "level",
                                        "no_reference", "descend",    "stopped",        "manual",
                                        "motors_off",   "suboptimal", "least_violation"};
static_assert(std::size(kStatusNames) == kControlStatusCount, "each status has a name");
constexpr const char* kCommandNames[4] = {"roll", "pitch", "yaw_rate", "thrust"};
constexpr const char* kCommandUnits[4] = {"rad", "rad", "rad/s", "N"};
constexpr const char* kVerdictNames[] = {"passed", "doubtful", "failed"};
// In the order of Ignorance.
constexpr const char* kIgnoranceNames[] = {"begun_in_flight", "missing", "altered"};
constexpr const char* kCauseNames[4] = {"inside", "outside_box", "outside_partition", "not_finite"};

}  // namespace polyfly
