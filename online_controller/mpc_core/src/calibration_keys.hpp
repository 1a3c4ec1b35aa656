#pragma once

#include "polyfly_base/yaml_field.hpp"

namespace polyfly {

/// Refuses unknown keys anywhere in a calibration file. Throws Error.
void checkCalibrationKeys(const YamlField& root, const std::string& kind);

}  // namespace polyfly
