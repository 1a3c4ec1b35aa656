#include "safety_filter/safe_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/read_problem.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "polytope_sets/invariant_set.hpp"
#include "polytope_sets/polytope.hpp"
#include "safety_filter/prove_filter.hpp"
#include "safety_filter/uncertain_model.hpp"
#include "tolerances.hpp"

namespace polyfly {
namespace {

constexpr int kMaxIterations = 500;

RationalVector halfRanges(const UncertainModel& model) {
  RationalVector half;
  for (std::size_t i = 0; i < model.lower.size(); ++i) half.push_back((model.upper[i] - model.lower[i]) / 2);
  return half;
}

/// The model in coordinates of half ranges, so that one tolerance serves all. W grows by two margins: one is left
/// free by admissible inputs, one is for the recursion in floating point. The ranges shrink by one.
SetModel scaledModel(const SafetyFilterProblem& problem, const UncertainModel& model) {
  const int n = model.stateCount(), nu = model.inputCount();
  const RationalVector half = halfRanges(model);
  const auto scale = [&](int i) { return half[static_cast<std::size_t>(i)]; };
  SetModel scaled;
  scaled.name = problem.name;
  scaled.A = RationalMatrix(n, n);
  scaled.B = RationalMatrix(n, nu);
  scaled.E = RationalMatrix::Identity(n, n);
  scaled.A_p = RationalMatrix(n, 0);
  const Rational margin(problem.margin);
  RationalVector lower, upper, w_lower, w_upper;
  for (int i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    for (int j = 0; j < n; ++j) scaled.A(i, j) = model.A(i, j) * scale(j) / scale(i);
    for (int j = 0; j < nu; ++j) scaled.B(i, j) = model.B(i, j) / scale(i);
    scaled.c.push_back(model.c[at] / half[at]);
    lower.push_back(model.lower[at] / half[at] + margin);
    upper.push_back(model.upper[at] / half[at] - margin);
    w_upper.push_back(model.W[at] / half[at] + 2 * margin);
    w_lower.push_back(-w_upper.back());
  }
  scaled.X = ExactPolytope::box(lower, upper);
  scaled.U = ExactPolytope::box(model.u_lower, model.u_upper);
  scaled.D = ExactPolytope::box(w_lower, w_upper);
  return scaled;
}

/// The greatest double not above a fraction.
double below(const Rational& value) {
  double near = value.get_d();
  while (Rational(near) > value) near = std::nextafter(near, -std::numeric_limits<double>::infinity());
  return near;
}

/// Moves what rounding a row takes from it to its bound: coefficient `exact` became `rounded`, times at most
/// `greatest`.
void payRounding(const Rational& exact, double rounded, const Rational& greatest, Rational& bound) {
  bound -= abs(exact - Rational(rounded)) * greatest;
}

Rational greatestMagnitude(const Rational& lower, const Rational& upper) {
  return std::max<Rational>(abs(lower), abs(upper));
}

// H (A xi + B u + c) + |H| (W + slack) <= k as G u <= b + M xi in doubles, never weaker.
void addAdmissibleRow(const UncertainModel& model, Eigen::Index row, SafeSet& set) {
  const int n = model.stateCount(), nu = model.inputCount();
  RationalVector h;
  for (int j = 0; j < n; ++j) h.emplace_back(set.H(row, j));
  const RationalVector on_state = applyTransposed(model.A, h), on_input = applyTransposed(model.B, h);
  Rational bound = Rational(set.k[row]) - dot(h, model.c);
  for (std::size_t j = 0; j < h.size(); ++j) bound -= abs(h[j]) * (model.W[j] + model.slack[j]);
  double greatest = 0.0;
  for (int j = 0; j < n; ++j) {
    const auto at = static_cast<std::size_t>(j);
    set.M(row, j) = -nearestDouble(on_state[at]);
    greatest = std::max(greatest, std::fabs(set.M(row, j)));
    payRounding(on_state[at], -set.M(row, j), greatestMagnitude(model.lower[at], model.upper[at]), bound);
  }
  for (int j = 0; j < nu; ++j) set.G(row, j) = nearestDouble(on_input[static_cast<std::size_t>(j)]);
  if (set.G.row(row).cwiseAbs().maxCoeff() <= tolerance::kNoInput * greatest) set.G.row(row).setZero();
  for (int j = 0; j < nu; ++j) {
    const auto at = static_cast<std::size_t>(j);
    payRounding(on_input[at], set.G(row, j), greatestMagnitude(model.u_lower[at], model.u_upper[at]), bound);
  }
  set.b[row] = below(bound);
}

void requireSet(const SafetyFilterProblem& problem, const InvariantSet& found) {
  switch (found.status) {
    case InvariantSet::Status::kMaximal:
      return;
    case InvariantSet::Status::kEmpty:
      throw Error(problem.source +
                  ": model: no set of states can be kept within the ranges; inputs are too weak, or "
                  "disturbances, errors or delay too great");
    case InvariantSet::Status::kLimit:
      throw Error(problem.source + ": margin: no set within it after " + std::to_string(kMaxIterations) +
                  " steps of the recursion; a greater one needs fewer");
  }
}

}  // namespace

SafeSet computeSafeSet(const SafetyFilterProblem& problem) {
  const UncertainModel model = uncertainModel(problem);
  InvariantOptions options;
  options.exact = false;
  options.tolerance = tolerance::kToleranceOfMargin * problem.margin;
  options.max_iterations = kMaxIterations;
  const InvariantSet found = maximalInvariantSet(scaledModel(problem, model), options);
  requireSet(problem, found);
  const Polytope scaled = rounded(found.set);
  const RationalVector half = halfRanges(model);
  const Eigen::Index rows = scaled.A.rows(), n = model.stateCount();
  SafeSet set;
  set.H = scaled.A;
  set.k = scaled.b;
  for (Eigen::Index j = 0; j < n; ++j) set.H.col(j) /= half[static_cast<std::size_t>(j)].get_d();
  set.G.resize(rows, model.inputCount());
  set.b.resize(rows);
  set.M.resize(rows, n);
  for (Eigen::Index row = 0; row < rows; ++row) addAdmissibleRow(model, row, set);
  return set;
}

SafetyFilterProblem loadSafetyFilter(const std::string& path) {
  SafetyFilterProblem problem = parseSafetyFilter(readText(path), path);
  if (!problem.safe_set) problem = parseSafetyFilter(withSafeSet(problem, computeSafeSet(problem)), path);
  const FilterProof proof = proveFilter(problem);
  if (!proof.holds()) throw Error(path + ": safe_set: not proven: " + proof.failure);
  return problem;
}

ParametricProgram loadCompleteProgram(const std::string& path) {
  const bool yaml = endsWith(path, ".yaml") || endsWith(path, ".yml");
  if (!yaml || !isSafetyFilter(readText(path), path)) return loadProgram(path);
  return filterProgram(loadSafetyFilter(path));
}

}  // namespace polyfly
