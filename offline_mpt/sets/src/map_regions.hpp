#pragma once

#include <cstdint>
#include <vector>

#include "polytope_sets/exact_polytope.hpp"

namespace polyfly {

class RegionMap;

/// value / by, rounded without exact division: for guesses.
double ratio(const Integer& value, const Integer& by);

/// The regions of a map as exact polytopes and, for guesses, by rounded vertices.
class MapRegions {
 public:
  /// `tolerance` moves half-spaces outwards in `widened`.
  MapRegions(const RegionMap& map, double tolerance);

  std::size_t count() const { return shapes_.size(); }
  int parameters() const { return p_; }

  /// a . theta <= b of row `row` of a region, as the map has it.
  ExactHalfSpace row(std::size_t region, std::uint32_t row) const;

  /// Region and box.
  ExactPolytope polytope(std::size_t region) const;

  /// Its exact vertices (x_0, x): theta = x / x_0. `flat` tells whether it has no interior.
  std::vector<std::vector<Integer>> vertices(std::size_t region, bool& flat) const;

  /// Rounded vertices for the functions below, one region at a time; different regions may be set at once.
  void setShape(std::size_t region, const std::vector<std::vector<Integer>>& vertices);

  std::vector<std::uint32_t> shaped() const;  ///< regions whose vertices were set

  /// Numbers of one vertex after the other.
  const std::vector<double>& shape(std::size_t region) const { return shapes_[region]; }

  const RegionMap& map() const { return map_; }
  double tolerance() const { return tolerance_; }

 private:
  const RegionMap& map_;
  double tolerance_;
  int p_;
  std::vector<std::vector<double>> shapes_;
};

}  // namespace polyfly
