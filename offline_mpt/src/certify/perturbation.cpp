#include <algorithm>
#include <cmath>

#include "arithmetic/exact_numbers.hpp"
#include "certify/tolerances.hpp"
#include "exact_kkt/exact_equalities.hpp"
#include "mpc_core/scaled_program.hpp"
#include "offline_mpt/exact_lp.hpp"
#include "polyfly_base/error.hpp"
#include "program/definite_hessian.hpp"
#include "program/program_rows.hpp"
#include "program/repeated_rows.hpp"
#include "program/slater_point.hpp"

namespace polyfly {
namespace {

constexpr int kPenalties = 40;  // powers of 4 that are tried as a penalty

bool isConvex(const ParametricProgram& program, const ProgramPerturbation& adjustment) {
  const int n = program.variableCount();
  const std::vector<Rational> H = hessian(program, adjustment.basis, adjustment.penalty);
  long least = kNoBit;
  for (const Rational& value : H) include(least, value);
  IntegerMatrix whole(n, n);
  for (int i = 0; i < n && least != kNoBit; ++i) {
    for (int j = 0; j < n; ++j) whole(i, j) = scaled(H[i * n + j], -least);
  }
  return positiveSemidefinite(std::move(whole));
}

/// The least weights of rows, those of inequalities at least zero and of the rows in `needed` at least one,
/// that cancel all numbers of (A, S, b); empty if there are none.
ZeroCombination combineToZero(const ParametricProgram& program, const std::vector<int>& rows,
                              const std::vector<int>& needed) {
  const int entries = program.variableCount() + program.parameterCount() + 1;
  ExactLp lp;
  lp.addRows(entries);
  for (int i = 0; i < entries; ++i) lp.setRowBounds(i, ExactLp::Bound::kFixed, 0, 0);
  lp.addColumns(static_cast<int>(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const int column = static_cast<int>(k);
    const bool equality = isEquality(program, rows[k]);
    const bool is_needed = std::find(needed.begin(), needed.end(), rows[k]) != needed.end();
    lp.setColumnBounds(column, equality ? ExactLp::Bound::kFree : ExactLp::Bound::kLower, is_needed ? 1 : 0,
                       0);
    lp.setObjective(column, equality ? 0 : 1);
    for (int i = 0; i < entries; ++i) {
      const double value = rowEntry(program, rows[k], i);
      if (value != 0.0) lp.setCoefficient(i, column, Rational(value));
    }
  }
  if (lp.solve() != ExactLp::Status::kOptimal) return {};
  std::vector<Rational> weights;
  for (int k = 0; k < lp.columnCount(); ++k) weights.push_back(lp.primal(k));
  const Integer denominator = commonDenominator(weights);
  ZeroCombination result;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (weights[k] != 0) result.emplace_back(rows[k], Rational(weights[k] * denominator).get_num());
  }
  return result;
}

/// Proves the inequalities among `rows` to hold with equality wherever the program is feasible. False, and the
/// adjustment as it was, where that cannot be done.
bool proveImplied(const ParametricProgram& program, const std::vector<int>& rows,
                  ProgramPerturbation& adjustment) {
  ZeroCombination proof = combineToZero(program, rows, rows);
  if (proof.empty()) return false;
  adjustment.implied.push_back(std::move(proof));
  return true;
}

void takeEqualities(const ParametricProgram& program, ProgramPerturbation& adjustment) {
  ParametricProgram widened = program;
  if (!findSlaterPoint(widened).feasible)
    throw Error(program.name + ": no parameter of the box admits a solution; there is nothing to certify");
  std::vector<int> rows = program.equalities;
  if (widened.equalities.size() > program.equalities.size() &&
      proveImplied(program, widened.equalities, adjustment))
    rows = widened.equalities;
  chooseBasis(program, rows, adjustment);
}

void makeConvex(const ParametricProgram& program, ProgramPerturbation& adjustment) {
  if (program.H.cwiseAbs().maxCoeff() == 0.0) return;
  requireDefinite(program, adjustment.basis);
  if (isConvex(program, adjustment)) return;
  double penalty = std::ldexp(1.0, std::ilogb(program.H.cwiseAbs().maxCoeff()));
  for (int k = 0; k < kPenalties && !adjustment.basis.empty(); ++k, penalty *= 4.0) {
    adjustment.penalty = penalty;
    if (isConvex(program, adjustment)) return;
  }
  throw Error(program.name + ": H: not positive semidefinite in exact arithmetic");
}

// The exploration has the shortest of several optima in units of its own.
void chooseWeights(const ParametricProgram& program, ProgramPerturbation& adjustment) {
  const std::vector<int> sizes = scaleProgram(program).variables;
  if (!program.H.isZero(0.0) || sizes.empty()) return;
  const auto [least, greatest] = std::minmax_element(sizes.begin(), sizes.end());
  if (*least == *greatest) return;
  for (const int size : sizes) adjustment.weights.push_back(2 * (*greatest - size));
}

bool exactlyRepeated(const ParametricProgram& program, int i, int k) {
  Eigen::Index pivot = 0;
  program.A.row(k).cwiseAbs().maxCoeff(&pivot);
  const Rational own(program.A(i, pivot)), other(program.A(k, pivot));
  const auto same = [&](double a, double b) { return Rational(a) * other == Rational(b) * own; };
  for (int j = 0; j < program.variableCount(); ++j) {
    if (!same(program.A(i, j), program.A(k, j))) return false;
  }
  for (int j = 0; j < program.parameterCount(); ++j) {
    if (!same(program.S(i, j), program.S(k, j))) return false;
  }
  return same(program.b(i), program.b(k));
}

void dropRepeated(const ParametricProgram& program, const std::vector<char>& may_drop,
                  ProgramPerturbation& adjustment) {
  const RepeatedRows rows(scaleProgram(program).program);
  for (int i = 0; i < program.rowCount(); ++i) {
    if (!may_drop[i] || isEquality(program, i)) continue;
    for (int k = 0; k < program.rowCount(); ++k) {
      const bool gone =
          std::find(adjustment.dropped.begin(), adjustment.dropped.end(), k) != adjustment.dropped.end();
      if (k == i || gone || rows.distance(i, k) > tolerance::kMostRepeated) continue;
      if (exactlyRepeated(program, i, k)) continue;  // no harm: their slacks are multiples of each other
      adjustment.dropped.push_back(i);
      break;
    }
  }
  std::sort(adjustment.dropped.begin(), adjustment.dropped.end());
}

}  // namespace

ProgramPerturbation adjust(const ParametricProgram& program, const std::vector<char>& may_drop) {
  ProgramPerturbation adjustment;
  takeEqualities(program, adjustment);
  makeConvex(program, adjustment);
  chooseWeights(program, adjustment);
  dropRepeated(program, may_drop, adjustment);
  return adjustment;
}

}  // namespace polyfly
