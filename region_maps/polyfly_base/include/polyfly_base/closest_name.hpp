#pragma once

#include <optional>
#include <string>
#include <vector>

namespace polyfly {

/// The known name that a misspelt one means. Case does not count. At most two letters may be wrong, missing or too
/// many where it has six or more, else one. Nothing where no known name is that near.
std::optional<std::string> closestName(const std::string& name, const std::vector<std::string>& known);

}  // namespace polyfly
