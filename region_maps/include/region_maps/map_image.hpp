#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

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
  std::vector<std::byte> bytes() const { return {place_.get(), place_.get() + size_}; }

 private:
  struct Release {
    void operator()(std::byte* place) const noexcept;
  };

  std::size_t size_ = 0;
  std::unique_ptr<std::byte, Release> place_;
};

}  // namespace polyfly
