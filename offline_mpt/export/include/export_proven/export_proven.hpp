#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
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

struct ExportProofOptions {
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to end early: Error
  /// Called now and then from the calling thread, with pairs of leaves that are compared. Their number is not known
  /// before.
  std::function<void(std::uint64_t pairs)> progress;
};

/// Proves how far the code's answers are from the map's (region_maps/region_maps/export/README.md). `options` are those that are
/// asked for; those of the result may have other candidates and a greater tolerance. Throws Error where the code cannot
/// be proven or made, and when stopped.
ProvenExport proveExport(const RegionMap& map, ExportOptions options, const ExportProofOptions& proof = {});

/// To be called before the work. Throws Error where `name` is no name of code, or `folder` is empty. It also throws
/// where one of the four files of writeExport cannot be written or is one of `inputs` (checkOutputs).
void checkExportOutputs(const std::string& folder, const std::string& name,
                        const std::vector<std::string>& inputs);

/// Writes NAME.c, NAME.h, NAME_test.c and NAME.json. The folder is made where it is missing. Throws Error.
void writeExport(const RegionMap& map, const ProvenExport& proven, const std::string& folder);

}  // namespace polyfly
