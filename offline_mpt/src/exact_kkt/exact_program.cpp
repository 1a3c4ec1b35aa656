#include "exact_kkt/exact_program.hpp"

#include <algorithm>

#include "arithmetic/exact_numbers.hpp"

namespace polyfly {
namespace {

std::vector<Rational> exactly(const Eigen::MatrixXd& M) {
  std::vector<Rational> values;
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    for (Eigen::Index j = 0; j < M.cols(); ++j) values.emplace_back(M(i, j));
  }
  return values;
}

/// (M theta + v) as p + 1 numbers per row.
std::vector<Rational> affine(const std::vector<Rational>& M, const std::vector<Rational>& v,
                             const ExactProgram& exact) {
  std::vector<Rational> result;
  for (std::size_t i = 0; i < v.size(); ++i) {
    Rational constant = v[i];
    for (int j = 0; j < exact.p; ++j) {
      const Rational& entry = M[i * static_cast<std::size_t>(exact.p) + j];
      result.push_back(entry * exact.half[j]);
      constant += entry * exact.centre[j];
    }
    result.push_back(constant);
  }
  return result;
}

/// The doubles of a program at their exact values.
RationalProgram exactNumbers(const ParametricProgram& program) {
  RationalProgram numbers;
  numbers.H = hessian(program, {}, 0.0);
  numbers.F = exactly(program.F);
  numbers.f = exactly(program.f);
  numbers.A = exactly(program.A);
  numbers.b = exactly(program.b);
  numbers.S = exactly(program.S);
  numbers.A_theta = exactly(program.A_theta);
  numbers.b_theta = exactly(program.b_theta);
  numbers.E = exactly(program.E);
  numbers.C = exactly(program.C);
  numbers.c = exactly(program.c);
  return numbers;
}

}  // namespace

std::vector<Rational> hessian(const ParametricProgram& program, const std::vector<int>& basis,
                              double penalty) {
  const int n = program.variableCount();
  std::vector<Rational> H;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      Rational value = (Rational(program.H(i, j)) + Rational(program.H(j, i))) / 2;
      for (std::size_t k = 0; penalty != 0.0 && k < basis.size(); ++k)
        value += Rational(penalty) * Rational(program.A(basis[k], i)) * Rational(program.A(basis[k], j));
      H.push_back(value);
    }
  }
  return H;
}

ExactProgram::ExactProgram(const ParametricProgram& program, const ProgramPerturbation& adjustment)
    : ExactProgram(program, exactNumbers(program), adjustment) {}

ExactProgram::ExactProgram(const ParametricProgram& program, const RationalProgram& numbers,
                           const ProgramPerturbation& adjustment)
    : ExactRanges(program.parameters),
      n(program.variableCount()),
      m(program.rowCount()),
      p(program.parameterCount()),
      q(program.inputCount()),
      linear(program.H.cwiseAbs().maxCoeff() == 0.0),
      basis(adjustment.basis),
      in_basis(static_cast<std::size_t>(m), 0),
      is_equality(static_cast<std::size_t>(m), 0),
      is_dropped(static_cast<std::size_t>(m), 0) {
  for (const int row : adjustment.basis) in_basis[row] = 1;
  for (const int row : adjustment.dropped) is_dropped[row] = 1;
  for (const int row : program.equalities) is_equality[row] = 1;

  std::vector<Rational> H_values = numbers.H;
  if (linear) {
    std::fill(H_values.begin(), H_values.end(), 0);
    for (int i = 0; i < n; ++i)
      H_values[i * (n + 1)] =
          Integer(1) << static_cast<unsigned long>(
              adjustment.weights.empty() ? 0 : adjustment.weights[static_cast<std::size_t>(i)]);
  }
  const std::vector<Rational> cost_values = affine(numbers.F, numbers.f, *this);
  const std::vector<Rational> bound_values = affine(numbers.S, numbers.b, *this);
  const auto a = [&](int i, int j) -> const Rational& {
    return numbers.A[static_cast<std::size_t>(i) * static_cast<std::size_t>(n) + static_cast<std::size_t>(j)];
  };
  long H_least = kNoBit, cost_least = kNoBit;
  for (const Rational& value : H_values) include(H_least, value);
  for (const Rational& value : cost_values) include(cost_least, value);
  H_exponent = -H_least;
  if (cost_least != kNoBit) shift = std::max(shift, H_least - cost_least);
  for (int i = 0; i < m; ++i) {
    long least = kNoBit, bound_least = kNoBit;
    for (int j = 0; j < n; ++j) include(least, a(i, j));
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
      A(i, j) = scaled(a(i, j), row_exponent[i]);
      if (mpz_cmpabs(A(i, j).get_mpz_t(), size.get_mpz_t()) > 0) size = abs(A(i, j));
    }
    row_size.push_back(size);
    for (int j = 0; j <= p; ++j) bound(i, j) = scaled(bound_values[i * (p + 1) + j], shift + row_exponent[i]);
  }
  std::vector<Rational> inwards = numbers.A_theta;
  for (Rational& value : inwards) value = -value;
  domain = wholeRows(affine(inwards, numbers.b_theta, *this), p + 1);
  E = numbers.E;
  offset = affine(numbers.C, numbers.c, *this);
}

}  // namespace polyfly
