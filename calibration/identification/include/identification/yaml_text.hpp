#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "identification/loop_record.hpp"
#include "identification/vehicle_kind.hpp"
#include "polyfly_base/provenance.hpp"  // yamlString

namespace polyfly {

/// A number in six significant digits, or `.nan` and `.inf` as YAML has them.
std::string yamlNumber(double value);

/// A list of sentences under a key.
void writeSentences(const char* key, const std::string& indent, const std::vector<std::string>& sentences,
                    std::ostream& out);

/// Windows as [[from, to], ...].
std::string windowList(const std::vector<TimeWindow>& windows);

/// The line `vehicle:` of a calibration file.
std::string vehicleLine(const VehicleKind& vehicle);

/// A fitted value and half of its interval, for people; half_width NaN: the data do not bound it.
std::string valueText(double value, double half_width);

}  // namespace polyfly
