#include "mpc_core/dense_qp.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <string>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Violation of a normalised row that is left alone, relative to 1 + |d|.
constexpr double kDenseFeasible = 1e-11;
constexpr double kDenseDependent = 1e-10;  // pivot below which a row depends on the active ones
constexpr double kVoidRow = 1e-13;         // squared length below which a row constrains nothing
constexpr int kPolishRounds = 10;          // restarts after rounding has spoilt the multipliers
// Multipliers above minus this, relative to the largest, count as non-negative.
constexpr double kDenseRounding = 1e-13;
constexpr double kDenseNegative = 1e-12;  // direction entries below this do not block

}  // namespace

DenseQp::DenseQp(const Eigen::MatrixXd& H, const Eigen::MatrixXd& A, std::vector<int> equalities)
    : n_(static_cast<int>(H.rows())),
      m_(static_cast<int>(A.rows())),
      equality_count_(static_cast<int>(equalities.size())),
      equalities_(std::move(equalities)) {
  if (H.cols() != H.rows() || (m_ > 0 && A.cols() != n_)) {
    throw Error("DenseQp: H must be n x n and A m x n, got " + std::to_string(H.rows()) + " x " +
                std::to_string(H.cols()) + " and " + std::to_string(m_) + " x " + std::to_string(A.cols()));
  }
  const Eigen::LLT<Eigen::MatrixXd> cholesky(H);
  if (cholesky.info() != Eigen::Success) throw Error("DenseQp: H must be positive definite");
  H_inverse_ = cholesky.solve(Eigen::MatrixXd::Identity(n_, n_));
  is_equality_.assign(m_, 0);
  for (const int row : equalities_) is_equality_.at(row) = 1;
  is_active_.assign(m_, 0);
  is_void_.assign(m_, 0);
  A_ = A;
  row_scale_ = Eigen::VectorXd::Ones(m_);
  for (int i = 0; i < m_; ++i) {
    const double squared = A.row(i) * H_inverse_ * A.row(i).transpose();
    const double reference = A.row(i).squaredNorm();
    if (squared <= kVoidRow * std::max(1.0, reference) || !(squared > 0.0)) {
      is_void_[i] = 1;
      A_.row(i).setZero();
      continue;
    }
    row_scale_(i) = 1.0 / std::sqrt(squared);
    A_.row(i) *= row_scale_(i);
  }
  W_ = H_inverse_ * A_.transpose();
  gram_ = A_ * W_;
  const int capacity = std::min(n_, m_) + 1;
  factor_ = Eigen::MatrixXd::Zero(capacity, capacity);
  direction_ = Eigen::VectorXd::Zero(capacity);
  active_.assign(capacity, 0);
  z_free_ = z_ = Eigen::VectorXd::Zero(n_);
  d_ = lambda_ = slack_ = Eigen::VectorXd::Zero(m_);
  iteration_limit_ = 20 * (n_ + m_) + 100;
}

QpStatus DenseQp::solve(const double* g, const double* b, bool warm) noexcept {
  iterations_ = 0;
  if (!startFrom(g, b)) return QpStatus::kNotFinite;
  if (warm) {
    warmStart();
  } else {
    for (int j = 0; j < active_count_; ++j) is_active_[active_[j]] = 0;
    active_count_ = 0;
    lambda_.setZero();
  }
  updateSlack();
  for (const int row : equalities_) {
    if (is_active_[row] || is_void_[row]) continue;
    if (satisfy(row) != StepResult::kAdded) return QpStatus::kInfeasible;
  }
  for (int i = 0; i < m_; ++i) {
    if (is_void_[i] && (d_(i) < -kDenseFeasible || (is_equality_[i] && d_(i) > kDenseFeasible))) {
      return QpStatus::kInfeasible;
    }
  }
  for (int round = 0; round < kPolishRounds; ++round) {
    for (int row = mostViolated(); row >= 0; row = mostViolated()) {
      switch (satisfy(row)) {
        case StepResult::kAdded:
          break;
        case StepResult::kInfeasible:
          return QpStatus::kInfeasible;
        case StepResult::kIterationLimit:
          return QpStatus::kIterationLimit;
      }
    }
    if (finish()) return QpStatus::kOptimal;
  }
  return QpStatus::kIterationLimit;
}

bool DenseQp::startFrom(const double* g, const double* b) noexcept {
  const Eigen::Map<const Eigen::VectorXd> gradient(g, n_);
  const Eigen::Map<const Eigen::VectorXd> bound(b, m_);
  z_free_.noalias() = -(H_inverse_ * gradient);
  d_.noalias() = -(A_ * z_free_);
  d_.array() += bound.array() * row_scale_.array();
  return z_free_.allFinite() && d_.allFinite();
}

// Keeps those rows of the last active set whose multipliers are still non-negative.
void DenseQp::warmStart() noexcept {
  lambda_.setZero();
  for (;;) {
    resolveMultipliers();
    int worst = -1;
    double least = -kDenseRounding * (1.0 + largestMultiplier());
    for (int j = 0; j < active_count_; ++j) {
      const int row = active_[j];
      if (!is_equality_[row] && lambda_(row) < least) {
        least = lambda_(row);
        worst = j;
      }
    }
    if (worst < 0) return;
    ++iterations_;
    lambda_(active_[worst]) = 0.0;
    drop(worst);
  }
}

// Moves along the dual until `row` holds, dropping rows whose multipliers reach zero on the way.
DenseQp::StepResult DenseQp::satisfy(int row) noexcept {
  const double sign =
      is_equality_[row] && slack_(row) > 0.0 ? -1.0 : 1.0;  // an equality may pull the other way
  for (;;) {
    if (++iterations_ > iteration_limit_) return StepResult::kIterationLimit;
    for (int j = 0; j < active_count_; ++j) direction_(j) = gram_(active_[j], row);
    solveFactor(direction_.data());
    double curvature = gram_(row, row);
    for (int j = 0; j < active_count_; ++j) curvature -= direction_(j) * gram_(active_[j], row);

    int blocking = -1;
    double dual_step = std::numeric_limits<double>::infinity();
    for (int j = 0; j < active_count_; ++j) {
      const double decrease = sign * direction_(j);
      if (is_equality_[active_[j]] || decrease <= kDenseNegative) continue;
      const double step = std::max(0.0, lambda_(active_[j])) / decrease;
      if (step < dual_step) {
        dual_step = step;
        blocking = j;
      }
    }
    const bool independent = active_count_ < n_ && curvature > kDenseDependent;
    const double primal_step = independent ? std::max(0.0, -sign * slack_(row)) / curvature
                                           : std::numeric_limits<double>::infinity();
    if (!independent && blocking < 0) {
      const bool holds = std::abs(slack_(row)) <= 1e3 * kDenseFeasible * (1.0 + std::abs(d_(row)));
      return holds ? StepResult::kAdded : StepResult::kInfeasible;
    }
    const double step = std::min(primal_step, dual_step);
    for (int j = 0; j < active_count_; ++j) lambda_(active_[j]) -= step * sign * direction_(j);
    lambda_(row) += sign * step;
    if (step == primal_step && append(row)) {
      updateSlack();
      return StepResult::kAdded;
    }
    // Without a blocking row, the row depends on the active ones after all.
    if (blocking < 0) return StepResult::kInfeasible;
    lambda_(active_[blocking]) = 0.0;
    drop(blocking);
    updateSlack();
  }
}

bool DenseQp::append(int row) noexcept {
  const int k = active_count_;
  for (int j = 0; j < k; ++j) {
    double value = gram_(active_[j], row);
    for (int i = 0; i < j; ++i) value -= factor_(k, i) * factor_(j, i);
    factor_(k, j) = value / factor_(j, j);
  }
  double pivot = gram_(row, row);
  for (int i = 0; i < k; ++i) pivot -= factor_(k, i) * factor_(k, i);
  if (!(pivot > 0.1 * kDenseDependent)) return false;
  factor_(k, k) = std::sqrt(pivot);
  active_[k] = row;
  is_active_[row] = 1;
  ++active_count_;
  return true;
}

// Removes one row of the factor; Givens rotations make the rest triangular again.
void DenseQp::drop(int position) noexcept {
  is_active_[active_[position]] = 0;
  for (int j = position; j + 1 < active_count_; ++j) {
    active_[j] = active_[j + 1];
    for (int i = 0; i <= j + 1; ++i) factor_(j, i) = factor_(j + 1, i);
  }
  --active_count_;
  for (int j = position; j < active_count_; ++j) {
    const double a = factor_(j, j);
    const double b = factor_(j, j + 1);
    const double r = std::hypot(a, b);
    const double cosine = a / r;
    const double sine = b / r;
    factor_(j, j) = r;
    factor_(j, j + 1) = 0.0;
    for (int i = j + 1; i < active_count_; ++i) {
      const double left = factor_(i, j);
      const double right = factor_(i, j + 1);
      factor_(i, j) = cosine * left + sine * right;
      factor_(i, j + 1) = cosine * right - sine * left;
    }
  }
}

void DenseQp::solveFactor(double* x) const noexcept {
  for (int j = 0; j < active_count_; ++j) {
    double value = x[j];
    for (int i = 0; i < j; ++i) value -= factor_(j, i) * x[i];
    x[j] = value / factor_(j, j);
  }
  for (int j = active_count_ - 1; j >= 0; --j) {
    double value = x[j];
    for (int i = j + 1; i < active_count_; ++i) value -= factor_(i, j) * x[i];
    x[j] = value / factor_(j, j);
  }
}

// lambda = -G_AA^-1 d_A: the multipliers that make every active row hold.
void DenseQp::resolveMultipliers() noexcept {
  for (int j = 0; j < active_count_; ++j) direction_(j) = -d_(active_[j]);
  solveFactor(direction_.data());
  for (int j = 0; j < active_count_; ++j) lambda_(active_[j]) = direction_(j);
}

double DenseQp::largestMultiplier() const noexcept {
  double largest = 0.0;
  for (int j = 0; j < active_count_; ++j) largest = std::max(largest, std::abs(lambda_(active_[j])));
  return largest;
}

void DenseQp::updateSlack() noexcept {
  slack_ = d_;
  for (int i = 0; i < m_; ++i) {
    if (lambda_(i) != 0.0) slack_.noalias() += lambda_(i) * gram_.col(i);
  }
}

int DenseQp::mostViolated() const noexcept {
  int worst = -1;
  double least = 0.0;
  for (int i = 0; i < m_; ++i) {
    if (is_active_[i] || is_void_[i] || is_equality_[i]) continue;
    if (slack_(i) < least && slack_(i) < -kDenseFeasible * (1.0 + std::abs(d_(i)))) {
      least = slack_(i);
      worst = i;
    }
  }
  return worst;
}

// Removes the rounding that the updates have gathered. True when the result still is optimal; if not, rows
// whose multipliers turned out negative are dropped and the search can go on.
bool DenseQp::finish() noexcept {
  const int before = active_count_;
  warmStart();
  updateSlack();
  if (active_count_ != before || mostViolated() >= 0) return false;
  z_ = z_free_;
  for (int j = 0; j < active_count_; ++j) {
    double& multiplier = lambda_(active_[j]);
    if (!is_equality_[active_[j]]) multiplier = std::max(multiplier, 0.0);
    z_.noalias() -= multiplier * W_.col(active_[j]);
  }
  lambda_.array() *= row_scale_.array();
  return true;
}

}  // namespace polyfly
