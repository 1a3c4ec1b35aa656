#include "identification/fit_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>
#include <utility>

#include "fit_uncertainty.hpp"
#include "linear_part.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Reweighting rounds during the search, and outside of it.
constexpr int kSearchRounds = 3;
constexpr int kFinalRounds = 25;
// Relative tolerance of the local search.
constexpr double kLocalTolerance = 1e-7;
// First step of a local search, and the least distance of its start from the bounds, as shares of the box.
constexpr double kFirstStep = 0.03;
constexpr double kFromBound = 1e-4;
// Delay up to which it counts as the least one [s].
constexpr double kAtBound = 1e-6;
// First scale as a share of the response's deviation. The residuals are not known yet.
constexpr double kFirstScale = 0.1;
// Least scale as a share of the response's deviation, for noise-free data.
constexpr double kLeastScale = 1e-9;
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

// Logarithms of tau, or of omega and zeta; then the delay, if it is looked for.
using ShapeUnknowns = std::vector<double>;

// Least loss over a box of shapes; what is linear is solved for at every point.
class ShapeSearch {
 public:
  // First scale of the residuals, in the response's unit.
  ShapeSearch(const FitOptions& options, LinearPart* part, double scale)
      : options_(options), part_(part), scale_(scale) {
    if (options.order == LoopOrder::kFirst) {
      add(std::log(options.tau_least), std::log(options.tau_greatest));
    } else {
      add(std::log(options.omega_least), std::log(options.omega_greatest));
      add(std::log(options.zeta_least), std::log(options.zeta_greatest));
    }
    if (options.with_delay) add(options.delay_least, options.delay_greatest);
  }

  LoopShape shape(const ShapeUnknowns& at) const {
    LoopShape shape;
    shape.order = options_.order;
    if (options_.order == LoopOrder::kFirst) {
      shape.tau = std::exp(at[0]);
    } else {
      shape.omega = std::exp(at[0]);
      shape.zeta = std::exp(at[1]);
    }
    if (options_.with_delay) shape.delay = at.back();
    return shape;
  }

  ShapeUnknowns minimise(nlopt::algorithm algorithm, int evaluations, ShapeUnknowns start) {
    nlopt::opt optimizer(algorithm, static_cast<unsigned>(start.size()));
    optimizer.set_lower_bounds(lower_);
    optimizer.set_upper_bounds(upper_);
    optimizer.set_min_objective(
        [](const ShapeUnknowns& at, ShapeUnknowns&, void* search) {
          return static_cast<ShapeSearch*>(search)->solveAt(at, kSearchRounds);
        },
        this);
    optimizer.set_maxeval(evaluations);
    optimizer.set_xtol_rel(kLocalTolerance);
    // Away from the bounds, where the first simplex would have no width.
    std::vector<double> step;
    for (std::size_t i = 0; i < start.size(); ++i) {
      const double width = upper_[i] - lower_[i];
      step.push_back(kFirstStep * width);
      start[i] = std::clamp(start[i], lower_[i] + kFromBound * width, upper_[i] - kFromBound * width);
    }
    optimizer.set_initial_step(step);
    double least = 0.0;
    try {
      optimizer.optimize(start, least);
    } catch (const nlopt::roundoff_limited&) {
      // `start` holds the best point so far, to the precision that the loss has.
    }
    return start;
  }

  // The best point of the whole box, then of its neighbourhood with the scale of the residuals.
  ShapeUnknowns best(double least_scale) {
    ShapeUnknowns at;
    for (std::size_t i = 0; i < lower_.size(); ++i) at.push_back(0.5 * (lower_[i] + upper_[i]));
    at = minimise(nlopt::GN_DIRECT_L, options_.global_evaluations * (at.size() > 2 ? 2 : 1), at);
    for (int round = 0; round <= kScaleRounds; ++round) {
      if (round > 0) scale_ = std::max(robustScale(part_->residuals()), least_scale);
      at = minimise(nlopt::LN_NELDERMEAD, options_.local_evaluations, at);
      solveAt(at, kFinalRounds);
    }
    return at;
  }

  double scale() const { return scale_; }

 private:
  void add(double least, double greatest) {
    lower_.push_back(least);
    upper_.push_back(greatest);
  }

  double solveAt(const ShapeUnknowns& at, int rounds) {
    part_->setShape(shape(at));
    const double value = part_->solve(scale_, rounds);
    return std::isfinite(value) ? value : std::numeric_limits<double>::max();
  }

  FitOptions options_;
  LinearPart* part_;
  double scale_;
  ShapeUnknowns lower_;
  ShapeUnknowns upper_;
};

void checkSegments(const std::vector<LoopSegment>& segments) {
  if (segments.empty()) throw Error("no stretch of data to fit to");
  const auto is_constant = [&segments](const auto& values_of) {
    const double first = values_of(segments.front()).front();
    return std::all_of(segments.begin(), segments.end(), [&](const LoopSegment& segment) {
      const std::vector<double>& values = values_of(segment);
      return std::all_of(values.begin(), values.end(), [first](double value) { return value == first; });
    });
  };
  if (is_constant([](const LoopSegment& one) -> const auto& { return one.command.value; }))
    throw Error("the command is constant: nothing can be learnt from it");
  if (is_constant([](const LoopSegment& one) -> const auto& { return one.response; }))
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
  const bool first = fit->shape.order == LoopOrder::kFirst;
  const Eigen::Index leading = (first ? 3 : 4) + (delay_free ? 1 : 0);
  Eigen::MatrixXd squares = intervalSquares(gradient, residuals, fit->residual_scale, part.starts(), leading);
  if (!first) {
    const Eigen::MatrixXd transform = secondOrderTransform(*fit, leading);
    squares = transform * squares * transform.transpose();
  }
  Eigen::Index row = 0;
  for (FittedParameter& parameter : fit->parameters) {
    // A delay at the end of its search has no error.
    const bool fixed = parameter.name == "delay" && !delay_free;
    parameter.half_width = fixed ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(squares(row, row));
    row += fixed ? 0 : 1;
  }
  if (first && delay_free) fit->lag_delay_square = squares(1, 2);
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
  LinearPart part(segments);
  const double spread = deviation(part.response());
  ShapeSearch search(options, &part, kFirstScale * spread);
  const ShapeUnknowns best = search.best(kLeastScale * spread);
  LoopFit fit;
  fit.shape = search.shape(best);
  fit.gain = part.coefficients()[0];
  fit.offset = part.coefficients()[1];
  fit.residual_scale = search.scale();
  fit.samples = static_cast<std::size_t>(part.samples());
  fit.fit_percent = fitPercent(part.response(), part.model());
  fit.prediction = split(part.model(), part.starts());
  const bool delay_free = options.with_delay && fit.shape.delay >= options.delay_least + kAtBound;
  addUncertainty(part, delay_free, options.with_delay, &fit);
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
