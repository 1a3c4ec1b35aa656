#include <Eigen/Eigenvalues>

#include "mpc_core_spectrum.hpp"

namespace polyfly_test {

double spectralRadius(const Eigen::MatrixXd& matrix) { return matrix.eigenvalues().cwiseAbs().maxCoeff(); }

}  // namespace polyfly_test
