#include <algorithm>
#include <cmath>
#include <iterator>

#include "fit_uncertainty.hpp"
#include "identification/motion.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

const char* const kAxes[] = {"x", "y", "z"};
// Number of parts of the record that are compared with each other.
constexpr Eigen::Index kParts = 4;
// Number of standard errors by which means may differ.
constexpr double kSignificant = 3.0;
// Acceleration that no wind gives a vehicle that flies on [m/s^2].
constexpr double kAbsurdBound = 9.8066;
// Factor by which deviations may differ.
constexpr double kRestless = 2.0;

// P(X <= count) for a binomial X of `trials` with the given chance.
double binomialAtMost(int count, int trials, double chance) {
  double sum = 0.0;
  for (int k = 0; k <= count; ++k) {
    const double logarithm = std::lgamma(trials + 1.0) - std::lgamma(k + 1.0) -
                             std::lgamma(trials - k + 1.0) + k * std::log(chance) +
                             (trials - k) * std::log1p(-chance);
    sum += std::exp(logarithm);
  }
  return std::min(1.0, sum);
}

// How many of the independent samples may lie beyond the bound, so that with the confidence asked for no more
// than `outside` of the time does; and the confidence that is reached.
std::pair<int, double> allowedBeyond(double independent, double outside, double confidence) {
  const int trials = std::max(1, static_cast<int>(independent));
  int beyond = 0;
  double reached = 1.0 - binomialAtMost(0, trials, outside);
  while (beyond + 1 < trials) {
    const double next = 1.0 - binomialAtMost(beyond + 1, trials, outside);
    if (next < confidence) break;
    reached = next;
    ++beyond;
  }
  return {beyond, reached};
}

double sortedQuantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - std::floor(place)) * (sorted[above] - sorted[below]);
}

// Quarters against each other; how much their means may differ follows from what moves within them.
void checkStationarity(const Eigen::VectorXd& residual, DisturbanceBound* bound) {
  const Eigen::Index size = residual.size() / kParts;
  if (size < 2) return;
  Eigen::VectorXd means(kParts);
  Eigen::VectorXd deviations(kParts);
  Eigen::VectorXd within(kParts * size);
  std::vector<Eigen::Index> starts = {0};
  for (Eigen::Index part = 0; part < kParts; ++part) {
    const Eigen::VectorXd piece = residual.segment(part * size, size);
    means[part] = piece.mean();
    within.segment(part * size, size) = piece.array() - means[part];
    deviations[part] = std::sqrt(within.segment(part * size, size).squaredNorm() / static_cast<double>(size));
    starts.push_back((part + 1) * size);
  }
  const double independent = independentSamples(within, starts) / static_cast<double>(kParts);
  const double error = deviations.mean() / std::sqrt(std::max(1.0, independent));
  if (means.maxCoeff() - means.minCoeff() > 2.0 * kSignificant * error) {
    bound->warnings.push_back(
        sentence("The mean wanders between %.3g and %.3g m/s^2 from quarter to quarter: the bound is that of "
                 "this flight only.",
                 means.minCoeff(), means.maxCoeff()));
  }
  if (deviations.maxCoeff() > kRestless * deviations.minCoeff()) {
    bound->warnings.push_back(sentence(
        "The deviation lies between %.3g and %.3g m/s^2 from quarter to quarter: calm and rough times "
        "are mixed.",
        deviations.minCoeff(), deviations.maxCoeff()));
  }
}

}  // namespace

std::vector<DisturbanceBound> boundDisturbance(const std::vector<Motion>& flights,
                                               const MotionOptions& options, const BoundOptions& limits) {
  std::vector<Eigen::Index> starts = {0};
  std::vector<double> unexplained[std::size(kAxes)];
  bool sound = true;
  for (const Motion& flight : flights) {
    for (std::size_t i = 1; i < flight.starts.size(); ++i)
      starts.push_back(starts.back() + flight.starts[i] - flight.starts[i - 1]);
    const Eigen::MatrixX3d left =
        flight.acceleration - flight.expected + flight.velocity * options.drag.asDiagonal();
    for (Eigen::Index axis = 0; axis < left.cols(); ++axis) {
      std::vector<double>& all = unexplained[axis];
      all.insert(all.end(), left.col(axis).data(), left.col(axis).data() + left.rows());
    }
    sound = sound && checkMotion(flight).empty();
  }
  std::vector<DisturbanceBound> bounds;
  for (std::size_t axis = 0; axis < (flights.front().thrust_known ? 3 : 2); ++axis) {
    std::vector<double>& sorted = unexplained[axis];
    const Eigen::VectorXd residual =
        Eigen::Map<const Eigen::VectorXd>(sorted.data(), static_cast<Eigen::Index>(sorted.size()));
    DisturbanceBound bound;
    bound.axis = kAxes[axis];
    bound.mean = residual.mean();
    bound.deviation = std::sqrt((residual.array() - bound.mean).square().mean());
    bound.independent_samples = independentSamples(residual, starts);
    std::sort(sorted.begin(), sorted.end());
    // Both sides must hold.
    const double outside = 0.5 * (1.0 - limits.share);
    const auto [beyond, reached] =
        allowedBeyond(bound.independent_samples, outside, 1.0 - 0.5 * (1.0 - limits.confidence));
    const double share = beyond / bound.independent_samples;
    bound.least = sortedQuantile(sorted, share);
    bound.greatest = sortedQuantile(sorted, 1.0 - share);
    bound.confidence = std::max(0.0, 1.0 - 2.0 * (1.0 - reached));
    if (bound.confidence < limits.confidence) {
      bound.warnings.push_back(
          sentence("The record tells as much as %.0f independent samples: the extremes hold with a "
                   "confidence of %.2g only. Fly longer.",
                   bound.independent_samples, bound.confidence));
    }
    const bool absurd = std::max(-bound.least, bound.greatest) > kAbsurdBound;
    if (absurd) {
      bound.warnings.push_back(
          sentence("The bounds of %.3g and %.3g m/s^2 reach beyond gravity: an upset, an impact or a wrong "
                   "unit is in the data, no disturbance of a flight.",
                   bound.least, bound.greatest));
    }
    bound.supported = sound && !absurd && bound.confidence >= limits.confidence;
    checkStationarity(residual, &bound);
    bounds.push_back(bound);
  }
  return bounds;
}

}  // namespace polyfly
