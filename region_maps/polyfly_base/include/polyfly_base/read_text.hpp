#pragma once

#include <string>

namespace polyfly {

/// The whole file at `path`. Throws Error `path: file: rule` when it is missing, a directory, empty or too
/// large.
std::string readText(const std::string& path);

/// No number of a problem file is greater in size: products of several must stay far within doubles.
constexpr double kGreatestNumber = 1e30;

/// Whether a file's or a topic's name has this ending.
bool endsWith(const std::string& text, const std::string& ending);

}  // namespace polyfly
