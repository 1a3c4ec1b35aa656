#include <algorithm>
#include <cmath>

#include "arithmetic/exact_numbers.hpp"
#include "certify/implied.hpp"
#include "certify/tolerances.hpp"
#include "exact_kkt/exact_equalities.hpp"
#include "mpc_core/scaled_program.hpp"
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
