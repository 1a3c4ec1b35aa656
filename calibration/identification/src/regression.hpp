#pragma once

#include <Eigen/Core>
#include <vector>

namespace polyfly {

/// A linear model with the loss of Huber.
struct Regression {
  Eigen::VectorXd coefficients;
  Eigen::VectorXd standard_errors;
  /// Half widths of the 95 % confidence intervals.
  Eigen::VectorXd half_widths;
  Eigen::VectorXd residuals;
};

/// Fits columns * coefficients to values; uncertainty as robustCovariance.
Regression regress(const Eigen::MatrixXd& columns, const Eigen::VectorXd& values,
                   const std::vector<Eigen::Index>& starts);

/// As many independent samples have a mean as uncertain, at least 1.
double independentSamples(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& starts);

}  // namespace polyfly
