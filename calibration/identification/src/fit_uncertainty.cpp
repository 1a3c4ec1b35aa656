#include "fit_uncertainty.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "linear_part.hpp"

namespace polyfly {
namespace {

// Autocorrelation below which residuals count as independent.
constexpr double kUncorrelated = 0.1;
// Number of lags in correlation lengths. It is above 1, because Bartlett weights reduce the terms near the
// end.
constexpr Eigen::Index kLagFactor = 3;

double autocovariance(const Eigen::Ref<const Eigen::VectorXd>& values,
                      const std::vector<Eigen::Index>& starts, Eigen::Index lag) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
    const Eigen::Index count = starts[i + 1] - starts[i] - lag;
    if (count > 0) sum += values.segment(starts[i], count).dot(values.segment(starts[i] + lag, count));
  }
  return sum;
}

// Diagonal of the sum over k of weight(k) (M_k + M_k'), where M_k sums the products of samples k apart in one segment.
// The whole matrix would cost as much again for each column, and nobody asks for it.
template <class Weight>
Eigen::VectorXd laggedSquares(const Eigen::MatrixXd& influence, const std::vector<Eigen::Index>& starts,
                              Eigen::Index lags, Weight weight) {
  Eigen::VectorXd sum = weight(0) * influence.colwise().squaredNorm().transpose();
  for (Eigen::Index column = 0; column < influence.cols(); ++column) {
    for (Eigen::Index lag = 1; lag <= lags; ++lag)
      sum[column] += 2.0 * weight(lag) * autocovariance(influence.col(column), starts, lag);
  }
  return sum;
}

// 1 over the first half of the lags, then straight down to 0 (Politis and Romano 1995): hardly any bias.
double flatTop(Eigen::Index lag, Eigen::Index lags) {
  return std::min(1.0, 2.0 * (1.0 - static_cast<double>(lag) / static_cast<double>(lags + 1)));
}

// Autocovariances of the residuals, tapered.
struct Colour {
  // Autocovariance at each lag.
  std::vector<double> covariances;
  // Number of independent samples with an equally uncertain mean.
  double independent_samples = 0.0;
};

Colour colourOf(const Eigen::VectorXd& score, const std::vector<Eigen::Index>& starts, Eigen::Index lags) {
  Colour colour;
  std::vector<double>& covariances = colour.covariances;
  double inflation = 1.0;
  for (Eigen::Index lag = 0; lag <= lags; ++lag) {
    covariances.push_back(flatTop(lag, lags) * autocovariance(score, starts, lag) /
                          static_cast<double>(score.size()));
    if (lag > 0) inflation += 2.0 * std::max(0.0, covariances.back() / covariances.front());
  }
  colour.independent_samples = static_cast<double>(score.size()) / inflation;
  return colour;
}

// Number of samples over which residuals are correlated, at least 1.
Eigen::Index correlationLength(const Eigen::VectorXd& residuals, const std::vector<Eigen::Index>& starts) {
  const double variance = autocovariance(residuals, starts, 0);
  const Eigen::Index most = std::max<Eigen::Index>(1, residuals.size() / 8);
  Eigen::Index lag = 1;
  while (lag < most && autocovariance(residuals, starts, lag) > kUncorrelated * variance) ++lag;
  return lag;
}

// From a standard error that was estimated over lags up to this share of the samples.
double intervalFactor(double lag_share) {
  const double b = std::clamp(lag_share, 0.0, 1.0);
  return 1.9600 + b * (2.9694 + b * (0.4160 - b * 0.5324));
}

}  // namespace

Eigen::MatrixXd intervalSquares(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals,
                                double scale, const std::vector<Eigen::Index>& starts, Eigen::Index leading) {
  const double reach = kHuberReach * scale;
  const Eigen::VectorXd score =
      residuals.unaryExpr([reach](double residual) { return std::clamp(residual, -reach, reach); });
  const Eigen::VectorXd inside =
      residuals.unaryExpr([reach](double residual) { return std::abs(residual) <= reach ? 1.0 : 0.0; });
  const Eigen::MatrixXd curvature = jacobian.transpose() * inside.asDiagonal() * jacobian;
  // Rows of the inverse that belong to the leading unknowns, applied to each sample's gradient.
  const Eigen::MatrixXd inverse =
      curvature.ldlt().solve(Eigen::MatrixXd::Identity(curvature.rows(), curvature.cols())).topRows(leading);
  // Reaction of the unknowns to a change of each sample.
  const Eigen::MatrixXd reaction = jacobian * inverse.transpose();
  const auto samples = static_cast<double>(residuals.size());
  const auto unknowns = static_cast<double>(jacobian.cols());
  const double degrees = std::max(1.0, samples - unknowns);
  const double variance = score.squaredNorm() / degrees;
  const Eigen::MatrixXd white = variance * (inverse * (curvature * inverse.transpose()));
  const Eigen::Index lags = kLagFactor * correlationLength(residuals, starts);
  // Residuals that are larger where the loop is moved, and residuals that are alike everywhere: the wider
  // counts.
  const Eigen::VectorXd scores =
      samples / degrees *
      laggedSquares(score.asDiagonal() * reaction, starts, lags, [lags](Eigen::Index lag) {
        return 1.0 - static_cast<double>(lag) / static_cast<double>(lags + 1);
      });
  const Colour colour = colourOf(score, starts, lags);
  // The fit has taken some of the residuals' own movement out of them.
  const double taken =
      colour.independent_samples / std::max(1.0, colour.independent_samples - static_cast<double>(leading));
  const Eigen::VectorXd stationary =
      taken * laggedSquares(reaction, starts, lags, [&colour](Eigen::Index lag) {
        return colour.covariances[static_cast<std::size_t>(lag)];
      });
  Eigen::VectorXd widening(leading);
  for (Eigen::Index i = 0; i < leading; ++i) {
    widening[i] = std::sqrt(std::max(1.0, std::max(scores[i], stationary[i]) / white(i, i)));
  }
  widening *= intervalFactor(static_cast<double>(lags) / samples);
  return widening.asDiagonal() * white * widening.asDiagonal();
}

namespace {

// Number of reweighting rounds.
constexpr int kRegressionRounds = 30;

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
  for (int round = 0; round < kRegressionRounds; ++round) {
    result.coefficients = weighted(columns, values, roots);
    result.residuals = values - columns * result.coefficients;
    scale = std::max(robustScale(result.residuals), std::numeric_limits<double>::min());
    const double reach = kHuberReach * scale;
    roots = result.residuals.unaryExpr([reach](double residual) {
      return std::abs(residual) <= reach ? 1.0 : std::sqrt(reach / std::abs(residual));
    });
  }
  result.half_widths =
      intervalSquares(columns, result.residuals, scale, starts, columns.cols()).diagonal().cwiseSqrt();
  return result;
}

double independentSamples(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& starts) {
  const Eigen::VectorXd away = values.array() - values.mean();
  const Eigen::Index length = correlationLength(away, starts);
  double inflation = 1.0;
  for (Eigen::Index lag = 1; lag <= length; ++lag)
    inflation += 2.0 * std::max(0.0, autocovariance(away, starts, lag) / away.squaredNorm());
  return std::max(1.0, static_cast<double>(values.size()) / inflation);
}

}  // namespace polyfly
