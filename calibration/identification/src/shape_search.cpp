#include "shape_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>

namespace polyfly {
namespace {

// Reweighting rounds during the search.
constexpr int kSearchRounds = 3;
// Relative tolerance of the local search.
constexpr double kLocalTolerance = 1e-7;
constexpr double kAtBound = 1e-6;  // [s]

// First step of a local search, as a share of the box.
constexpr double kFirstStep = 0.03;
// Least distance between the start of a local search and the bounds, as a share of the box.
constexpr double kFromBound = 1e-4;

// Signature of NLopt.
double loss(const ShapeUnknowns& at, ShapeUnknowns&, void* data) {
  const auto* search = static_cast<ShapeSearch*>(data);
  search->part->setShape(search->space->shape(at));
  const double value = search->part->solve(search->scale, kSearchRounds);
  return std::isfinite(value) ? value : std::numeric_limits<double>::max();
}

ShapeUnknowns minimise(ShapeSearch* search, nlopt::algorithm algorithm, int evaluations,
                       ShapeUnknowns start) {
  nlopt::opt optimizer(algorithm, static_cast<unsigned>(start.size()));
  optimizer.set_lower_bounds(search->space->lower());
  optimizer.set_upper_bounds(search->space->upper());
  optimizer.set_min_objective(loss, search);
  optimizer.set_maxeval(evaluations);
  optimizer.set_xtol_rel(kLocalTolerance);
  // Away from the bounds, where the first simplex would have no width.
  std::vector<double> step;
  for (std::size_t i = 0; i < start.size(); ++i) {
    const double lower = search->space->lower()[i];
    const double upper = search->space->upper()[i];
    step.push_back(kFirstStep * (upper - lower));
    start[i] =
        std::clamp(start[i], lower + kFromBound * (upper - lower), upper - kFromBound * (upper - lower));
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

}  // namespace

ShapeSpace::ShapeSpace(const FitOptions& options) : options_(options) {
  if (options.order == LoopOrder::kFirst) {
    add(std::log(options.tau_least), std::log(options.tau_greatest));
  } else {
    add(std::log(options.omega_least), std::log(options.omega_greatest));
    add(std::log(options.zeta_least), std::log(options.zeta_greatest));
  }
  if (options.with_delay) add(options.delay_least, options.delay_greatest);
}

LoopShape ShapeSpace::shape(const ShapeUnknowns& at) const {
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

bool ShapeSpace::delayAtBound(const ShapeUnknowns& at) const {
  return !options_.with_delay || at.back() < options_.delay_least + kAtBound;
}

void ShapeSpace::add(double least, double greatest) {
  lower_.push_back(least);
  upper_.push_back(greatest);
}

ShapeUnknowns ShapeSearch::global(int evaluations) {
  ShapeUnknowns middle(space->lower().size());
  for (std::size_t i = 0; i < middle.size(); ++i) middle[i] = 0.5 * (space->lower()[i] + space->upper()[i]);
  return minimise(this, nlopt::GN_DIRECT_L, evaluations * (middle.size() > 2 ? 2 : 1), middle);
}

ShapeUnknowns ShapeSearch::local(int evaluations, const ShapeUnknowns& start) {
  return minimise(this, nlopt::LN_NELDERMEAD, evaluations, start);
}

}  // namespace polyfly
