#include "identification/fit_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit_uncertainty.hpp"
#include "linear_part.hpp"
#include "polyfly_base/error.hpp"
#include "shape_search.hpp"

namespace polyfly {
namespace {

// First scale as a share of the response's deviation. The residuals are not known yet.
constexpr double kFirstScale = 0.1;
// Least scale as a share of the response's deviation, for noise-free data.
constexpr double kLeastScale = 1e-9;
// Reweighting rounds outside the search.
constexpr int kFinalRounds = 25;
// Number of local searches that each give a new scale.
constexpr int kScaleRounds = 2;
// Step of the difference quotient for the delay [s].
constexpr double kDelayStep = 1e-4;
// Relative step of the difference quotients for the other shape parameters.
constexpr double kRelativeStep = 1e-4;

double deviation(const Eigen::VectorXd& values) {
  return std::sqrt((values.array() - values.mean()).square().mean());
}

double fitPercent(const Eigen::VectorXd& response, const Eigen::VectorXd& model) {
  return 100.0 * (1.0 - (response - model).norm() / (response.array() - response.mean()).matrix().norm());
}

std::vector<std::vector<double>> split(const Eigen::VectorXd& all, const std::vector<Eigen::Index>& starts) {
  std::vector<std::vector<double>> parts;
  for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
    parts.emplace_back(all.data() + starts[i], all.data() + starts[i + 1]);
  }
  return parts;
}

void checkSegments(const std::vector<LoopSegment>& segments) {
  if (segments.empty()) throw Error("no stretch of data to fit to");
  double least_command = std::numeric_limits<double>::max();
  double greatest_command = std::numeric_limits<double>::lowest();
  double least_response = least_command;
  double greatest_response = greatest_command;
  for (const LoopSegment& segment : segments) {
    const auto [low, high] = std::minmax_element(segment.command.value.begin(), segment.command.value.end());
    least_command = std::min(least_command, *low);
    greatest_command = std::max(greatest_command, *high);
    const auto [bottom, top] = std::minmax_element(segment.response.begin(), segment.response.end());
    least_response = std::min(least_response, *bottom);
    greatest_response = std::max(greatest_response, *top);
  }
  if (!(least_command < greatest_command))
    throw Error("the command is constant: nothing can be learnt from it");
  if (!(least_response < greatest_response))
    throw Error("the response is constant: the sensor or the column is dead");
}

// d model / d shape parameter by central differences, at the current linear part.
Eigen::VectorXd shapeDerivative(LinearPart& part, LoopShape shape, double LoopShape::*entry, double step) {
  const Eigen::VectorXd coefficients = part.coefficients();
  const double middle = shape.*entry;
  const auto model_at = [&](double value) -> Eigen::VectorXd {
    shape.*entry = value;
    part.setShape(shape);
    return part.columns() * coefficients;
  };
  const Eigen::VectorXd above = model_at(middle + step);
  const Eigen::VectorXd below = model_at(middle - step);
  return (above - below) / (2.0 * step);
}

// The unknowns of the covariance: gain, shape, offset, and last the initial states.
Eigen::MatrixXd jacobian(LinearPart& part, const LoopShape& shape, bool with_delay) {
  part.setShape(shape);
  const Eigen::MatrixXd linear = part.columns();
  std::vector<Eigen::VectorXd> nonlinear;
  if (shape.order == LoopOrder::kFirst) {
    nonlinear.push_back(shapeDerivative(part, shape, &LoopShape::tau, kRelativeStep * shape.tau));
  } else {
    nonlinear.push_back(shapeDerivative(part, shape, &LoopShape::omega, kRelativeStep * shape.omega));
    nonlinear.push_back(shapeDerivative(part, shape, &LoopShape::zeta, kRelativeStep * shape.zeta));
  }
  if (with_delay) nonlinear.push_back(shapeDerivative(part, shape, &LoopShape::delay, kDelayStep));
  const auto count = static_cast<Eigen::Index>(nonlinear.size());
  Eigen::MatrixXd all(linear.rows(), linear.cols() + count);
  all.col(0) = linear.col(0);
  for (Eigen::Index k = 0; k < count; ++k) all.col(1 + k) = nonlinear[static_cast<std::size_t>(k)];
  all.rightCols(linear.cols() - 1) = linear.rightCols(linear.cols() - 1);
  part.setShape(shape);
  return all;
}

// From the covariance of (gain, omega, zeta, ...) to that of (a0, a1, b0, ...).
Eigen::MatrixXd secondOrderTransform(const LoopFit& fit, Eigen::Index size) {
  const double omega = fit.shape.omega;
  const double zeta = fit.shape.zeta;
  Eigen::MatrixXd transform = Eigen::MatrixXd::Identity(size, size);
  transform.topLeftCorner(3, 3) << 0.0, 2.0 * omega, 0.0,  //
      0.0, 2.0 * zeta, 2.0 * omega,                        //
      omega * omega, 2.0 * fit.gain * omega, 0.0;
  return transform;
}

void nameParameters(bool with_delay, LoopFit* fit) {
  auto& list = fit->parameters;
  if (fit->shape.order == LoopOrder::kFirst) {
    list = {{"gain", "1", fit->gain}, {"tau", "s", fit->shape.tau}};
  } else {
    const double a0 = fit->shape.omega * fit->shape.omega;
    list = {{"a0", "1/s^2", a0},
            {"a1", "1/s", 2.0 * fit->shape.zeta * fit->shape.omega},
            {"b0", "1/s^2", fit->gain * a0}};
  }
  if (with_delay) list.push_back({"delay", "s", fit->shape.delay});
  list.push_back({"offset", "", fit->offset});
}

void addUncertainty(LinearPart& part, bool delay_free, bool with_delay, LoopFit* fit) {
  nameParameters(with_delay, fit);
  const Eigen::VectorXd residuals = part.residuals();
  const Eigen::MatrixXd gradient = jacobian(part, fit->shape, delay_free);
  const Eigen::Index leading = (fit->shape.order == LoopOrder::kFirst ? 3 : 4) + (delay_free ? 1 : 0);
  const RobustCovariance robust =
      robustCovariance(gradient, residuals, fit->residual_scale, part.starts(), leading);
  Eigen::MatrixXd covariance = robust.covariance;
  if (fit->shape.order == LoopOrder::kSecond) {
    const Eigen::MatrixXd transform = secondOrderTransform(*fit, leading);
    covariance = transform * covariance * transform.transpose();
  }
  const double factor = intervalFactor(robust.lag_share);
  Eigen::Index row = 0;
  for (FittedParameter& parameter : fit->parameters) {
    // A delay at the end of its search has no error.
    const bool fixed = parameter.name == "delay" && !delay_free;
    parameter.standard_error =
        fixed ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(covariance(row, row));
    parameter.half_width = factor * parameter.standard_error;
    row += fixed ? 0 : 1;
  }
  if (fit->shape.order == LoopOrder::kFirst && delay_free) fit->lag_delay_covariance = covariance(1, 2);
}

}  // namespace

const FittedParameter* LoopFit::find(const std::string& name) const {
  for (const FittedParameter& parameter : parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

LoopFit fitLoop(const std::vector<LoopSegment>& segments, const FitOptions& options) {
  checkSegments(segments);
  const ShapeSpace space(options);
  LinearPart part(segments);
  const double spread = deviation(part.response());
  ShapeSearch search{&space, &part, kFirstScale * spread};
  ShapeUnknowns best = search.global(options.global_evaluations);
  for (int round = 0; round < kScaleRounds; ++round) {
    best = search.local(options.local_evaluations, best);
    part.setShape(space.shape(best));
    part.solve(search.scale, kFinalRounds);
    search.scale = std::max(robustScale(part.residuals()), kLeastScale * spread);
  }
  best = search.local(options.local_evaluations, best);

  LoopFit fit;
  fit.shape = space.shape(best);
  part.setShape(fit.shape);
  part.solve(search.scale, kFinalRounds);
  fit.gain = part.coefficients()[0];
  fit.offset = part.coefficients()[1];
  fit.residual_scale = search.scale;
  fit.samples = static_cast<std::size_t>(part.samples());
  fit.fit_percent = fitPercent(part.response(), part.model());
  fit.prediction = split(part.model(), part.starts());
  addUncertainty(part, !space.delayAtBound(best), options.with_delay, &fit);
  return fit;
}

LoopPrediction predictLoop(const LoopFit& fit, const std::vector<LoopSegment>& segments) {
  checkSegments(segments);
  LinearPart part(segments);
  part.setShape(fit.shape);
  const Eigen::Vector2d held(fit.gain, fit.offset);
  part.solve(std::max(fit.residual_scale, std::numeric_limits<double>::min()), kFinalRounds, &held);
  LoopPrediction result;
  result.fit_percent = fitPercent(part.response(), part.model());
  result.prediction = split(part.model(), part.starts());
  return result;
}

}  // namespace polyfly
