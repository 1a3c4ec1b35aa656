#pragma once

#include <Eigen/Core>
#include <vector>

namespace polyfly {

/// Covariance of the leading `leading` unknowns of a fit with the loss of Huber, times the square of the factor from a
/// standard error to half of the 95 % interval: on the diagonal stand the squares of these half widths.
/// jacobian: of the model by the unknowns, at each sample; residuals with their robust scale; starts: first
/// sample of each segment and the number of samples. Correlation of the residuals in time widens the result:
/// the greater of what the products of gradient and residual give (Newey and West, Econometrica 55, 1987) and
/// what the residuals' own autocovariance gives; it never falls below the covariance of independent
/// residuals. The factor accounts for lags that are a share of the samples (Kiefer and Vogelsang, Econometric Theory
/// 21, 2005, Bartlett weights).
Eigen::MatrixXd intervalSquares(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals,
                                double scale, const std::vector<Eigen::Index>& starts, Eigen::Index leading);

/// A linear model with the loss of Huber.
struct Regression {
  Eigen::VectorXd coefficients;
  /// Half widths of the 95 % confidence intervals.
  Eigen::VectorXd half_widths;
  Eigen::VectorXd residuals;
};

/// Fits columns * coefficients to values; uncertainty as intervalSquares.
Regression regress(const Eigen::MatrixXd& columns, const Eigen::VectorXd& values,
                   const std::vector<Eigen::Index>& starts);

/// As many independent samples have a mean as uncertain, at least 1.
double independentSamples(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& starts);

}  // namespace polyfly
