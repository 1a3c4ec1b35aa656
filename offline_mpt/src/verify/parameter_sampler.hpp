#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

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
    /// Chebyshev radius of the region that it was drawn from [scaled]; <= 0: it is empty; NaN: unknown.
    double radius = 1.0;
  };

  /// Uniform in the box.
  Sample uniform();

  /// A unit vector.
  Eigen::VectorXd direction();

  /// On, beside or at the meeting of faces of a random region, or at its centre.
  Sample degenerate();

 private:
  double unit();
  std::uint64_t below(std::uint64_t count);

  double gatherRows(std::uint64_t region);
  double exactRadius(const Eigen::MatrixXd& A, double radius) const;
  double walk(Eigen::VectorXd& t, const Eigen::VectorXd& along, Eigen::Index& face) const;
  Sample toParameters(const Eigen::VectorXd& t, double radius) const;

  const RegionMap* map_;
  std::mt19937_64 engine_;
  Eigen::VectorXd middle_, half_;
  // Unit normals of the current region and of the box.
  Eigen::MatrixXd rows_;    // [scaled]
  Eigen::VectorXd bounds_;  // rows_ t <= bounds_
  // Centre of the current region.
  Eigen::VectorXd centre_;  // [scaled]
};

}  // namespace polyfly
