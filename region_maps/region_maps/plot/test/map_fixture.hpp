#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "region_maps/map_content.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {

/// A map in memory, with the 64-byte alignment that RegionMap::view asks for.
class MapInMemory {
 public:
  explicit MapInMemory(const MapContent& content)
      : bytes_(layOut(content)), storage_(bytes_.size() / 64 + 1) {
    std::memcpy(storage_.data(), bytes_.data(), bytes_.size());
    map_ = std::make_unique<RegionMap>(RegionMap::view(storage_.data(), bytes_.size(), content.name));
  }
  const RegionMap& map() const { return *map_; }

 private:
  struct alignas(64) Block {
    std::byte bytes[64];
  };
  std::vector<std::byte> bytes_;
  std::vector<Block> storage_;
  std::unique_ptr<RegionMap> map_;
};

/// A map whose regions are the cells into which `planes` random planes cut a box: one region for each pattern
/// of signs. Bit i of a region's index tells its side of plane i.
inline MapContent arrangement(unsigned seed, int planes) {
  MapContent content;
  content.name = "arrangement";
  content.problem_text = "none";
  content.problem_kind = "json";
  content.solver_status = "complete";
  content.tolerance = 1e-9;
  content.parameters = {{"alpha", "m", -1.0, 2.0}, {"beta", "m/s", 1.0, 9.0}, {"gamma", "rad", -0.5, 0.5}};
  content.inputs = {{"u", "rad", -10.0, 10.0}};
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (int plane = 0; plane < planes; ++plane) {
    double direction[3] = {normal(random), normal(random), normal(random)};
    const double length =
        std::sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    double offset = 0.3 * normal(random);
    for (int index = 0; index < 3; ++index) {
      const Signal& signal = content.parameters[static_cast<std::size_t>(index)];
      const double half = 0.5 * (signal.upper - signal.lower);
      const double coefficient = direction[index] / length / half;
      content.planes.push_back(coefficient);
      offset += coefficient * 0.5 * (signal.upper + signal.lower);
    }
    content.planes.push_back(offset);
  }
  const auto cells = static_cast<std::uint32_t>(1) << planes;
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    MapContent::Region region;
    region.first_row = static_cast<std::uint32_t>(content.rows.size());
    region.row_count = static_cast<std::uint32_t>(planes);
    region.law = cell;
    content.regions.push_back(region);
    for (int plane = 0; plane < planes; ++plane) {
      content.rows.push_back((cell >> plane & 1u) != 0 ? plane + 1 : -(plane + 1));
    }
    for (int number = 0; number < 4; ++number) content.laws.push_back(normal(random));
    content.candidates.push_back(cell);
  }
  content.leaves = {{0, cells}};
  content.root = MapContent::kLeaf;
  return content;
}

}  // namespace polyfly
