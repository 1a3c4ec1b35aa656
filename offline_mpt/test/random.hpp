#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

namespace polyfly {

/// Seeded numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(count)); }
  /// Entries uniform in [-1, 1].
  Eigen::MatrixXd matrix(int rows, int cols) {
    Eigen::MatrixXd result(rows, cols);
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < cols; ++j) result(i, j) = uniform(-1.0, 1.0);
    }
    return result;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace polyfly
