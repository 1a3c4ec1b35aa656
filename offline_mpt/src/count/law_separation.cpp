#include "count/law_separation.hpp"

#include <algorithm>
#include <cmath>

#include "count/tolerances.hpp"
#include "mpc_core/dense_qp.hpp"
#include "offline_mpt/encode.hpp"
#include "program/program_rows.hpp"

namespace polyfly {
namespace {

/// Whether each variable is an output by itself.
bool outputsAll(const ParametricProgram& program) {
  for (int j = 0; j < program.variableCount(); ++j) {
    bool found = false;
    for (Eigen::Index i = 0; i < program.E.rows() && !found; ++i)
      found = program.E.row(i).cwiseAbs().sum() == 1.0 && program.E(i, j) == 1.0;
    if (!found) return false;
  }
  return true;
}

/// Greatest |theta| of each parameter.
Eigen::VectorXd greatestParameters(const ParametricProgram& program) {
  Eigen::VectorXd greatest(program.parameterCount());
  for (int j = 0; j < greatest.size(); ++j) {
    const Signal& signal = program.parameters[static_cast<std::size_t>(j)];
    greatest(j) = std::max(std::abs(signal.lower), std::abs(signal.upper));
  }
  return greatest;
}

/// Multipliers of max +-z_j over (z, t) that satisfy the rows and the box: 2 n rows, of z_j and -z_j.
Eigen::MatrixXd findWeights(const ParametricProgram& program) {
  const int n = program.variableCount(), p = program.parameterCount(), m = program.rowCount();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(m + 2 * p, n + p);
  Eigen::VectorXd b = Eigen::VectorXd::Ones(m + 2 * p);
  Eigen::VectorXd length = Eigen::VectorXd::Ones(m);
  for (int j = 0; j < p; ++j) {
    const Signal& signal = program.parameters[static_cast<std::size_t>(j)];
    const double centre = 0.5 * (signal.lower + signal.upper), half = 0.5 * (signal.upper - signal.lower);
    A.block(0, n + j, m, 1) = -half * program.S.col(j);
    b.head(m) += centre * program.S.col(j);
    A(m + 2 * j, n + j) = 1.0;
    A(m + 2 * j + 1, n + j) = -1.0;
  }
  A.topLeftCorner(m, n) = program.A;
  b.head(m) += program.b - Eigen::VectorXd::Ones(m);
  for (int i = 0; i < m; ++i) {
    const double size = A.row(i).norm();
    if (size > 0.0) length(i) = size;
    A.row(i) /= length(i);
    b(i) /= length(i);
  }
  DenseQp qp(tolerance::kBoundWeight * Eigen::MatrixXd::Identity(n + p, n + p), A, program.equalities);
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(2 * n, m);
  for (int j = 0; j < 2 * n; ++j) {
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n + p);
    g(j / 2) = j % 2 == 0 ? -1.0 : 1.0;
    if (qp.solve(g.data(), b.data()) != QpStatus::kOptimal) return {};
    weights.row(j) = qp.lambda().head(m).cwiseQuotient(length).transpose();
  }
  for (int i = 0; i < m; ++i) {
    if (!isEquality(program, i)) weights.col(i) = weights.col(i).cwiseMax(0.0);
  }
  return weights;
}

/// Upper bound of all |z_j|. A weighted sum of rows reads +-z_j + rest' z <= bound, with a small rest (COUNT.md).
/// Negative where no bound is known.
double greatestVariable(const ParametricProgram& program, const Eigen::MatrixXd& weights) {
  const Eigen::VectorXd reach = greatestParameters(program);
  double bound = 0.0, left = 0.0;
  for (Eigen::Index j = 0; j < weights.rows(); ++j) {
    Eigen::RowVectorXd rest = -weights.row(j) * program.A;
    rest(j / 2) += j % 2 == 0 ? 1.0 : -1.0;
    left = std::max(left, rest.cwiseAbs().sum());
    bound = std::max(bound, weights.row(j).dot(program.b) +
                                (weights.row(j) * program.S).cwiseAbs().dot(reach.transpose()));
  }
  return weights.rows() == 0 || left > tolerance::kMostLeft ? -1.0
                                                            : tolerance::kRoundingUp * bound / (1.0 - left);
}

}  // namespace

LawSeparation findLawSeparation(const ParametricProgram& program) {
  if (!outputsAll(program)) return {};
  LawSeparation gap;
  gap.weights = findWeights(program);
  const double greatest = greatestVariable(program, gap.weights);
  if (greatest < 0.0) return {};
  const Eigen::VectorXd outputs = greatest * program.E.cwiseAbs().rowwise().sum() +
                                  program.C.cwiseAbs() * greatestParameters(program) + program.c.cwiseAbs();
  const double difference =
      tolerance::kLawErrors * (program.parameterCount() + 1) * kSameLaw * std::max(1.0, outputs.maxCoeff());
  for (int i = 0; i < program.rowCount(); ++i)
    gap.slack.push_back(tolerance::kRoundingUp * difference * program.A.row(i).cwiseAbs().sum());
  return gap;
}

}  // namespace polyfly
