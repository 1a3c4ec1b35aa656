#pragma once

#include <istream>
#include <string>

namespace polyfly {

/// As std::getline, but throws Error `path: ...` where a line is longer than any of a text file. Otherwise an endless
/// device or a file of other bytes would fill the memory.
bool readLine(std::istream& stream, std::string& line, const std::string& path);

}  // namespace polyfly
