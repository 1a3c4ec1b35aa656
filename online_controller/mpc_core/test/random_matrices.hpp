#pragma once

#include <Eigen/Core>
#include <random>

namespace polyfly {

inline Eigen::MatrixXd gaussian(int rows, int columns, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

inline Eigen::MatrixXd positiveDefinite(int n, std::mt19937_64& random) {
  const Eigen::MatrixXd root = gaussian(n, n, random);
  return root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
}

}  // namespace polyfly
