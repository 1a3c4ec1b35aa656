#pragma once

#include "online_controller_ros/law_setup.hpp"
#include "polyfly_base/options_text.hpp"

namespace polyfly_ros {

/// Writes what flies: `law` and the setup that is in force. Below `in_force`: the maps by name, checksum and problem, the
/// models, and the calibrations that these are from.
void writeInForce(const LawSetup& setup, polyfly::Law law, polyfly::OptionsText& text);

}  // namespace polyfly_ros
