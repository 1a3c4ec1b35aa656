#pragma once

#include <string>

#include "polyfly_ros/parameter_reader.hpp"

namespace polyfly_ros {

/// The names of mav_control_rw for options of ours, so that a launch file and a YAML file written for that package start
/// this controller. `law` is `linear` or `nonlinear`; `gravity` [m/s^2].
LegacyNames legacyNames(const std::string& law, double gravity);

/// Why a parameter of that package is not read; nullptr where it is none of that package.
const char* whyUnread(const std::string& theirs);

}  // namespace polyfly_ros
