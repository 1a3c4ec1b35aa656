#pragma once

#include <cstdint>
#include <vector>

#include "map_export/export_map.hpp"

namespace polyfly {

/// A row of the exported code: twice the plane's number, plus one where both sides are negated.
constexpr std::uint32_t exportedRow(std::int32_t row) {
  const std::uint32_t plane = static_cast<std::uint32_t>(row < 0 ? -row : row) - 1;
  return 2 * plane + (row < 0 ? 1 : 0);
}

/// The tables of the exported code. Each leaf has candidates of its own, each candidate the rows that are tested.
struct CodeTables {
  /// p + 1 numbers each, as the type rounds them.
  std::vector<double> planes;
  /// m rows of p + 1 numbers each, as the type rounds them.
  std::vector<double> laws;
  /// Lower and upper bound of each parameter, widened by the tolerance, rounded outwards.
  std::vector<double> box;
  double tolerance = 0.0;  ///< [scaled]

  std::vector<std::uint32_t> node_plane;
  /// Below and above of each node. A child that is no node is a leaf: minus the number of nodes, its index.
  std::vector<std::uint32_t> node_child;
  /// First candidate of each leaf, and the end of the last one.
  std::vector<std::uint32_t> leaf_first;
  std::vector<std::uint32_t> candidate_region;
  /// First row of each candidate, and the end of the last one.
  std::vector<std::uint32_t> candidate_first;
  std::vector<std::uint32_t> rows;
  std::vector<std::uint32_t> region_law;
};

/// Throws Error where a number exceeds the type.
CodeTables codeTables(const RegionMap& map, const ExportOptions& options);

/// Bytes of the narrowest unsigned type for these values: 1, 2 or 4.
std::uint32_t indexBytes(const std::vector<std::uint32_t>& values);

}  // namespace polyfly
