#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "region_maps/map_content.hpp"

namespace polyfly {

/// A rectangle of whole numbers with a law, named by a letter.
struct GridRectangle {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  char law = 'a';
};

constexpr double kGainOfA = 0.01;

/// A map of rectangles in [0, width] x [0, height]. U and L are the constant inputs 1 and -1; any other
/// letter is a law of its own that depends on theta. The tree is one leaf.
inline MapContent gridMap(int width, int height, const std::vector<GridRectangle>& rectangles) {
  MapContent map;
  map.name = "grid";
  map.problem_kind = "json";
  map.solver_status = "complete";
  map.tolerance = 1e-8;
  map.parameters = {{"x", "m", 0.0, static_cast<double>(width)},
                    {"y", "m", 0.0, static_cast<double>(height)}};
  map.inputs = {{"u", "m", -1.0, 1.0}};
  for (int x = 0; x <= width; ++x) map.planes.insert(map.planes.end(), {2.0 / width, 0.0, 2.0 * x / width});
  for (int y = 0; y <= height; ++y)
    map.planes.insert(map.planes.end(), {0.0, 2.0 / height, 2.0 * y / height});
  std::map<char, std::uint32_t> laws;
  for (const GridRectangle& rectangle : rectangles) {
    const auto [law, is_new] = laws.emplace(rectangle.law, static_cast<std::uint32_t>(laws.size()));
    if (is_new) {
      const bool upper = rectangle.law == 'U', lower = rectangle.law == 'L';
      const double gain = upper || lower ? 0.0 : kGainOfA * (rectangle.law - 'a' + 1);
      map.laws.insert(map.laws.end(), {gain, 0.0, upper ? 1.0 : lower ? -1.0 : 0.0});
    }
    MapContent::Region region;
    region.first_row = static_cast<std::uint32_t>(map.rows.size());
    region.row_count = 4;
    region.law = law->second;
    for (const int row : {rectangle.x1 + 1, -(rectangle.x0 + 1), width + 1 + rectangle.y1 + 1,
                          -(width + 1 + rectangle.y0 + 1)})
      map.rows.push_back(row);
    map.candidates.push_back(static_cast<std::uint32_t>(map.regions.size()));
    map.regions.push_back(region);
  }
  map.root = MapContent::kLeaf;
  map.leaves = {{0, static_cast<std::uint32_t>(map.candidates.size())}};
  return map;
}

/// One unit cell for each letter, rows from y = 0 up; '.' is no region.
inline std::vector<GridRectangle> cellsOf(const std::vector<std::string>& rows) {
  std::vector<GridRectangle> cells;
  for (int y = 0; y < static_cast<int>(rows.size()); ++y) {
    for (int x = 0; x < static_cast<int>(rows[static_cast<std::size_t>(y)].size()); ++x) {
      const char law = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
      if (law != '.') cells.push_back({x, x + 1, y, y + 1, law});
    }
  }
  return cells;
}

}  // namespace polyfly
