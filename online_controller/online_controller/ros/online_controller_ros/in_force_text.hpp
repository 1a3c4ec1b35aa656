#pragma once

#include "online_controller/parameters/multirotor_parameters.hpp"
#include "online_controller_ros/law_setup.hpp"
#include "polyfly_base/options_text.hpp"

namespace polyfly_ros {

/// Writes what flies: `law`, the setup that is in force, and of `start` what does not change in flight. Below `in_force`:
/// the maps by name, checksum and problem, the models, and the calibrations that these are from.
void writeInForce(const polyfly::MultirotorParameters& start, const LawSetup& setup, polyfly::Law law,
                  polyfly::OptionsText& text);

}  // namespace polyfly_ros
