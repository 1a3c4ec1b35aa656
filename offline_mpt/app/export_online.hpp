#pragma once

#include <string>

#include "map_export/export_online.hpp"

namespace polyfly {

struct OnlineArguments {
  /// Problem file, or a map, whose problem is taken.
  std::string source;
  std::string folder;
  OnlineOptions options;
};

/// Writes the online solver of a problem as C code, and prints what was met as it was tried. Throws Error.
void exportOnline(const OnlineArguments& arguments);

}  // namespace polyfly
