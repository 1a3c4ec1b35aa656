#include "spectrum.hpp"

#include <Eigen/Eigenvalues>

namespace polyfly_test {

double spectralRadius(const Eigen::MatrixXd& matrix) { return matrix.eigenvalues().cwiseAbs().maxCoeff(); }

}  // namespace polyfly_test
