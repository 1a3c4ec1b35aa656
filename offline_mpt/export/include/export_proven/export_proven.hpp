#pragma once

#include <string>
#include <vector>

#include "map_export/export_map.hpp"

namespace polyfly {

class RegionMap;

/// Options under which the code of a map is proven, and what is proven of it.
struct ProvenExport {
  ExportOptions options;
  ExportBound bound;
};

/// Proves how far the code's answers are from the map's (region_maps/export/README.md). `options` are those that are
/// asked for; those of the result may have more candidates and a greater tolerance. Throws Error where the code cannot
/// be proven or made.
ProvenExport proveExport(const RegionMap& map, ExportOptions options);

/// To be called before the work. Throws Error where `name` is no name of code, `folder` is empty, or one of the four
/// files of writeExport cannot be written or is one of `inputs` (checkOutputs).
void checkExportOutputs(const std::string& folder, const std::string& name,
                        const std::vector<std::string>& inputs);

/// Writes NAME.c, NAME.h, NAME_test.c and NAME.json. The folder is made where it is missing. Throws Error.
void writeExport(const RegionMap& map, const ProvenExport& proven, const std::string& folder);

}  // namespace polyfly
