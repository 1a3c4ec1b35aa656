#include "mpc_core/online_program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mpc_core/identity_form.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kNoBound = std::numeric_limits<double>::infinity();
// Root of the condition up to which doubles solve the program as it is: they lose no more than half of their digits.
constexpr double kRootCondition = 1e4;

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

Eigen::VectorXd powersOfTwo(const std::vector<int>& exponents) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(exponents.size()));
  for (Eigen::Index i = 0; i < result.size(); ++i)
    result(i) = std::ldexp(1.0, exponents[static_cast<std::size_t>(i)]);
  return result;
}

}  // namespace

std::optional<OnlineProgram::Transformed> OnlineProgram::transform(const ParametricProgram& program) {
  const std::optional<IdentityForm> form = identityForm(affineProgram(program));
  if (!form) throw Error(program.name + ": H: must be positive definite to be solved online");
  if (form->root_condition <= kRootCondition) return std::nullopt;
  const Eigen::Index n = program.variableCount();
  const auto L = form->root.triangularView<Eigen::Lower>();
  const WideMatrix inverse = L.solve(WideMatrix::Identity(n, n));
  const WideMatrix cost = affineProgram(program).cost;
  return Transformed{rounded(form->rows), rounded(form->slack), rounded(inverse),
                     rounded(-(inverse.transpose() * (inverse * cost)))};
}

OnlineProgram::OnlineProgram(const ParametricProgram& program)
    : OnlineProgram(program, scaleProgram(program)) {}

OnlineProgram::OnlineProgram(const ParametricProgram& program, ScaledProgram scaled)
    : program_(program),
      units_(powersOfTwo(scaled.variables)),
      gradient_units_(std::ldexp(1.0, scaled.cost) * units_),
      scaled_(std::move(scaled.program)),
      transformed_(transform(scaled_)),
      qp_(scaled_.variableCount(), transformed_ ? scaled_.rowCount() : generalRows(scaled_)) {
  const Eigen::MatrixXd identity =
      Eigen::MatrixXd::Identity(scaled_.variableCount(), scaled_.variableCount());
  if (!qp_.setConstantHessian((transformed_ ? identity : scaled_.H).data()))
    throw Error(scaled_.name + ": H: must be positive definite to be solved online");
  is_equality_.assign(static_cast<std::size_t>(scaled_.rowCount()), 0);
  for (const int row : scaled_.equalities) is_equality_.at(static_cast<std::size_t>(row)) = 1;
  sortRows();
  g_ = Eigen::VectorXd::Zero(scaled_.variableCount());
  lower_ = upper_ = more_ = g_;
  b_ = Eigen::VectorXd::Zero(scaled_.rowCount());
  z_ = g_;
  affine_ = Eigen::VectorXd::Ones(scaled_.parameterCount() + 1);
  row_lower_ = row_upper_ = Eigen::VectorXd::Zero(qp_.rowCount());
}

void OnlineProgram::sortRows() {
  for (Eigen::Index j = 0; j < scaled_.S.cols(); ++j)
    if (!scaled_.S.col(j).isZero(0.0)) moving_.push_back(j);
  if (transformed_) {
    qp_.setRows(transformed_->rows.data());
    return;
  }
  Eigen::MatrixXd general(qp_.rowCount(), scaled_.variableCount());
  for (int i = 0; i < scaled_.rowCount(); ++i) {
    const int variable = singleEntry(scaled_.A, i);
    if (variable >= 0) {
      const double entry = scaled_.A(i, variable);
      const bool equality = is_equality_[static_cast<std::size_t>(i)] != 0;
      if (entry > 0.0 || equality) upper_bounds_.push_back({i, variable, 1.0 / entry});
      if (entry < 0.0 || equality) lower_bounds_.push_back({i, variable, 1.0 / entry});
    } else {
      general.row(static_cast<Eigen::Index>(rows_.size())) = scaled_.A.row(i);
      rows_.push_back(i);
    }
  }
  qp_.setRows(general.data());
}

void OnlineProgram::setBounds(const double* theta) noexcept {
  b_ = scaled_.b;
  for (const Eigen::Index j : moving_) b_ += theta[j] * scaled_.S.col(j);
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

QpStatus OnlineProgram::solveGiven(const double* theta, const double* more) noexcept {
  setBounds(theta);
  g_ = scaled_.f;
  g_.noalias() += scaled_.F * affine_.head(scaled_.parameterCount());
  if (more != nullptr) g_ += Eigen::Map<const Eigen::VectorXd>(more, scaled_.variableCount());
  const QpStatus status =
      qp_.solve({g_.data(), lower_.data(), upper_.data(), row_lower_.data(), row_upper_.data()},
                warm_ ? qp_.activeSet() : nullptr);
  if (status == QpStatus::kOptimal) z_ = Eigen::Map<const Eigen::VectorXd>(qp_.x(), scaled_.variableCount());
  return status;
}

QpStatus OnlineProgram::solveTransformed(const double* more) noexcept {
  row_upper_.noalias() = transformed_->slack * affine_;
  row_lower_.setConstant(-kNoBound);
  for (const int row : scaled_.equalities) row_lower_(row) = row_upper_(row);
  lower_.setConstant(-kNoBound);
  upper_.setConstant(kNoBound);
  g_.setZero();
  if (more != nullptr)
    g_.noalias() +=
        transformed_->inverse_root * Eigen::Map<const Eigen::VectorXd>(more, scaled_.variableCount());
  const QpStatus status =
      qp_.solve({g_.data(), lower_.data(), upper_.data(), row_lower_.data(), row_upper_.data()},
                warm_ ? qp_.activeSet() : nullptr);
  if (status != QpStatus::kOptimal) return status;
  z_.noalias() = transformed_->free * affine_;
  z_.noalias() += transformed_->inverse_root.transpose() *
                  Eigen::Map<const Eigen::VectorXd>(qp_.x(), scaled_.variableCount());
  return status;
}

QpStatus OnlineProgram::solve(const double* theta, double* u, const double* more) noexcept {
  const Eigen::Index p = program_.parameterCount();
  affine_.head(p) = Eigen::Map<const Eigen::VectorXd>(theta, p);
  if (more != nullptr)
    more_ = gradient_units_.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(more, units_.size()));
  const double* const added = more != nullptr ? more_.data() : nullptr;
  const QpStatus status = transformed_ ? solveTransformed(added) : solveGiven(theta, added);
  warm_ = status == QpStatus::kOptimal;
  if (!warm_) return status;
  z_.array() *= units_.array();
  Eigen::Map<Eigen::VectorXd> output(u, program_.inputCount());
  output = program_.c;
  output.noalias() += program_.E * z_;
  output.noalias() += program_.C * affine_.head(p);
  return status;
}

}  // namespace polyfly
