#include "exact_program.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>

#include "exact_numbers.hpp"

namespace polyfly {
namespace {

constexpr double kSemidefinite = 1e-8;  // the solver adds this share of the mean eigenvalue to a singular H
constexpr double kRank = 1e-11;  // relative pivot below which the solver counts equalities as dependent

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

}  // namespace

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

ExactProgram::ExactProgram(const ParametricProgram& program, const Adjustment& adjustment)
    : n(program.variableCount()),
      m(program.rowCount()),
      p(program.parameterCount()),
      q(program.inputCount()),
      regularisation(adjustment.regularisation),
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
  std::vector<Rational> bound_values = affine(program.S, program.b, *this);
  for (const int row : adjustment.relaxed)
    bound_values[row * (p + 1) + p] +=
        Rational(program.A.row(row).cwiseAbs().maxCoeff()) / Rational(Integer(1) << kRelaxedBits);
  long H_least = kNoBit, cost_least = kNoBit;
  for (const Rational& value : H_values) include(H_least, value);
  for (const Rational& value : cost_values) include(cost_least, value);
  H_exponent = -H_least;
  if (cost_least != kNoBit) shift = std::max(shift, H_least - cost_least);
  for (int i = 0; i < m; ++i) {
    long least = kNoBit, bound_least = kNoBit;
    for (int j = 0; j < n; ++j) include(least, Rational(program.A(i, j)));
    for (int j = 0; j <= p; ++j) include(bound_least, bound_values[i * (p + 1) + j]);
    if (least == kNoBit) least = bound_least == kNoBit ? 0 : bound_least;
    row_exponent.push_back(-least);
    if (bound_least != kNoBit) shift = std::max(shift, least - bound_least);
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

}  // namespace polyfly
