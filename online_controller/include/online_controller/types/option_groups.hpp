#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace polyfly {

/// The group that may hold keys of mav_control_rw which are not read here.
constexpr const char* kSharedGroup = "KF_observer";

/// The groups of a multirotor controller's options, as parameters of its node and as keys of its YAML files.
constexpr std::array<const char*, 13> kOptionGroups{
    "vehicle", "controller",  "linear",          "nonlinear",         kSharedGroup,
    "maps",    "robust_maps", "problems",        "control_interface", "rc",
    "output",  "real_time",   "reference_limits"};

/// Its options without a group.
constexpr std::array<const char*, 3> kSingleOptions{"law", "odometry_frame", "use_rc_teleop"};

/// Which of the known names is meant by one that is none of them, but a slip away: apart from case, at most
/// two letters wrong, missing or too many where it has six or more, else one. Nothing where none is near.
std::optional<std::string> meantName(const std::string& name, const std::vector<std::string>& known);

}  // namespace polyfly
