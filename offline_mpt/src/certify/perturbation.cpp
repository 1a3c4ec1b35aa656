#include <algorithm>
#include <cmath>

#include "arithmetic/exact_numbers.hpp"
#include "certify/implied.hpp"
#include "certify/tolerances.hpp"
#include "exact_kkt/exact_equalities.hpp"
#include "polyfly_base/error.hpp"
#include "program/program_rows.hpp"
#include "program/repeated_rows.hpp"
#include "program/slater_point.hpp"

namespace polyfly {
namespace {

constexpr int kPenalties = 40;  // powers of 4 that are tried as a penalty

bool isConvex(const ParametricProgram& program, const ProgramPerturbation& adjustment) {
  const int n = program.variableCount();
  const std::vector<Rational> H = hessian(program, adjustment, adjustment.penalty);
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
  adjustment.singular = isSingular(program, adjustment.basis);
  if (adjustment.singular)
    adjustment.replaced = withoutRounding(program, adjustment.basis, adjustment.penalty);
  if (isConvex(program, adjustment)) return;
  double penalty = std::ldexp(1.0, std::ilogb(program.H.cwiseAbs().maxCoeff()));
  const bool may_try = !adjustment.basis.empty() && adjustment.replaced.empty();
  for (int k = 0; k < kPenalties && may_try; ++k, penalty *= 4.0) {
    adjustment.penalty = penalty;
    if (isConvex(program, adjustment)) return;
  }
  throw Error(program.name + ": H: not positive semidefinite in exact arithmetic");
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
  const RepeatedRows rows(program);
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

double greatestReplacement(const ParametricProgram& program, const ProgramPerturbation& adjustment) {
  using Matrix = ReplacedEntry::Matrix;
  ProgramPerturbation as_given;
  as_given.basis = adjustment.basis;
  const std::vector<Rational> H = hessian(program, as_given, adjustment.penalty);
  double H_size = 0.0, greatest = 0.0;
  for (const Rational& value : H) H_size = std::max(H_size, std::abs(value.get_d()));
  for (const ReplacedEntry& entry : adjustment.replaced) {
    Rational given;
    double size = 0.0;
    switch (entry.matrix) {
      case Matrix::kH:
        given = H[static_cast<std::size_t>(entry.row * program.variableCount() + entry.column)];
        size = H_size;
        break;
      case Matrix::kF:
        given = program.F(entry.row, entry.column);
        size = program.F.cwiseAbs().maxCoeff();
        break;
      case Matrix::kf:
        given = program.f(entry.row);
        size = program.f.cwiseAbs().maxCoeff();
        break;
      case Matrix::kA:
        given = program.A(entry.row, entry.column);
        size = program.A.row(entry.row).cwiseAbs().maxCoeff();
        break;
    }
    greatest = std::max(greatest, std::abs(Rational(entry.value - given).get_d()) / size);
  }
  return greatest;
}

ProgramPerturbation adjust(const ParametricProgram& program, const std::vector<char>& may_drop) {
  ProgramPerturbation adjustment;
  takeEqualities(program, adjustment);
  makeConvex(program, adjustment);
  dropRepeated(program, may_drop, adjustment);
  return adjustment;
}

}  // namespace polyfly
