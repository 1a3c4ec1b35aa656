#include "region_maps/map_image.hpp"

#include "region_maps/write_map.hpp"

namespace polyfly {

MapImage::MapImage(const MapContent& content) : bytes_(layOut(content)) {}

RegionMap MapImage::view(const std::string& name) const {
  return RegionMap::view(bytes_.data(), bytes_.size(), name);
}

}  // namespace polyfly
