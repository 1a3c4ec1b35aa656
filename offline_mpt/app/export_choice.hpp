#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "export_proven/export_proven.hpp"
#include "region_maps/map_image.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

struct ExportRequest {
  std::string name;
  ExportType type = ExportType::kDouble;
  /// Whether `type` was not asked for.
  bool chooses_type = false;
  /// Greatest FlashBytes::total(); 0: none. [bytes]
  std::uint64_t flash_limit = 0;
  std::function<void(const std::string& text)> progress;
};

struct ChosenExport {
  ProvenExport proven;
  /// The map of the code where that is not the given one.
  std::unique_ptr<MapImage> reduced;
  /// Type, bytes of flash and map, in a phrase.
  std::string summary;
};

/// The first proven code that fits the limit with a small error, as the help of `offline_mpt export` lists it.
/// `reduced_name` is that of reduced maps in errors. Throws Error where none fits.
ChosenExport chooseExport(const RegionMap& map, const std::string& reduced_name,
                          const ExportRequest& request);

}  // namespace polyfly
