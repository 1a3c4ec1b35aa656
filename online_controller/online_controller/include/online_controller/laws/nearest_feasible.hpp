#pragma once

#include <vector>

#include "mpc_core/bounded_qp.hpp"

namespace polyfly {

class RegionMap;

/// Nearest point of the set that a map's regions cover, where this set is convex: for a minimum-peak robust MPC its
/// feasible set. Distances are Euclidean, in parameters whose ranges are mapped to [-1, 1].
///
/// The set's facets are read off the map. Regions meet facet to facet, so a plane between two of them bounds one region
/// from below and one from above. No region lies beyond a facet of the set, so its plane bounds all from one side. Regions
/// of a reduced map may overlap; of its planes those count beyond which no region lies.
class NearestFeasible {
 public:
  /// Parameters with `movable` set may differ from what is asked for.
  NearestFeasible(const RegionMap& map, const std::vector<bool>& movable);

  /// Writes the nearest point whose other parameters are those of `theta`, or where there is none, the nearest one
  /// whatever its parameters. False where the search reached its limit or theta is not finite: `nearest` is left alone
  /// then. Never throws, allocates, locks or reads a clock.
  bool find(const double* theta, double* nearest) noexcept;

  /// Working sets of the last find().
  int iterations() const noexcept { return iterations_; }
  /// Most working sets of a find(): two searches of 10 (p + facets) + 30 each, p the number of parameters.
  int iterationLimit() const noexcept { return 2 * search_limit_; }
  /// Facets of the set beside those of the parameters' box.
  int facetCount() const noexcept { return solver_.rowCount(); }

 private:
  bool search(bool all_movable) noexcept;

  std::vector<bool> movable_;
  // Middle and half width of each parameter's range.
  std::vector<double> middle_, half_;
  BoundedQp solver_{1};
  // Vectors of the quadratic program, scaled parameters.
  std::vector<double> gradient_, lower_, upper_, row_lower_, row_upper_;
  int search_limit_ = 0;
  int iterations_ = 0;
};

}  // namespace polyfly
