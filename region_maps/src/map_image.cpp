#include "region_maps/map_image.hpp"

#include <algorithm>
#include <new>

#include "region_maps/format.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {
namespace {

constexpr std::align_val_t kPlace{format::kAlignment};

}  // namespace

MapImage::MapImage(const MapContent& content) {
  const std::vector<std::byte> bytes = layOut(content);
  size_ = bytes.size();
  place_.reset(static_cast<std::byte*>(::operator new(size_, kPlace)));
  std::copy(bytes.begin(), bytes.end(), place_.get());
}

RegionMap MapImage::view(const std::string& name) const { return RegionMap::view(place_.get(), size_, name); }

void MapImage::Release::operator()(std::byte* place) const noexcept { ::operator delete(place, kPlace); }

}  // namespace polyfly
