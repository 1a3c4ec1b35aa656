#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "region_maps/aligned_bytes.hpp"
#include "region_maps/map_content.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

/// The bytes of a map file in memory, where RegionMap::view can read them. Moves, does not copy.
class MapImage {
 public:
  /// Throws Error as layOut does.
  explicit MapImage(const MapContent& content);

  /// The map in these bytes, valid as long as the image, also when that moves. `name` is used in errors.
  RegionMap view(const std::string& name) const;

  /// A copy of the bytes, as writeFileAtomically takes them.
  std::vector<std::byte> bytes() const { return {bytes_.data(), bytes_.data() + bytes_.size()}; }

 private:
  AlignedBytes bytes_;
};

}  // namespace polyfly
