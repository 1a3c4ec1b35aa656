#pragma once

#include <cmath>
#include <functional>
#include <string>

#include "export_bound.hpp"
#include "lookup_work.hpp"
#include "map_export/export_map.hpp"
#include "synthetic_map.hpp"

namespace polyfly {

// What tests of exported code have in common.

/// Four regions with the continuous law u = |x| + |y - x / 2|.
inline MapContent kinkedMap() {
  MapContent map;
  map.name = "kinked";
  map.problem_kind = "json";
  map.solver_status = "complete";
  map.tolerance = 1e-9;
  map.parameters = {{"x", "", -2.0, 2.0}, {"y", "", -2.0, 2.0}};
  map.inputs = {{"u", "", 0.0, 5.0}};
  // Scaled: a . theta - c is a distance where the ranges are [-1, 1].
  const double norm = std::hypot(2.0, 1.0);
  map.planes = {0.5, 0.0, 0.0, -0.5 / norm, 1.0 / norm, 0.0};
  for (const double first : {-1.0, 1.0}) {
    for (const double second : {-1.0, 1.0}) {
      MapContent::Region region;
      region.first_row = static_cast<std::uint32_t>(map.rows.size());
      region.row_count = 2;
      region.law = static_cast<std::uint32_t>(map.regions.size());
      map.rows.push_back(first < 0.0 ? 1 : -1);
      map.rows.push_back(second < 0.0 ? 2 : -2);
      map.laws.insert(map.laws.end(), {first - 0.5 * second, second, 0.0});
      map.regions.push_back(region);
    }
  }
  map.nodes = {{0, MapContent::kLeaf | 0u, MapContent::kLeaf | 1u}};
  map.leaves = {{0, 2}, {2, 2}};
  map.candidates = {0, 1, 2, 3};
  // The node decides on the first plane; leaves test the second, so every row of the code counts.
  map.tests = {2, 2, 2, 2};
  return map;
}

inline ExportOptions optionsOf(ExportType type) {
  ExportOptions options;
  options.name = "code";
  options.type = type;
  return options;
}

inline ExportOptions floatOptions() { return optionsOf(ExportType::kFloat); }

/// u = x clipped to [-1, 1]: two regions that meet at the node's plane x = 1 / 4, and one beyond each. All have the sides
/// of the box among their rows.
inline MapContent clippedMap() {
  MapContent map = kinkedMap();
  map.name = "clipped";
  map.tolerance = 1e-8;
  map.inputs = {{"u", "", -1.0, 1.0}};
  // x <= 1/4, x <= -1, x <= 1, and the sides of the box.
  map.planes = {0.5, 0.0, 0.125, 0.5,  0.0, -0.5, 0.5, 0.0, 0.5, 0.5, 0.0,
                1.0, 0.5, 0.0,   -1.0, 0.0, 0.5,  1.0, 0.0, 0.5, -1.0};
  map.laws = {1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0};
  map.rows = {1, -2, 4, -5, 6, -7, -1, 3, 4, -5, 6, -7, 2, 4, -5, 6, -7, -3, 4, -5, 6, -7};
  map.regions.clear();
  const std::vector<std::array<std::uint32_t, 3>> regions = {{0, 6, 0}, {6, 6, 0}, {12, 5, 1}, {17, 5, 2}};
  for (const auto& [first, count, law] : regions) {
    map.regions.emplace_back();
    map.regions.back().first_row = first;
    map.regions.back().row_count = count;
    map.regions.back().law = law;
  }
  map.nodes = {{0, MapContent::kLeaf | 0u, MapContent::kLeaf | 1u}};
  map.leaves = {{0, 2}, {2, 2}};
  map.candidates = {0, 2, 1, 3};
  map.tests.clear();
  return map;
}

inline checker::Map checkedMap(const MadeMap& made) {
  MadeMap& mutable_made = const_cast<MadeMap&>(made);
  return checker::Map(
      std::string(reinterpret_cast<const char*>(mutable_made.bytes.data()), made.bytes.size()));
}

/// What the checker proves of the code's answers and operations.
inline ExportBound provenBound(const checker::ExportedAnswers& answers, const checker::ExportedCode& code) {
  const checker::LookupWork work = checker::greatestWork(code.tables);
  return {answers.error, answers.margin, {work.sums, work.comparisons}, {}};
}

}  // namespace polyfly
