#pragma once

#include <optional>
#include <string>
#include <vector>

namespace polyfly {

/// Which of the known names is meant by one that is none of them, but a slip away: apart from case, at most
/// two letters wrong, missing or too many where it has six or more, else one. Nothing where none is near.
std::optional<std::string> closestName(const std::string& name, const std::vector<std::string>& known);

}  // namespace polyfly
