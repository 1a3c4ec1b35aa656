#include <algorithm>
#include <cstdlib>
#include <set>

#include "polyfly_base/error.hpp"
#include "polytope_sets/invariant_set.hpp"
#include "rational_parts.hpp"
#include "robust_mpc/robust_program.hpp"

namespace polyfly {
namespace {

/// The states that decide how the bounded ones move: no other takes part.
std::set<int> boundedClosure(const RobustProblem& problem) {
  std::set<int> closure;
  for (int i = 0; i < problem.stateCount(); ++i) {
    if (problem.state_ranges[at(i)]) closure.insert(i);
  }
  for (bool grown = true; grown;) {
    grown = false;
    for (const int i : std::set<int>(closure)) {
      for (int j = 0; j < problem.stateCount(); ++j) {
        if (problem.A(i, j) != 0 && closure.insert(j).second) grown = true;
      }
    }
  }
  return closure;
}

/// Entries of theta that are part of the model: errors of these states, and every reference.
std::vector<int> entriesOf(const RobustProblem& problem, const std::set<int>& states) {
  std::vector<int> entries;
  for (int j = 0; j < problem.parameterCount(); ++j) {
    const int state = problem.parameters[at(j)].state;
    if (state < 0 || states.count(state) > 0) entries.push_back(j);
  }
  return entries;
}

void addStateRow(const RobustProblem& problem, const std::vector<int>& entries, int state, int sign,
                 const Rational& bound, ExactPolytope& X) {
  ExactHalfSpace row{RationalVector(entries.size()), bound};
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const RobustProblem::Parameter& parameter = problem.parameters[at(entries[k])];
    if (parameter.state == state) row.a[k] = sign;
    if (parameter.state < 0) row.a[k] = sign * parameter.state_shift[at(state)];
  }
  X.rows.push_back(std::move(row));
}

ExactPolytope bounds(const RobustProblem& problem, const std::vector<int>& entries,
                     const std::set<int>& states) {
  ExactPolytope X;
  X.dimension = static_cast<int>(entries.size());
  for (const int state : states) {
    const auto& range = problem.state_ranges[at(state)];
    if (!range)
      throw Error(problem.source + ": model.states: '" + problem.states[at(state)].name +
                  "' must have a range: bounded states depend on it, and invariance is asked for");
    addStateRow(problem, entries, state, 1, range->upper, X);
    addStateRow(problem, entries, state, -1, -range->lower, X);
  }
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const RobustProblem::Parameter& parameter = problem.parameters[at(entries[k])];
    if (parameter.state >= 0) continue;
    ExactHalfSpace row{RationalVector(entries.size()), parameter.range.upper};
    row.a[k] = 1;
    X.rows.push_back(row);
    row.a[k] = -1;
    row.b = -parameter.range.lower;
    X.rows.push_back(std::move(row));
  }
  return X;
}

/// theta+ of these entries under the absolute input u = u~ + input_shift r; references stay.
SetModel modelOf(const RobustProblem& problem, const std::vector<int>& entries) {
  const int n = static_cast<int>(entries.size()), nu = problem.inputCount(), nw = problem.channelCount();
  SetModel model;
  model.A = RationalMatrix(n, n);
  model.B = RationalMatrix(n, nu);
  model.E = RationalMatrix(n, nw);
  model.A_p = RationalMatrix(n, 0);
  model.c.resize(at(n));
  for (int r = 0; r < n; ++r) {
    const int state = problem.parameters[at(entries[at(r)])].state;
    if (state < 0) {
      model.A(r, r) = 1;
      continue;
    }
    model.c[at(r)] = problem.drift[at(state)];
    for (int j = 0; j < nu; ++j) model.B(r, j) = problem.B(state, j);
    for (int j = 0; j < nw; ++j) model.E(r, j) = problem.G(state, j);
    for (int s = 0; s < n; ++s) {
      const RobustProblem::Parameter& from = problem.parameters[at(entries[at(s)])];
      if (from.state >= 0) {
        model.A(r, s) = problem.A(state, from.state);
      } else {
        for (int j = 0; j < nu; ++j) model.A(r, s) -= problem.B(state, j) * from.input_shift[at(j)];
      }
    }
  }
  RationalVector lower, upper;
  for (const RobustProblem::Range& range : problem.input_ranges) {
    lower.push_back(range.lower);
    upper.push_back(range.upper);
  }
  model.U = ExactPolytope::box(lower, upper);
  model.D = ExactPolytope::box(RationalVector(at(nw), Rational(-1)), RationalVector(at(nw), Rational(1)));
  return model;
}

/// A power of two near the greatest coefficient: in whole numbers these grow beyond what a double holds, and
/// the rows are also read in doubles.
Rational magnitude(const RationalVector& a) {
  long most = 0;
  bool any = false;
  for (const Rational& value : a) {
    if (value == 0) continue;
    const long bits = static_cast<long>(mpz_sizeinbase(value.get_num_mpz_t(), 2)) -
                      static_cast<long>(mpz_sizeinbase(value.get_den_mpz_t(), 2));
    most = any ? std::max(most, bits) : bits;
    any = true;
  }
  const Rational power(mpz_class(1) << static_cast<unsigned>(std::abs(most)));
  return most >= 0 ? power : Rational(1) / power;
}

}  // namespace

ExactPolytope invariantParameters(const RobustProblem& problem) {
  const std::set<int> states = boundedClosure(problem);
  if (states.empty())
    throw Error(problem.source +
                ": invariance: must be none where no state has a range: nothing can be left");
  const std::vector<int> entries = entriesOf(problem, states);
  SetModel model = modelOf(problem, entries);
  model.X = bounds(problem, entries, states);
  const InvariantSet invariant = maximalInvariantSet(model);
  if (invariant.status == InvariantSet::Status::kEmpty)
    throw Error(problem.source +
                ": invariance: no state within the bounds can be kept there for all disturbances");
  if (invariant.status != InvariantSet::Status::kMaximal)
    throw Error(problem.source + ": invariance: the maximal invariant set was not reached in " +
                std::to_string(invariant.iterations) + " steps");
  ExactPolytope result;
  result.dimension = problem.parameterCount();
  for (const ExactHalfSpace& row : invariant.set.rows) {
    ExactHalfSpace full{RationalVector(at(result.dimension)), row.b};
    const Rational unit = magnitude(row.a);
    full.b /= unit;
    for (std::size_t k = 0; k < entries.size(); ++k) full.a[at(entries[k])] = row.a[k] / unit;
    result.rows.push_back(std::move(full));
  }
  return result;
}

}  // namespace polyfly
