#pragma once

#include <array>
#include <string>
#include <vector>

namespace polyfly {

/// The group that may hold keys of mav_control_rw which are not read here.
constexpr const char* kSharedGroup = "KF_observer";

/// The groups of a multirotor controller's options, as parameters of its node and as keys of its YAML files.
constexpr std::array<const char*, 12> kOptionGroups{
    "vehicle",  "controller",        "linear", "nonlinear", kSharedGroup,      "maps", "robust_maps",
    "problems", "control_interface", "rc",     "output",    "reference_limits"};

/// Its options without a group; `provenance` is the text of `calibrate apply` on where numbers come from.
constexpr std::array<const char*, 4> kSingleOptions{"law", "odometry_frame", "use_rc_teleop", "provenance"};

/// The groups in which every key must be known.
std::vector<std::string> ownGroups();
/// The groups that a YAML file may have: kOptionGroups, and what a node tells of itself.
std::vector<std::string> knownGroups();

}  // namespace polyfly
