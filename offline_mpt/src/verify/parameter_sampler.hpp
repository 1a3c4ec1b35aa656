#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "lp/polytope.hpp"

namespace polyfly {

class RegionMap;

/// Draws parameters at which a map is likely to be wrong. Uses no standard distribution, whose results differ
/// between platforms.
class ParameterSampler {
 public:
  /// Samplers of the same seed and another stream are independent.
  ParameterSampler(const RegionMap& map, std::uint64_t seed, std::uint64_t stream);

  struct Sample {
    Eigen::VectorXd theta;
    /// Chebyshev radius of the region that it was drawn from [scaled]; <= 0: it is empty.
    double radius = 1.0;
  };

  /// Uniform in the box.
  Sample uniform();

  /// The centre of a region.
  Sample centre(std::uint64_t region);

  /// Just behind a facet of the region whose centre was asked for last, in a random direction from there. Empty where that is
  /// outside of the box.
  Eigen::VectorXd behindFacet();

  /// On, beside or at the meeting of faces of a random region, or at its centre.
  Sample degenerate();

 private:
  double unit();
  std::uint64_t below(std::uint64_t count);
  Eigen::VectorXd direction();

  Eigen::Index rowCount() const { return static_cast<Eigen::Index>(rows_.size()) / (middle_.size() + 1); }
  Eigen::Map<const Eigen::VectorXd> normal(Eigen::Index row) const {
    return {rows_.data() + row * (middle_.size() + 1), middle_.size()};
  }
  double bound(Eigen::Index row) const { return *(normal(row).data() + middle_.size()); }

  double gatherRows(std::uint64_t region);
  Eigen::Index walk(Eigen::VectorXd& t, const Eigen::VectorXd& along) const;
  Sample toParameters(const Eigen::VectorXd& t, double radius) const;

  const RegionMap* map_;
  std::mt19937_64 engine_;
  Eigen::VectorXd middle_, half_;
  PolytopeSolver solver_;
  // Half-spaces (a, b) of the box and of the current region, a of unit length, one after the other.
  std::vector<double> rows_;  // [scaled]
  // Centre of the current region.
  Eigen::VectorXd centre_;  // [scaled]
};

}  // namespace polyfly
