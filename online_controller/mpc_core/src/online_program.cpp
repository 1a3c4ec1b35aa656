#include "mpc_core/online_program.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// Index of the one entry of a row that is not 0; -1 if there are none or several.
int singleEntry(const Eigen::MatrixXd& A, Eigen::Index row) {
  int found = -1;
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    if (A(row, j) == 0.0) continue;
    if (found >= 0) return -1;
    found = static_cast<int>(j);
  }
  return found;
}

int generalRows(const ParametricProgram& program) {
  int count = 0;
  for (Eigen::Index i = 0; i < program.A.rows(); ++i) count += singleEntry(program.A, i) < 0 ? 1 : 0;
  return count;
}

}  // namespace

OnlineProgram::OnlineProgram(ParametricProgram program)
    : program_(std::move(program)), qp_(program_.variableCount(), generalRows(program_)) {
  if (!qp_.setConstantHessian(program_.H.data())) {
    throw Error(program_.name + ": H: must be positive definite to be solved online");
  }
  is_equality_.assign(static_cast<std::size_t>(program_.rowCount()), 0);
  for (const int row : program_.equalities) is_equality_.at(static_cast<std::size_t>(row)) = 1;
  sortRows();
  g_ = Eigen::VectorXd::Zero(program_.variableCount());
  lower_ = upper_ = g_;
  b_ = Eigen::VectorXd::Zero(program_.rowCount());
  row_lower_ = row_upper_ = Eigen::VectorXd::Zero(qp_.rowCount());
}

void OnlineProgram::sortRows() {
  Eigen::MatrixXd general(qp_.rowCount(), program_.variableCount());
  for (int i = 0; i < program_.rowCount(); ++i) {
    const int variable = singleEntry(program_.A, i);
    if (variable >= 0) {
      const double entry = program_.A(i, variable);
      const bool equality = is_equality_[static_cast<std::size_t>(i)] != 0;
      if (entry > 0.0 || equality) upper_bounds_.push_back({i, variable, 1.0 / entry});
      if (entry < 0.0 || equality) lower_bounds_.push_back({i, variable, 1.0 / entry});
    } else {
      general.row(static_cast<Eigen::Index>(rows_.size())) = program_.A.row(i);
      rows_.push_back(i);
    }
  }
  qp_.setRows(general.data());
  for (Eigen::Index j = 0; j < program_.S.cols(); ++j)
    if (!program_.S.col(j).isZero(0.0)) moving_.push_back(j);
}

void OnlineProgram::setBounds(const double* theta) noexcept {
  b_ = program_.b;
  for (const Eigen::Index j : moving_) b_ += theta[j] * program_.S.col(j);
  lower_.setConstant(-kNoBound);
  upper_.setConstant(kNoBound);
  for (const Bound& bound : upper_bounds_)
    upper_(bound.variable) = std::min(upper_(bound.variable), b_(bound.row) * bound.scale);
  for (const Bound& bound : lower_bounds_)
    lower_(bound.variable) = std::max(lower_(bound.variable), b_(bound.row) * bound.scale);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const int row = rows_[k];
    const auto i = static_cast<Eigen::Index>(k);
    row_upper_(i) = b_(row);
    row_lower_(i) = is_equality_[static_cast<std::size_t>(row)] != 0 ? b_(row) : -kNoBound;
  }
}

QpStatus OnlineProgram::solve(const double* theta, double* u, const double* more) noexcept {
  const Eigen::Map<const Eigen::VectorXd> parameters(theta, program_.parameterCount());
  setBounds(theta);
  g_ = program_.f;
  g_.noalias() += program_.F * parameters;
  if (more != nullptr) g_ += Eigen::Map<const Eigen::VectorXd>(more, program_.variableCount());
  const QpStatus status =
      qp_.solve({g_.data(), lower_.data(), upper_.data(), row_lower_.data(), row_upper_.data()},
                warm_ ? qp_.activeSet() : nullptr);
  warm_ = status == QpStatus::kOptimal;
  if (!warm_) return status;
  const Eigen::Map<const Eigen::VectorXd> z(qp_.x(), program_.variableCount());
  Eigen::Map<Eigen::VectorXd> output(u, program_.inputCount());
  output = program_.c;
  output.noalias() += program_.E * z;
  output.noalias() += program_.C * parameters;
  return status;
}

}  // namespace polyfly
