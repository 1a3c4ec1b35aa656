#include "regression.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fit_uncertainty.hpp"
#include "linear_part.hpp"

namespace polyfly {
namespace {

// Number of reweighting rounds.
constexpr int kRounds = 30;

Eigen::VectorXd weighted(const Eigen::MatrixXd& columns, const Eigen::VectorXd& values,
                         const Eigen::VectorXd& roots) {
  return (roots.asDiagonal() * columns).colPivHouseholderQr().solve(roots.cwiseProduct(values));
}

}  // namespace

Regression regress(const Eigen::MatrixXd& columns, const Eigen::VectorXd& values,
                   const std::vector<Eigen::Index>& starts) {
  Regression result;
  Eigen::VectorXd roots = Eigen::VectorXd::Ones(values.size());
  double scale = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    result.coefficients = weighted(columns, values, roots);
    result.residuals = values - columns * result.coefficients;
    scale = std::max(robustScale(result.residuals), std::numeric_limits<double>::min());
    const double reach = kHuberReach * scale;
    roots = result.residuals.unaryExpr([reach](double residual) {
      return std::abs(residual) <= reach ? 1.0 : std::sqrt(reach / std::abs(residual));
    });
  }
  const RobustCovariance robust = robustCovariance(columns, result.residuals, scale, starts, columns.cols());
  result.standard_errors = robust.covariance.diagonal().cwiseSqrt();
  result.half_widths = intervalFactor(robust.lag_share) * result.standard_errors;
  return result;
}

double independentSamples(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& starts) {
  const Eigen::VectorXd away = values.array() - values.mean();
  const Eigen::Index length = correlationLength(away, starts);
  double inflation = 1.0;
  for (Eigen::Index lag = 1; lag <= length; ++lag) {
    double product = 0.0;
    for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
      const Eigen::Index count = starts[i + 1] - starts[i] - lag;
      if (count > 0) product += away.segment(starts[i], count).dot(away.segment(starts[i] + lag, count));
    }
    inflation += 2.0 * std::max(0.0, product / away.squaredNorm());
  }
  return std::max(1.0, static_cast<double>(values.size()) / inflation);
}

}  // namespace polyfly
