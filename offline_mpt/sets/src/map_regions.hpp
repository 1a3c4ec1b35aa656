#pragma once

#include <cstdint>
#include <vector>

#include "polytope_sets/exact_polytope.hpp"

namespace polyfly {

class RegionMap;

/// The regions of a map in whole numbers and, for guesses, by rounded vertices.
class MapRegions {
 public:
  /// `tolerance` is by how much half-spaces are moved outwards.
  MapRegions(const RegionMap& map, double tolerance);

  std::size_t count() const { return shapes_.size(); }
  int parameters() const { return p_; }

  /// Whole numbers r of a signed row, as MapContent::rows has it: r . (1, theta) >= 0 in the half-space.
  const std::vector<Integer>& inside(std::int32_t row, bool moved) const;

  /// Whether a region, moved outwards or not, holds a point (x_0, x): theta = x / x_0.
  bool holds(std::uint32_t region, const std::vector<Integer>& point, bool moved) const;

  /// Exact vertices (x_0, x) of a region.
  std::vector<std::vector<Integer>> vertices(std::size_t region) const;

  /// Rounded vertices for the function below, one region at a time; different regions may be set at once.
  void setShape(std::size_t region, const std::vector<std::vector<Integer>>& vertices);

  /// Numbers of one vertex after the other.
  const std::vector<double>& shape(std::size_t region) const { return shapes_[region]; }

  const RegionMap& map() const { return map_; }
  double tolerance() const { return tolerance_; }

 private:
  const RegionMap& map_;
  double tolerance_;
  int p_;
  // Of each plane: the row, the row moved, and both of the plane negated.
  std::vector<std::vector<Integer>> insides_;
  std::vector<std::vector<double>> shapes_;
};

}  // namespace polyfly
