#pragma once

#include <Eigen/Core>

namespace polyfly_test {

/// Greatest absolute eigenvalue, by Eigen's solver; in a library of its own because that compiles slowly.
double spectralRadius(const Eigen::MatrixXd& matrix);

}  // namespace polyfly_test
