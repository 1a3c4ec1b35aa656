#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include "region_maps/map_content.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {

/// A map laid out in memory, aligned as RegionMap::view asks.
class MapInMemory {
 public:
  explicit MapInMemory(const MapContent& content) : bytes_(layOut(content)), map_(place(content.name)) {}
  const RegionMap& map() const { return map_; }
  std::size_t size() const { return bytes_.size(); }
  std::string bytes() const { return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}; }

 private:
  struct alignas(64) Block {
    std::byte bytes[64];
  };

  RegionMap place(const std::string& name) {
    storage_.resize(bytes_.size() / sizeof(Block) + 1);
    std::memcpy(storage_.data(), bytes_.data(), bytes_.size());
    return RegionMap::view(storage_.data(), bytes_.size(), name);
  }

  std::vector<std::byte> bytes_;
  std::vector<Block> storage_;
  RegionMap map_;
};

}  // namespace polyfly
