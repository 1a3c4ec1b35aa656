#include "exact_program.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "margin.hpp"
#include "offline_mpt/exact_lp.hpp"
#include "region_maps/error.hpp"

namespace polyfly {
namespace {

constexpr double kSemidefinite = 1e-8;  // the solver adds this share of the mean eigenvalue to a singular H
constexpr double kRank = 1e-11;      // relative pivot below which the solver counts equalities as dependent
constexpr double kRepeated = 1e-11;  // relative difference of two rows that are the same but for rounding
constexpr int kPenalties = 40;       // powers of 4 that are tried as a penalty

/// The power of two in a number that is a whole multiple of it, and of no greater one.
long lowestBit(const Rational& value) {
  return static_cast<long>(mpz_scan1(value.get_num_mpz_t(), 0)) -
         static_cast<long>(mpz_sizeinbase(value.get_den_mpz_t(), 2)) + 1;
}

void include(long& least, const Rational& value) {
  if (value != 0) least = std::min(least, lowestBit(value));
}

/// value * 2^exponent, which must be whole.
Integer scaled(const Rational& value, long exponent) {
  Rational result = value;
  if (exponent >= 0) {
    mpq_mul_2exp(result.get_mpq_t(), result.get_mpq_t(), static_cast<mp_bitcnt_t>(exponent));
  } else {
    mpq_div_2exp(result.get_mpq_t(), result.get_mpq_t(), static_cast<mp_bitcnt_t>(-exponent));
  }
  return result.get_num();
}

constexpr long kNothing = std::numeric_limits<long>::max();

/// (M theta + v) as p + 1 numbers per row.
std::vector<Rational> affine(const Eigen::MatrixXd& M, const Eigen::VectorXd& v, const ExactProgram& exact) {
  std::vector<Rational> result;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    Rational constant(v(i));
    for (int j = 0; j < exact.p; ++j) {
      const Rational entry(M(i, j));
      result.push_back(entry * exact.half[j]);
      constant += entry * exact.centre[j];
    }
    result.push_back(constant);
  }
  return result;
}

/// Rows by powers of two: each has no fraction, and its numbers no common factor two.
IntegerMatrix wholeRows(const std::vector<Rational>& values, int columns) {
  const int rows = static_cast<int>(values.size()) / columns;
  IntegerMatrix result(rows, columns);
  for (int i = 0; i < rows; ++i) {
    long least = kNothing;
    for (int j = 0; j < columns; ++j) include(least, values[i * columns + j]);
    for (int j = 0; j < columns && least != kNothing; ++j)
      result(i, j) = scaled(values[i * columns + j], -least);
  }
  return result;
}

std::vector<Rational> hessian(const ParametricProgram& program, const Adjustment& adjustment) {
  const int n = program.variableCount();
  std::vector<Rational> H;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      Rational value = (Rational(program.H(i, j)) + Rational(program.H(j, i))) / 2;
      if (i == j) value += Rational(adjustment.regularisation);
      H.push_back(value);
    }
  }
  return H;
}

bool isConvex(const ParametricProgram& program, const Adjustment& adjustment) {
  const int n = program.variableCount();
  std::vector<Rational> H = hessian(program, adjustment);
  const Rational penalty(adjustment.penalty);
  if (penalty != 0) {
    for (const int row : adjustment.basis) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j)
          H[i * n + j] += penalty * Rational(program.A(row, i)) * Rational(program.A(row, j));
      }
    }
  }
  long least = kNothing;
  for (const Rational& value : H) include(least, value);
  IntegerMatrix whole(n, n);
  for (int i = 0; i < n && least != kNothing; ++i) {
    for (int j = 0; j < n; ++j) whole(i, j) = scaled(H[i * n + j], -least);
  }
  return positiveSemidefinite(std::move(whole));
}

bool isEquality(const ParametricProgram& program, int row) {
  return std::find(program.equalities.begin(), program.equalities.end(), row) != program.equalities.end();
}

/// Weights that prove the inequalities among `rows` to be equalities; empty if there are none.
ZeroCombination combineToZero(const ParametricProgram& program, const std::vector<int>& rows) {
  const int n = program.variableCount();
  const int p = program.parameterCount();
  ExactLp lp;
  lp.addRows(n + p + 1);
  for (int i = 0; i < n + p + 1; ++i) lp.setRowBounds(i, ExactLp::Bound::kFixed, 0, 0);
  lp.addColumns(static_cast<int>(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const int column = static_cast<int>(k);
    const auto type = isEquality(program, rows[k]) ? ExactLp::Bound::kFree : ExactLp::Bound::kLower;
    lp.setColumnBounds(column, type, 1, 0);
    for (int i = 0; i < n + p + 1; ++i) {
      const double value = i < n       ? program.A(rows[k], i)
                           : i < n + p ? program.S(rows[k], i - n)
                                       : program.b(rows[k]);
      if (value != 0.0) lp.setCoefficient(i, column, Rational(value));
    }
  }
  if (lp.solve() != ExactLp::Status::kOptimal) return {};
  Integer denominator(1);
  for (int k = 0; k < lp.columnCount(); ++k) denominator = lcm(denominator, lp.primal(k).get_den());
  ZeroCombination result;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Rational weight = lp.primal(static_cast<int>(k)) * denominator;
    if (weight != 0) result.emplace_back(rows[k], weight.get_num());
  }
  return result;
}

void takeEqualities(const ParametricProgram& program, Adjustment& adjustment) {
  ParametricProgram widened = program;
  if (!findMargin(widened).feasible)
    throw Error(program.name + ": no parameter of the box admits a solution; there is nothing to certify");
  std::vector<int> rows = program.equalities;
  if (widened.equalities.size() > program.equalities.size()) {
    ZeroCombination proof = combineToZero(program, widened.equalities);
    if (!proof.empty()) {
      rows = widened.equalities;
      adjustment.implied.push_back(std::move(proof));
    }
  }
  std::vector<Rational> values;
  for (const int row : rows) {
    for (int j = 0; j < program.variableCount(); ++j) values.emplace_back(program.A(row, j));
  }
  if (rows.empty()) return;
  for (const int k : independentRows(wholeRows(values, program.variableCount())))
    adjustment.basis.push_back(rows[static_cast<std::size_t>(k)]);
}

/// What the solver adds to H: nothing, unless H is singular where the equalities leave z free.
double solversRegularisation(const ParametricProgram& program, const Adjustment& adjustment) {
  const int n = program.variableCount();
  Eigen::MatrixXd Z = Eigen::MatrixXd::Identity(n, n);
  if (!adjustment.basis.empty()) {
    Eigen::MatrixXd A(n, static_cast<Eigen::Index>(adjustment.basis.size()));
    for (std::size_t k = 0; k < adjustment.basis.size(); ++k)
      A.col(static_cast<Eigen::Index>(k)) = program.A.row(adjustment.basis[k]);
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
    qr.setThreshold(kRank);
    const Eigen::MatrixXd Q = qr.householderQ();
    Z = Q.rightCols(n - qr.rank());
  }
  const Eigen::MatrixXd reduced = Z.transpose() * program.H * Z;
  if (reduced.rows() == 0) return 0.0;
  const double mean = reduced.trace() / static_cast<double>(reduced.rows());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(reduced, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(0) < kSemidefinite * mean ? kSemidefinite * mean : 0.0;
}

void makeConvex(const ParametricProgram& program, Adjustment& adjustment) {
  if (program.H.cwiseAbs().maxCoeff() == 0.0) return;
  adjustment.regularisation = solversRegularisation(program, adjustment);
  if (isConvex(program, adjustment)) return;
  double penalty = std::ldexp(1.0, std::ilogb(program.H.cwiseAbs().maxCoeff()));
  for (int k = 0; k < kPenalties && !adjustment.basis.empty(); ++k, penalty *= 4.0) {
    adjustment.penalty = penalty;
    if (isConvex(program, adjustment)) return;
  }
  throw Error(program.name + ": H: not positive semidefinite in exact arithmetic");
}

/// (A, S half, b + S centre) of a row, scaled to a greatest entry of one in A.
Eigen::VectorXd unitRow(const ParametricProgram& program, int row) {
  const int n = program.variableCount();
  const int p = program.parameterCount();
  Eigen::VectorXd result(n + p + 1);
  result.head(n) = program.A.row(row);
  result(n + p) = program.b(row);
  for (int j = 0; j < p; ++j) {
    const Signal& signal = program.parameters[static_cast<std::size_t>(j)];
    result(n + j) = program.S(row, j) * 0.5 * (signal.upper - signal.lower);
    result(n + p) += program.S(row, j) * 0.5 * (signal.upper + signal.lower);
  }
  const double largest = result.head(n).cwiseAbs().maxCoeff();
  return largest > 0.0 ? Eigen::VectorXd(result / largest) : Eigen::VectorXd(0 * result);
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
                  Adjustment& adjustment) {
  std::vector<Eigen::VectorXd> rows;
  for (int i = 0; i < program.rowCount(); ++i) rows.push_back(unitRow(program, i));
  const int n = program.variableCount();
  for (int i = 0; i < program.rowCount(); ++i) {
    if (!may_drop[i] || isEquality(program, i) || rows[i].isZero(0.0)) continue;
    for (int k = 0; k < program.rowCount(); ++k) {
      const bool gone =
          std::find(adjustment.dropped.begin(), adjustment.dropped.end(), k) != adjustment.dropped.end();
      if (k == i || gone || rows[k].isZero(0.0)) continue;
      const Eigen::VectorXd difference = rows[i] - rows[k];
      const double gap =
          difference.tail(1)(0) + difference.segment(n, program.parameterCount()).cwiseAbs().sum();
      const double scale = 1.0 + rows[k].cwiseAbs().maxCoeff();
      if (difference.head(n).cwiseAbs().maxCoeff() > kRepeated || std::abs(gap) > kRepeated * scale) continue;
      if (exactlyRepeated(program, i, k)) continue;  // no harm: their slacks are multiples of each other
      adjustment.dropped.push_back(i);
      break;
    }
  }
}

}  // namespace

ExactProgram::ExactProgram(const ParametricProgram& program, const Adjustment& adjustment)
    : n(program.variableCount()),
      m(program.rowCount()),
      p(program.parameterCount()),
      q(program.inputCount()),
      linear(program.H.cwiseAbs().maxCoeff() == 0.0),
      basis(adjustment.basis),
      in_basis(static_cast<std::size_t>(m), 0),
      is_equality(static_cast<std::size_t>(m), 0),
      is_dropped(static_cast<std::size_t>(m), 0) {
  for (const Signal& signal : program.parameters) {
    centre.push_back((Rational(signal.upper) + Rational(signal.lower)) / 2);
    half.push_back((Rational(signal.upper) - Rational(signal.lower)) / 2);
  }
  for (const int row : adjustment.basis) in_basis[row] = 1;
  for (const int row : adjustment.dropped) is_dropped[row] = 1;
  for (const int row : program.equalities) is_equality[row] = 1;

  std::vector<Rational> H_values = hessian(program, adjustment);
  if (linear) {
    for (int i = 0; i < n * n; ++i) H_values[i] = i % (n + 1) == 0 ? 1 : 0;
  }
  const std::vector<Rational> cost_values = affine(program.F, program.f, *this);
  const std::vector<Rational> bound_values = affine(program.S, program.b, *this);
  long H_least = kNothing, cost_least = kNothing;
  for (const Rational& value : H_values) include(H_least, value);
  for (const Rational& value : cost_values) include(cost_least, value);
  if (cost_least != kNothing) shift = std::max(shift, H_least - cost_least);
  for (int i = 0; i < m; ++i) {
    long least = kNothing, bound_least = kNothing;
    for (int j = 0; j < n; ++j) include(least, Rational(program.A(i, j)));
    for (int j = 0; j <= p; ++j) include(bound_least, bound_values[i * (p + 1) + j]);
    if (least == kNothing) least = bound_least == kNothing ? 0 : bound_least;
    row_exponent.push_back(-least);
    if (bound_least != kNothing) shift = std::max(shift, least - bound_least);
  }
  H = IntegerMatrix(n, n);
  cost = IntegerMatrix(n, p + 1);
  A = IntegerMatrix(m, n);
  bound = IntegerMatrix(m, p + 1);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) H(i, j) = scaled(H_values[i * n + j], -H_least);
    for (int j = 0; j <= p; ++j) cost(i, j) = scaled(cost_values[i * (p + 1) + j], shift - H_least);
  }
  for (int i = 0; i < m; ++i) {
    Integer size(0);
    for (int j = 0; j < n; ++j) {
      A(i, j) = scaled(Rational(program.A(i, j)), row_exponent[i]);
      if (mpz_cmpabs(A(i, j).get_mpz_t(), size.get_mpz_t()) > 0) size = abs(A(i, j));
    }
    row_size.push_back(size);
    for (int j = 0; j <= p; ++j) bound(i, j) = scaled(bound_values[i * (p + 1) + j], shift + row_exponent[i]);
  }
  domain = wholeRows(affine(-program.A_theta, program.b_theta, *this), p + 1);
  for (int i = 0; i < q; ++i) {
    for (int j = 0; j < n; ++j) E.emplace_back(program.E(i, j));
  }
  offset = affine(program.C, program.c, *this);
}

Adjustment adjust(const ParametricProgram& program, const std::vector<char>& may_drop) {
  Adjustment adjustment;
  takeEqualities(program, adjustment);
  makeConvex(program, adjustment);
  dropRepeated(program, may_drop, adjustment);
  return adjustment;
}

}  // namespace polyfly
