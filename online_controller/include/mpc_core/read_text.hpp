#pragma once

#include <string>

namespace polyfly {

/// The whole file at `path`. Throws Error `path: file: rule` when it is missing, a directory, empty or too
/// large.
std::string readText(const std::string& path);

/// Whether a file's or a topic's name has this ending.
bool endsWith(const std::string& text, const std::string& ending);

}  // namespace polyfly
