#pragma once

#include <string>

#include "identification/vehicle_kind.hpp"
#include "polyfly_base/provenance.hpp"  // yamlString

namespace polyfly {

/// A number in six significant digits, or `.nan` and `.inf` as YAML has them.
std::string yamlNumber(double value);

/// The line `vehicle:` of a calibration file.
std::string vehicleLine(const VehicleKind& vehicle);

/// A fitted value and half of its interval, for people; half_width NaN: the data do not bound it.
std::string valueText(double value, double half_width);

}  // namespace polyfly
