#pragma once

#include <Eigen/Core>
#include <vector>

namespace polyfly {

struct RobustCovariance {
  Eigen::MatrixXd covariance;
  double lag_share = 0.0;  ///< lags over which correlation was followed, by the number of samples
};

/// Covariance of the leading `leading` unknowns of a fit with the loss of Huber.
/// jacobian: of the model by the unknowns, at each sample; residuals with their robust scale; starts: first
/// sample of each segment and the number of samples. Correlation of the residuals in time widens the result:
/// the greater of what the products of gradient and residual give (Newey and West, Econometrica 55, 1987) and
/// what the residuals' own autocovariance gives; it never falls below the covariance of independent
/// residuals.
RobustCovariance robustCovariance(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals,
                                  double scale, const std::vector<Eigen::Index>& starts,
                                  Eigen::Index leading);

/// Number of samples over which residuals are correlated, at least 1.
Eigen::Index correlationLength(const Eigen::VectorXd& residuals, const std::vector<Eigen::Index>& starts);

/// The factor from a standard error to half of the 95 % interval, where the error itself was estimated over
/// lags up to this share of the samples (Kiefer and Vogelsang, Econometric Theory 21, 2005, Bartlett
/// weights).
double intervalFactor(double lag_share);

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
