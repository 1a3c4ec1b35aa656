#pragma once

#include <string>

#include "report/report.hpp"

namespace polyfly {

/// The same numbers as YAML, in six significant digits. Lists of numbers stand in one line. The same input gives the
/// same bytes.
std::string yamlText(const Json& json);

}  // namespace polyfly
