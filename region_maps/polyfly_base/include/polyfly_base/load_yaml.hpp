#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace polyfly {

/// The one document in `text`, null where there is none. Throws Error `source:line: file: rule` on any other text, on
/// control characters, on an alias of what holds it, and on ':' right before ']' or the end, quoted or not.
YAML::Node loadYaml(const std::string& text, const std::string& source);

}  // namespace polyfly
