#include "problem/filter_model.hpp"

#include <algorithm>

#include "core/text.hpp"
#include "problem/optimal_control.hpp"

namespace checker {
namespace {

constexpr int kTerms = 120;
// Greatest row sum of |A| times the period.
constexpr int kMostExponent = 4;

BallMatrix column(const Vector& values) { return BallMatrix(Matrix{values.size(), 1, values}); }

/// Of each range, half of its upper end plus `sign` times its lower one.
BallMatrix halfOfEnds(const std::vector<FilterProblem::Range>& ranges, int sign) {
  Vector values;
  for (const auto& [lower, upper] : ranges)
    values.emplace_back((Fraction(upper) + sign * Fraction(lower)) / 2);
  return column(values);
}

BallMatrix halves(const std::vector<FilterProblem::Range>& ranges) { return halfOfEnds(ranges, -1); }
BallMatrix middles(const std::vector<FilterProblem::Range>& ranges) { return halfOfEnds(ranges, 1); }

BallMatrix errorsOf(const std::vector<double>& errors) {
  return column(Vector(errors.begin(), errors.end()));
}

/// With A and B of the problem.
DiscreteSystem after(const FilterProblem& problem, const BallMatrix& A, const Fraction& time) {
  TrackingProblem continuous;
  continuous.A = A;
  continuous.B = problem.B;
  continuous.B_d = problem.B_d;
  continuous.sampling_time = time;
  return discretised(continuous);
}

/// A bound of the integral of |exp(A s) B| over s in [0, t], entry by entry: sum of |A^k B| t^(k+1) / (k+1)!.
BallMatrix absoluteIntegral(const BallMatrix& A, const BallMatrix& B, const Fraction& t) {
  const Fraction exponent = A.norm() * t;
  require(exponent <= kMostExponent, "problem: sampling_time: is too long for the model");
  BallMatrix power = B, result(B.rows(), B.columns());
  Fraction factor = t, rest = t * B.greatest();
  for (int k = 0; k < kTerms; ++k) {
    result = result + power.magnitudes().scaled(factor);
    power = A * power;
    factor *= t / (k + 2);
    rest *= exponent / (k + 1);
  }
  // The terms that are left out fall by half at least.
  return result.widened(2 * rest);
}

/// How far the state bends out of the line from sample to sample.
class Excursion {
 public:
  explicit Excursion(const FilterProblem& problem)
      : problem_(problem),
        period_(problem.sampling_time),
        delay_(problem.delay),
        changes_(problem.delay > 0.0 && problem.delay < problem.sampling_time) {}

  /// h^2/8 times a bound of x'', and what a change of the input within the period adds.
  BallMatrix bound() const {
    const BallMatrix growth = after(problem_, problem_.A.magnitudes(), period_).A;
    const BallMatrix result = (growth * secondDerivative()).scaled(period_ * period_ / 8);
    if (!changes_) return result;
    return result + (problem_.B.magnitudes() * inputChange()).scaled(delay_ * (period_ - delay_) / period_);
  }

 private:
  /// The greatest |A (A x + B u + B_d d)|, d in the middle of its range.
  BallMatrix secondDerivative() const {
    const BallMatrix on_state = problem_.A * problem_.A, on_input = problem_.A * problem_.B;
    BallMatrix middle = on_state * middles(problem_.states) + on_input * middles(problem_.inputs);
    if (!problem_.disturbances.empty())
      middle = middle + problem_.A * problem_.B_d * middles(problem_.disturbances);
    BallMatrix result = middle.magnitudes() + on_state.magnitudes() * halves(problem_.states) +
                        on_input.magnitudes() * halves(problem_.inputs);
    return changes_ ? result + on_input.magnitudes() * inputChange() : result;
  }

  BallMatrix inputChange() const {
    const BallMatrix half = halves(problem_.inputs);
    return half + half;
  }

  const FilterProblem& problem_;
  const Fraction period_, delay_;
  const bool changes_;
};

/// Disturbances, errors of both measurements, and of the input, each at its worst.
BallMatrix uncertaintyOf(const FilterProblem& problem, const BallMatrix& A) {
  const Fraction period(problem.sampling_time);
  const BallMatrix measured = errorsOf(problem.state_errors);
  BallMatrix W = measured + A.magnitudes() * measured +
                 absoluteIntegral(problem.A, problem.B, period) * errorsOf(problem.input_errors);
  if (!problem.disturbances.empty())
    W = W + absoluteIntegral(problem.A, problem.B_d, period) * halves(problem.disturbances);
  return W;
}

void addRange(const FilterProblem::Range& range, const Fraction& inset, const Fraction& margin,
              FilterModel& model) {
  model.lower.push_back(Fraction(range.first) + inset);
  model.upper.push_back(Fraction(range.second) - inset);
  require(model.lower.back() < model.upper.back(), "nothing is left of the range of a state");
  model.slack.push_back(margin * (model.upper.back() - model.lower.back()) / 2);
}

}  // namespace

FilterModel filterModel(const FilterProblem& problem) {
  const std::size_t nx = problem.stateCount(), nu = problem.inputCount(), n = problem.size();
  const Fraction period(problem.sampling_time), delay(problem.delay), margin(problem.margin);
  const DiscreteSystem whole = after(problem, problem.A, period);
  const BallMatrix late = after(problem, problem.A, period - delay).B;
  FilterModel model{BallMatrix(n, n), BallMatrix(n, nu), BallMatrix(n, 1), {}, {}, {}, {}};
  model.A.setBlock(0, 0, whole.A);
  model.B.setBlock(0, 0, late);
  if (!problem.disturbances.empty()) model.c.setBlock(0, 0, whole.B_d * middles(problem.disturbances));
  const BallMatrix W = uncertaintyOf(problem, whole.A), excursion = Excursion(problem).bound();
  for (std::size_t i = 0; i < nx; ++i) {
    model.W.push_back(W.at(i, 0).greatest());
    addRange(problem.states[i], Fraction(problem.state_errors[i]) + excursion.at(i, 0).greatest(), margin,
             model);
  }
  if (!problem.hasDelay()) return model;
  // The input before acts until the new one does.
  model.A.setBlock(0, nx, whole.B - late);
  model.B.setBlock(nx, 0, BallMatrix::identity(nu));
  for (std::size_t j = 0; j < nu; ++j) {
    model.W.emplace_back(problem.input_errors[j]);
    addRange(problem.inputs[j], 0, margin, model);
  }
  return model;
}

}  // namespace checker
