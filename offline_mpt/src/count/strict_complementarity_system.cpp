#include "count/strict_complementarity_system.hpp"

#include <gmpxx.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "arithmetic/tolerances.hpp"
#include "count/tolerances.hpp"
#include "mpc_core/decompositions.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// Ratio of the eigenvalues of H scaled to a unit diagonal.
double condition(const ParametricProgram& program) {
  const Eigen::VectorXd diagonal = program.H.diagonal();
  double least = -1.0, greatest = 0.0;
  if (diagonal.minCoeff() > 0.0) {
    const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
    const Eigen::VectorXd values = symmetricEigen(scale.asDiagonal() * program.H * scale.asDiagonal()).values;
    least = values(0);
    greatest = values(scale.size() - 1);
  }
  if (least <= tolerance::kDefiniteUnitDiagonal * greatest)
    throw Error(program.name + ": H: must be positive definite to count");
  return greatest / least;
}

/// Row i as (A, S, b).
std::vector<double> numbersOf(const ParametricProgram& program, int row) {
  std::vector<double> numbers;
  for (int j = 0; j < program.variableCount(); ++j) numbers.push_back(program.A(row, j));
  for (int j = 0; j < program.parameterCount(); ++j) numbers.push_back(program.S(row, j));
  numbers.push_back(program.b(row));
  return numbers;
}

bool isPositiveMultiple(const std::vector<double>& a, const std::vector<double>& b) {
  const auto lead = std::find_if(a.begin(), a.end(), [](double value) { return value != 0.0; }) - a.begin();
  if (lead == static_cast<std::ptrdiff_t>(a.size())) return false;
  const double ratio = b[static_cast<std::size_t>(lead)] / a[static_cast<std::size_t>(lead)];
  if (!(ratio > 0.0)) return false;
  for (std::size_t j = 0; j < a.size(); ++j) {
    if (std::abs(b[j] - ratio * a[j]) > tolerance::kMultiple * std::abs(b[j])) return false;
  }
  const mpq_class a_lead(a[static_cast<std::size_t>(lead)]), b_lead(b[static_cast<std::size_t>(lead)]);
  for (std::size_t j = 0; j < a.size(); ++j) {
    if (mpq_class(a[j]) * b_lead != mpq_class(b[j]) * a_lead) return false;
  }
  return true;
}

std::vector<int> firstOfEach(const ParametricProgram& program) {
  std::vector<std::vector<double>> numbers;
  std::vector<int> first_of;
  for (int i = 0; i < program.rowCount(); ++i) {
    numbers.push_back(numbersOf(program, i));
    int first = 0;
    while (first < i && (first_of[static_cast<std::size_t>(first)] != first ||
                         !isPositiveMultiple(numbers[static_cast<std::size_t>(first)], numbers.back())))
      ++first;
    first_of.push_back(first);
  }
  return first_of;
}

Eigen::MatrixXd domainRows(const ParametricProgram& program, const Eigen::VectorXd& centre,
                           const Eigen::VectorXd& half) {
  Eigen::MatrixXd rows(program.A_theta.rows(), half.size() + 1);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    rows.row(i).head(half.size()) = program.A_theta.row(i) * half.asDiagonal();
    rows(i, half.size()) = program.b_theta(i) - program.A_theta.row(i).dot(centre);
    const double length = rows.row(i).head(half.size()).norm();
    if (length > 0.0) rows.row(i) /= length;
  }
  return rows;
}

}  // namespace

StrictComplementaritySystem::StrictComplementaritySystem(const ParametricProgram& program)
    : m(program.rowCount()),
      p(program.parameterCount()),
      length(m),
      noise(tolerance::kDoubleRounding +
            tolerance::kWideRounding * condition(program) * program.variableCount()),
      equalities(program.equalities),
      first_of(firstOfEach(program)) {
  Eigen::VectorXd centre(p), half(p);
  for (int j = 0; j < p; ++j) {
    const Signal& signal = program.parameters[static_cast<std::size_t>(j)];
    centre(j) = 0.5 * (signal.lower + signal.upper);
    half(j) = 0.5 * (signal.upper - signal.lower);
  }
  const auto affine = [&](const Eigen::MatrixXd& matrix, const Eigen::VectorXd& vector) {
    Wide result(vector.size(), p + 1);
    result.leftCols(p) = matrix.cast<long double>() * half.cast<long double>().asDiagonal();
    result.col(p) = vector.cast<long double>() + matrix.cast<long double>() * centre.cast<long double>();
    return result;
  };
  const Eigen::LLT<Wide> root(program.H.cast<long double>());
  Wide rows = root.matrixL().solve(program.A.transpose().cast<long double>());  // n x m
  Wide distances =
      affine(program.S, program.b) + rows.transpose() * root.matrixL().solve(affine(program.F, program.f));
  for (int i = 0; i < m; ++i) {
    long double scale = rows.col(i).norm();
    if (scale == 0.0L) scale = std::max(distances.row(i).cwiseAbs().maxCoeff(), 1.0L);
    length(i) = static_cast<double>(scale);
    rows.col(i) /= static_cast<long double>(length(i));
    distances.row(i) /= static_cast<long double>(length(i));
  }
  gram = (rows.transpose() * rows).cast<double>();
  D = distances.cast<double>();
  slope = D.leftCols(p).rowwise().norm();
  reach = D.cwiseAbs().rowwise().sum();
  domain = domainRows(program, centre, half);
}

}  // namespace polyfly
