#include "safety_filter/uncertain_model.hpp"

#include <algorithm>
#include <utility>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// The series of the matrix exponential ends after this many terms. With ||A|| t <= kGreatestExponent, what it
// leaves out is below 1e-18.
constexpr int kTerms = 40;
constexpr int kGreatestExponent = 4;
// Entries of the sampled model are multiples of 2^-kFractionBits.
constexpr unsigned kFractionBits = 60;

RationalMatrix magnitudes(const RationalMatrix& matrix) {
  return matrix.unaryExpr([](const Rational& value) { return Rational(abs(value)); });
}

Rational norm(const RationalMatrix& matrix) {
  return matrix.size() == 0 ? Rational(0) : Rational(magnitudes(matrix).rowwise().sum().maxCoeff());
}

Rational greatestEntry(const RationalMatrix& matrix) {
  return matrix.size() == 0 ? Rational(0) : Rational(magnitudes(matrix).maxCoeff());
}

/// A matrix with the greatest error of its entries.
struct Bounded {
  RationalMatrix value;
  Rational error = 0;
};

Bounded roundedEntries(Bounded exact) {
  const Rational step(Integer(1), Integer(1) << kFractionBits);
  Rational error = 0;
  for (int i = 0; i < exact.value.rows(); ++i) {
    for (int j = 0; j < exact.value.cols(); ++j) {
      const Rational near = nearestMultiple(exact.value(i, j), step);
      error = std::max<Rational>(error, abs(near - exact.value(i, j)));
      exact.value(i, j) = near;
    }
  }
  exact.error += error;
  return exact;
}

// Sum of |A|^k t^k / k! from k = kTerms on is below this: ||A||^k t^k / k! falls by half at least from there.
Rational truncation(const RationalMatrix& A, const Rational& t) {
  const Rational exponent = norm(A) * t;
  Rational term = 1;
  for (int k = 1; k <= kTerms; ++k) term = term * exponent / k;
  return 2 * term;
}

/// exp(A t)
Bounded exponential(const RationalMatrix& A, const Rational& t) {
  RationalMatrix power = RationalMatrix::Identity(A.rows(), A.rows());
  Bounded result{power, truncation(A, t)};
  Rational factor = 1;
  for (int k = 1; k < kTerms; ++k) {
    power = power * A;
    if (greatestEntry(power) == 0) return {std::move(result.value), 0};
    factor = factor * t / k;
    result.value += power * factor;
  }
  return result;
}

/// Integral of exp(A s) B over s in [0, t]. With `absolute`, of the entries' magnitudes term by term: a bound of
/// the integral of |exp(A s) B|, which divided by t grows with t.
Bounded integral(const RationalMatrix& A, const RationalMatrix& B, const Rational& t, bool absolute) {
  RationalMatrix power = B;
  Bounded result{RationalMatrix(B.rows(), B.cols()), t * truncation(A, t) * greatestEntry(B)};
  Rational factor = 1;
  for (int k = 1; k <= kTerms; ++k) {
    factor = factor * t / k;
    result.value += (absolute ? magnitudes(power) : power) * factor;
    power = A * power;
    if (greatestEntry(power) == 0) return {std::move(result.value), 0};
  }
  return result;
}

Bounded difference(Bounded left, const Bounded& right) {
  left.value -= right.value;
  left.error += right.error;
  return left;
}

struct Interval {
  Rational lower, upper;
  Rational middle() const { return (lower + upper) / 2; }
  Rational half() const { return (upper - lower) / 2; }
  Rational greatest() const { return std::max<Rational>(abs(lower), abs(upper)); }
};

std::vector<Interval> intervals(const std::vector<Signal>& signals) {
  std::vector<Interval> result;
  for (const Signal& signal : signals) result.push_back({Rational(signal.lower), Rational(signal.upper)});
  return result;
}

/// What the problem says, in fractions.
struct Given {
  explicit Given(const SafetyFilterProblem& problem)
      : A(exactly(problem.A_c)),
        B(exactly(problem.B_c)),
        E(exactly(problem.Bd_c)),
        states(intervals(problem.states)),
        inputs(intervals(problem.inputs)),
        disturbances(intervals(problem.disturbances)),
        period(problem.sampling_time),
        delay(problem.delay) {}

  RationalMatrix A, B, E;
  std::vector<Interval> states, inputs, disturbances;
  Rational period, delay;
};

/// Greatest |sum_j M_ij x_j| over a box, added to `sum`.
void addRange(const RationalMatrix& M, int row, const std::vector<Interval>& box, Rational& lower,
              Rational& upper) {
  for (int j = 0; j < M.cols(); ++j) {
    const Interval& range = box[static_cast<std::size_t>(j)];
    const Rational one = M(row, j) * range.lower, other = M(row, j) * range.upper;
    lower += std::min(one, other);
    upper += std::max(one, other);
  }
}

// With x'' bounded by z over a period, x stays within h^2/8 z of the chord between two samples. z bounds
// exp(|A| h) |A (A x + B u + E d)|, plus |A B| times the change of the input where it changes within the period.
// That change bends x itself by |B| times the change of the input, tau (h - tau) / h at most.
RationalVector excursionOf(const Given& given) {
  const int nx = static_cast<int>(given.A.rows());
  const RationalMatrix AA = given.A * given.A, AB = given.A * given.B, AE = given.A * given.E;
  const Rational& h = given.period;
  const bool bent = given.delay > 0 && given.delay < h;
  std::vector<Interval> middle;
  for (const Interval& range : given.disturbances) middle.push_back({range.middle(), range.middle()});
  RationalVector second(static_cast<std::size_t>(nx));
  for (int i = 0; i < nx; ++i) {
    Rational lower = 0, upper = 0;
    addRange(AA, i, given.states, lower, upper);
    addRange(AB, i, given.inputs, lower, upper);
    addRange(AE, i, middle, lower, upper);
    Rational& z = second[static_cast<std::size_t>(i)];
    z = std::max<Rational>(abs(lower), abs(upper));
    for (int j = 0; bent && j < AB.cols(); ++j)
      z += abs(AB(i, j)) * 2 * given.inputs[static_cast<std::size_t>(j)].half();
  }
  const RationalMatrix A = magnitudes(given.A);
  const Bounded growth = exponential(A, h);
  RationalVector result(static_cast<std::size_t>(nx));
  for (int i = 0; i < nx; ++i) {
    Rational z = 0;
    for (int j = 0; j < nx; ++j)
      z += (growth.value(i, j) + growth.error) * second[static_cast<std::size_t>(j)];
    Rational& bend = result[static_cast<std::size_t>(i)];
    bend = h * h / 8 * z;
    for (int j = 0; bent && j < given.B.cols(); ++j)
      bend += given.delay * (h - given.delay) / h * abs(given.B(i, j)) * 2 *
              given.inputs[static_cast<std::size_t>(j)].half();
  }
  return result;
}

/// The matrices of one period, and what their errors may do.
struct Sampled {
  Bounded A, B_before, B, c;
  Bounded disturbance, input;  ///< bounds of |integral|, see integral()
};

Sampled sample(const Given& given) {
  const Rational& h = given.period;
  const Rational rest = h - given.delay;
  RationalMatrix drift(given.A.rows(), 1);
  for (int i = 0; i < drift.rows(); ++i) {
    for (int j = 0; j < given.E.cols(); ++j)
      drift(i, 0) += given.E(i, j) * given.disturbances[static_cast<std::size_t>(j)].middle();
  }
  Sampled sampled;
  sampled.A = roundedEntries(exponential(given.A, h));
  const Bounded late = integral(given.A, given.B, rest, false);
  sampled.B_before = roundedEntries(difference(integral(given.A, given.B, h, false), late));
  sampled.B = roundedEntries(late);
  sampled.c = roundedEntries(integral(given.A, drift, h, false));
  sampled.disturbance = integral(given.A, given.E, h, true);
  sampled.input = integral(given.A, given.B, h, true);
  return sampled;
}

Rational uncertainty(const SafetyFilterProblem& problem, const Given& given, const Sampled& sampled, int i) {
  Rational w = sampled.c.error + Rational(problem.state_errors[i]);
  for (int j = 0; j < given.A.cols(); ++j) {
    w += (abs(sampled.A.value(i, j)) + sampled.A.error) * Rational(problem.state_errors[j]);
    w += sampled.A.error * given.states[static_cast<std::size_t>(j)].greatest();
  }
  for (int j = 0; j < given.B.cols(); ++j) {
    w += (sampled.B.error + (given.delay > 0 ? sampled.B_before.error : Rational(0))) *
         given.inputs[static_cast<std::size_t>(j)].greatest();
    w += (sampled.input.value(i, j) + sampled.input.error) * Rational(problem.input_errors[j]);
  }
  for (int j = 0; j < given.E.cols(); ++j)
    w += (sampled.disturbance.value(i, j) + sampled.disturbance.error) *
         given.disturbances[static_cast<std::size_t>(j)].half();
  return w;
}

void setStateRow(const SafetyFilterProblem& problem, const Given& given, const Sampled& sampled, int i,
                 UncertainModel& model) {
  const auto row = static_cast<std::size_t>(i);
  const int nx = problem.stateCount();
  for (int j = 0; j < nx; ++j) model.A(i, j) = sampled.A.value(i, j);
  for (int j = 0; j < problem.inputCount(); ++j) {
    model.B(i, j) = sampled.B.value(i, j);
    if (problem.delay > 0.0) model.A(i, nx + j) = sampled.B_before.value(i, j);
  }
  model.c[row] = sampled.c.value(i, 0);
  model.W[row] = uncertainty(problem, given, sampled, i);
  const Rational inset = Rational(problem.state_errors[i]) + model.excursion[row];
  model.lower[row] = given.states[row].lower + inset;
  model.upper[row] = given.states[row].upper - inset;
  if (model.lower[row] >= model.upper[row]) {
    throw Error(problem.source + ": model.states[" + std::to_string(i) +
                "].range: nothing is left of it after measurement error and excursion between samples (" +
                std::to_string(inset.get_d()) + " at each end)");
  }
}

}  // namespace

UncertainModel uncertainModel(const SafetyFilterProblem& problem) {
  const Given given(problem);
  const Rational exponent = norm(given.A) * given.period;
  if (exponent > kGreatestExponent) {
    throw Error(problem.source +
                ": sampling_time: the greatest row sum of |A| times the period must be at most " +
                std::to_string(kGreatestExponent) + ", is " + std::to_string(exponent.get_d()));
  }
  const Sampled sampled = sample(given);
  const int nx = problem.stateCount(), nu = problem.inputCount(), n = problem.augmentedCount();
  const auto size = static_cast<std::size_t>(n);
  UncertainModel model;
  model.A = RationalMatrix(n, n);
  model.B = RationalMatrix(n, nu);
  model.c.resize(size);
  model.W.resize(size);
  model.lower.resize(size);
  model.upper.resize(size);
  model.excursion = excursionOf(given);
  model.excursion.resize(size);
  for (int i = 0; i < nx; ++i) setStateRow(problem, given, sampled, i, model);
  for (int j = 0; j < nu; ++j) {
    const Interval& range = given.inputs[static_cast<std::size_t>(j)];
    model.u_lower.push_back(range.lower);
    model.u_upper.push_back(range.upper);
    if (n == nx) continue;
    const auto row = static_cast<std::size_t>(nx + j);
    model.B(nx + j, j) = 1;
    model.W[row] = Rational(problem.input_errors[j]);
    model.lower[row] = range.lower;
    model.upper[row] = range.upper;
  }
  for (std::size_t i = 0; i < size; ++i)
    model.slack.push_back(Rational(problem.margin) * (model.upper[i] - model.lower[i]) / 2);
  return model;
}

}  // namespace polyfly
