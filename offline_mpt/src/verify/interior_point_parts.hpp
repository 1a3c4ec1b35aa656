#pragma once

#include <Eigen/Core>

namespace polyfly {

/// Largest absolute value; 0 of an empty vector.
inline double maxAbs(const Eigen::VectorXd& v) { return v.size() == 0 ? 0.0 : v.cwiseAbs().maxCoeff(); }

}  // namespace polyfly
