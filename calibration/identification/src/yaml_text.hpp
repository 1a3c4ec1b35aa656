#pragma once

#include <string>

namespace polyfly {

/// A number in six significant digits, or `.nan` and `.inf` as YAML has them.
std::string yamlNumber(double value);

/// A string in double quotes, with what needs it escaped.
std::string yamlString(const std::string& text);

}  // namespace polyfly
