#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

namespace polyfly {

/// Seeded normal numbers that are the same with every standard library (std::normal_distribution is not).
class GaussianSource {
 public:
  explicit GaussianSource(std::uint64_t seed) : engine_(seed) {}

  double next();            ///< mean 0, standard deviation 1
  Eigen::Vector3d next3();  ///< three of them, x first

 private:
  std::mt19937_64 engine_;
  bool has_spare_ = false;
  double spare_ = 0.0;
};

}  // namespace polyfly
