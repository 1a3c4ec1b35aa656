#include "thrust_model.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fit_uncertainty.hpp"
#include "linear_part.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Where the straight lines begin, in halves of the range of thrusts: at the last sample, within these.
constexpr double kNearestEnd = 1.1, kFarthestEnd = 1.8;
// Least slope, as a share of the mean slope.
constexpr double kLeastSlopeShare = 0.02;
constexpr int kSlopeProbes = 40;
// Of a curve of degree 3.
constexpr int kMostValues = 4;
constexpr int kThrustRounds = 60;
constexpr int kThrustHalvings = 12;
constexpr double kThrustConverged = 1e-10;
// Command that is off by less than this is found [1].
constexpr double kCommandFound = 1e-13;

// Powers of x, and of their derivatives.
using PowerRow = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMostValues>;

PowerRow powersOf(double x, Eigen::Index count) {
  PowerRow row = PowerRow::Ones(count);
  for (Eigen::Index i = 1; i < count; ++i) row[i] = x * row[i - 1];
  return row;
}

PowerRow slopesOf(double x, Eigen::Index count) {
  PowerRow row = PowerRow::Zero(count);
  double power = 1.0;
  for (Eigen::Index i = 1; i < count; ++i, power *= x) row[i] = static_cast<double>(i) * power;
  return row;
}

double huberLoss(const Eigen::VectorXd& residuals, double scale) {
  const double reach = kHuberReach * scale;
  double sum = 0.0;
  for (Eigen::Index i = 0; i < residuals.size(); ++i) {
    const double size = std::abs(residuals[i]);
    sum += size <= reach ? 0.5 * size * size : reach * (size - 0.5 * reach);
  }
  return sum;
}

// The unknowns as one vector.
struct Unknowns {
  bool battery;
  bool climb;

  explicit Unknowns(const ThrustSamples& samples)
      : battery(samples.battery.size() > 0), climb(samples.climb.size() > 0) {}

  ThrustModel moved(ThrustModel model, const Eigen::VectorXd& by, double share) const {
    const Eigen::Index values = model.values.size();
    model.values += share * by.head(values);
    Eigen::Index next = values;
    if (battery) model.battery += share * by[next++];
    if (climb) model.climb_drag += share * by[next];
    return model;
  }
};

// Of the predicted thrust by the unknowns; the last column by the lag.
Eigen::MatrixXd jacobianOf(const ThrustModel& model, const CurveShape& shape, const ThrustSamples& samples) {
  const Unknowns unknowns(samples);
  const Eigen::Index values = model.values.size();
  Eigen::MatrixXd jacobian(samples.rows(),
                           values + (unknowns.battery ? 1 : 0) + (unknowns.climb ? 1 : 0) + 1);
  for (Eigen::Index row = 0; row < samples.rows(); ++row) {
    const double factor = unknowns.battery ? std::exp(model.battery * samples.battery[row]) : 1.0;
    const double command = samples.command[row] * factor;
    const double thrust = shape.thrustOf(command, model.values);
    const double slope = shape.slopeRow(thrust).dot(model.values);
    jacobian.row(row).head(values) = -shape.valueRow(thrust) / slope;
    Eigen::Index next = values;
    if (unknowns.battery) jacobian(row, next++) = command * samples.battery[row] / slope;
    if (unknowns.climb) jacobian(row, next++) = -samples.climb[row];
    jacobian(row, next) = factor * samples.by_lag[row] / slope;
  }
  return jacobian;
}

// A straight line over the command.
ThrustModel firstModel(const CurveShape& shape, const ThrustSamples& samples) {
  Eigen::MatrixXd columns(samples.rows(), 2);
  columns.col(0).setOnes();
  columns.col(1) = samples.command;
  const Eigen::Vector2d line = columns.colPivHouseholderQr().solve(samples.force);
  if (!(line[1] > 0.0)) throw Error("the thrust does not rise with thrust_cmd: wrong signal, clock or sign");
  ThrustModel model;
  model.values.resize(shape.degree() + 1);
  for (Eigen::Index i = 0; i < model.values.size(); ++i)
    model.values[i] = (shape.thrusts()[static_cast<std::size_t>(i)] - line[0]) / line[1];
  return model;
}

// Takes as much of a step as lowers the loss and leaves a curve that rises. `rises`: whether all of it does.
struct StepSearch {
  const CurveShape& shape;
  const ThrustSamples& samples;
  double scale;

  bool take(ThrustModel* model, const Eigen::VectorXd& step, bool* rises) const {
    const double before = huberLoss(samples.force - model->predict(shape, samples), scale);
    double share = 1.0;
    for (int halving = 0; halving < kThrustHalvings; ++halving, share *= 0.5) {
      const ThrustModel next = Unknowns(samples).moved(*model, step, share);
      if (!shape.rises(next.values)) {
        *rises = false;
        continue;
      }
      if (huberLoss(samples.force - next.predict(shape, samples), scale) > before) continue;
      *model = next;
      return true;
    }
    return false;
  }
};

}  // namespace

CurveShape::CurveShape(int degree, double least, double greatest, double farthest)
    : middle_(0.5 * (least + greatest)),
      half_(0.5 * (greatest - least)),
      end_(std::clamp(farthest / half_, kNearestEnd, kFarthestEnd)) {
  const Eigen::Index count = degree + 1;
  Eigen::MatrixXd values(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    thrusts_.push_back(least + (greatest - least) * static_cast<double>(i) / degree);
    values.row(i) = powersOf(scaled(thrusts_.back()), count);
  }
  powers_ = values.inverse();
}

Eigen::RowVectorXd CurveShape::valueRow(double thrust) const {
  const double x = scaled(thrust);
  const double inside = std::clamp(x, -end_, end_);
  return (powersOf(inside, powers_.rows()) + (x - inside) * slopesOf(inside, powers_.rows())) * powers_;
}

Eigen::RowVectorXd CurveShape::slopeRow(double thrust) const {
  return slopesOf(std::clamp(scaled(thrust), -end_, end_), powers_.rows()) * powers_ / half_;
}

Eigen::RowVectorXd CurveShape::highestRow() const { return powers_.bottomRows(1); }

bool CurveShape::rises(const Eigen::VectorXd& values) const {
  const Eigen::VectorXd factors = powers_ * values;
  const double mean = 0.5 * (values[values.size() - 1] - values[0]);
  if (!(mean > 0.0)) return false;
  for (int i = 0; i <= kSlopeProbes; ++i) {
    const double x = end_ * (2.0 * i / kSlopeProbes - 1.0);
    if (!(slopesOf(x, powers_.rows()).dot(factors) > kLeastSlopeShare * mean)) return false;
  }
  return true;
}

// Newton's method, kept within the bracket.
double CurveShape::thrustOf(double command, const Eigen::VectorXd& values) const {
  // Without memory from the heap: this is where the time goes.
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostValues, 1> factors;
  factors.noalias() = powers_ * values;
  const auto at = [&](double x) {
    double sum = 0.0;
    for (Eigen::Index i = factors.size() - 1; i >= 0; --i) sum = sum * x + factors[i];
    return sum;
  };
  const auto slope = [&](double x) {
    double sum = 0.0;
    for (Eigen::Index i = factors.size() - 1; i > 0; --i) sum = sum * x + static_cast<double>(i) * factors[i];
    return sum;
  };
  double x = 0.0;
  if (command <= at(-end_)) {
    x = -end_ + (command - at(-end_)) / slope(-end_);
  } else if (command >= at(end_)) {
    x = end_ + (command - at(end_)) / slope(end_);
  } else {
    double from = -end_;
    double to = end_;
    for (int round = 0; round < kThrustRounds; ++round) {
      const double excess = at(x) - command;
      if (std::abs(excess) < kCommandFound) break;
      (excess > 0.0 ? to : from) = x;
      x -= excess / slope(x);
      if (!(x > from && x < to)) x = 0.5 * (from + to);
    }
  }
  return middle_ + half_ * x;
}

std::vector<double> CurveShape::coefficients(const Eigen::VectorXd& values) const {
  // Powers of (F - middle) / half, multiplied out by Horner's rule.
  const Eigen::VectorXd factors = powers_ * values;
  std::vector<double> result = {factors[factors.size() - 1]};
  for (Eigen::Index i = factors.size() - 2; i >= 0; --i) {
    std::vector<double> next(result.size() + 1, 0.0);
    for (std::size_t k = 0; k < result.size(); ++k) {
      next[k] -= result[k] * middle_ / half_;
      next[k + 1] += result[k] / half_;
    }
    next[0] += factors[i];
    result = std::move(next);
  }
  return result;
}

Eigen::VectorXd ThrustModel::predict(const CurveShape& shape, const ThrustSamples& samples) const {
  Eigen::VectorXd thrust(samples.rows());
  for (Eigen::Index row = 0; row < samples.rows(); ++row) {
    const double factor = samples.battery.size() > 0 ? std::exp(battery * samples.battery[row]) : 1.0;
    thrust[row] = shape.thrustOf(samples.command[row] * factor, values);
  }
  if (samples.climb.size() > 0) thrust -= climb_drag * samples.climb;
  return thrust;
}

ThrustModel fitThrustModel(const CurveShape& shape, const ThrustSamples& samples) {
  ThrustModel model = firstModel(shape, samples);
  bool rises = true;
  for (int round = 0; round < kThrustRounds; ++round) {
    const Eigen::VectorXd residuals = samples.force - model.predict(shape, samples);
    const double scale = std::max(robustScale(residuals), std::numeric_limits<double>::min());
    const Eigen::VectorXd roots = residuals.unaryExpr([reach = kHuberReach * scale](double residual) {
      return std::abs(residual) <= reach ? 1.0 : std::sqrt(reach / std::abs(residual));
    });
    const Eigen::MatrixXd jacobian = jacobianOf(model, shape, samples);
    // The lag is that of the search.
    const Eigen::MatrixXd columns = jacobian.leftCols(jacobian.cols() - 1);
    const Eigen::VectorXd step =
        (roots.asDiagonal() * columns).colPivHouseholderQr().solve(roots.cwiseProduct(residuals));
    rises = true;
    if (!StepSearch{shape, samples, scale}.take(&model, step, &rises)) break;
    if (step.head(model.values.size()).cwiseAbs().maxCoeff() < kThrustConverged) break;
  }
  model.rises = rises;
  return model;
}

void findCovariance(const CurveShape& shape, const ThrustSamples& samples, ThrustModel* model) {
  const Eigen::VectorXd residuals = samples.force - model->predict(shape, samples);
  const double scale = std::max(robustScale(residuals), std::numeric_limits<double>::min());
  const Eigen::MatrixXd jacobian = jacobianOf(*model, shape, samples);
  const RobustCovariance robust =
      robustCovariance(jacobian, residuals, scale, samples.starts, jacobian.cols() - 1);
  model->covariance = robust.covariance;
  model->interval_factor = intervalFactor(robust.lag_share);
}

CommandRegression regressOnCommand(const ThrustSamples& samples) {
  const bool battery = samples.battery.size() > 0;
  const bool climb = samples.climb.size() > 0;
  Eigen::MatrixXd columns(samples.rows(), 3 + (battery ? 1 : 0) + (climb ? 1 : 0));
  columns.col(0).setOnes();
  columns.col(1) = samples.command;
  columns.col(2) = samples.command.cwiseAbs2();
  Eigen::Index next = 3;
  if (battery) columns.col(next++) = samples.command.cwiseProduct(samples.battery);
  if (climb) columns.col(next) = samples.climb;
  // Few columns of like size: the normal equations are exact enough to compare lags, and much faster.
  const Eigen::VectorXd found =
      (columns.transpose() * columns).ldlt().solve(columns.transpose() * samples.force);
  CommandRegression result;
  result.mean_square = (samples.force - columns * found).squaredNorm() / static_cast<double>(samples.rows());
  const Eigen::Index thrust = columns.cols() - (climb ? 1 : 0);
  result.modelled = columns.leftCols(thrust) * found.head(thrust);
  return result;
}

}  // namespace polyfly
