// Set-up, the order of the phases, and what a solution leaves behind.
#include "bounded_qp_solver.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "mpc_core/qp_kernels.hpp"
#include "polyfly_base/error.hpp"
#include "qp_tolerances.hpp"

namespace polyfly {
namespace {

constexpr int kIterationsPerConstraint = 10;
constexpr int kIterationsAtLeast = 30;
constexpr double kWellConditioned = 100.0;  // ratio of the factor's pivots: nothing to refine below

std::size_t product(int a, int b) { return static_cast<std::size_t>(a) * static_cast<std::size_t>(b); }

}  // namespace

BoundedQp::Solver::Solver(int variables, int rows) : n_(variables), m_(rows) {
  if (n_ < 1 || m_ < 0) {
    throw Error("BoundedQp: needs at least 1 variable and 0 rows, got " + std::to_string(n_) + " and " +
                std::to_string(m_));
  }
  stride_ = wholePacks(n_);
  const int constraints = n_ + m_;
  const std::size_t square = product(stride_, stride_);
  const std::size_t blocks = product(stride_ / kPack, kBlockInverse);
  for (AlignedArray* matrix : {&H_, &factor_, &reduced_, &gram_, &range_}) *matrix = AlignedArray(square);
  for (AlignedArray* array : {&factor_inverse_, &reduced_inverse_, &gram_inverse_}) {
    *array = AlignedArray(blocks);
  }
  rows_ = AlignedArray(product(stride_, m_));
  inverse_ = AlignedArray(product(stride_, constraints));
  for (AlignedArray* array : {&g_, &base_, &x_, &dx_, &gradient_, &work_, &small_, &multipliers_}) {
    *array = AlignedArray(static_cast<std::size_t>(stride_));
  }
  for (AlignedArray* array :
       {&lower_, &upper_, &least_, &greatest_, &penalty_, &scale_, &lambda_, &dlambda_}) {
    *array = AlignedArray(static_cast<std::size_t>(constraints));
  }
  row_value_ = AlignedArray(static_cast<std::size_t>(m_));
  std::fill_n(penalty_.data(), constraints, std::numeric_limits<double>::infinity());
  std::fill_n(scale_.data(), constraints, 1.0);
  has_inverse_.assign(static_cast<std::size_t>(constraints), 0);
  side_.assign(static_cast<std::size_t>(constraints), QpSide::kInactive);
  listed_.assign(static_cast<std::size_t>(n_), 0);
  // One more than can be listed: entries are written before it is known that they count.
  free_.assign(static_cast<std::size_t>(n_ + 1), 0);
  working_.assign(static_cast<std::size_t>(constraints + 1), 0);
  iteration_limit_ = kIterationsPerConstraint * constraints + kIterationsAtLeast;
}

bool BoundedQp::Solver::setHessian(const double* H) noexcept {
  std::fill(has_inverse_.begin(), has_inverse_.end(), 0);
  has_hessian_inverse_ = false;
  for (int j = 0; j < n_; ++j) {
    const double* column = H + j * n_;
    double* own = H_.data() + j * stride_;
    std::copy(column + j, column + n_, own + j);
    for (int i = j + 1; i < n_; ++i) H_[i * stride_ + j] = column[i];
    std::copy(column + j, column + n_, factor_.data() + j * stride_ + j);
  }
  setIdentityTail(factor_.data(), n_, stride_);
  convex_ = qpKernels().factorise(factor_.data(), stride_, stride_, kPositive, factor_inverse_.data(), 0) ==
            stride_;
  double least = factor_[0];
  double greatest = factor_[0];
  for (int j = 1; j < n_; ++j) {
    least = std::min(least, factor_[j * stride_ + j]);
    greatest = std::max(greatest, factor_[j * stride_ + j]);
  }
  well_conditioned_ = greatest < kWellConditioned * least;
  return convex_;
}

bool BoundedQp::Solver::setConstantHessian(const double* H) noexcept {
  if (!setHessian(H)) return false;
  for (int i = 0; i < n_; ++i) inverseColumn(i);
  has_hessian_inverse_ = true;
  return true;
}

void BoundedQp::Solver::setRows(const double* A) noexcept {
  for (int i = 0; i < m_; ++i) {
    double largest = 0.0;
    for (int j = 0; j < n_; ++j) {
      const double entry = A[j * m_ + i];
      rows_[i * stride_ + j] = entry;
      largest = std::max(largest, std::abs(entry));
    }
    scale_[n_ + i] = largest > 0.0 ? largest : 1.0;
    has_inverse_[static_cast<std::size_t>(n_ + i)] = 0;
  }
}

void BoundedQp::Solver::setPenalty(int row, double penalty) noexcept { penalty_[n_ + row] = penalty; }

QpStatus BoundedQp::Solver::solve(const QpVectors& vectors, const QpSide* start) noexcept {
  iterations_ = 0;
  entering_ = -1;
  working_count_ = 0;
  bound_count_ = 0;
  gram_done_ = 0;
  std::fill(listed_.begin(), listed_.end(), 0);
  predicted_ = false;
  has_base_ = false;
  if (!convex_) return QpStatus::kNotConvex;
  const QpStatus given = load(vectors);
  startFrom(start);
  if (given != QpStatus::kOptimal) return finish(given);

  if (!predictBounds()) return finish(QpStatus::kIterationLimit);
  for (;;) {
    switch (ascend()) {
      case Pass::kAdvanced:
        break;
      case Pass::kOptimal:
        refine();
        return finish(QpStatus::kOptimal);
      case Pass::kInfeasible:
        return finish(QpStatus::kInfeasible);
      case Pass::kIterationLimit:
        return finish(QpStatus::kIterationLimit);
    }
  }
}

QpStatus BoundedQp::Solver::load(const QpVectors& vectors) noexcept {
  std::copy_n(vectors.g, n_, g_.data());
  std::copy_n(vectors.lower, n_, lower_.data());
  std::copy_n(vectors.upper, n_, upper_.data());
  if (m_ > 0) {
    std::copy_n(vectors.row_lower, m_, lower_.data() + n_);
    std::copy_n(vectors.row_upper, m_, upper_.data() + n_);
  }
  gradient_scale_ = qpKernels().greatest(stride_, g_.data());
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double* const lower = lower_.data();
  const double* const upper = upper_.data();
  const double* const scale = scale_.data();
  double* const least = least_.data();
  double* const greatest = greatest_.data();
  // The flags are as wide as the numbers that decide, so that four are done at once.
  std::int64_t not_finite = 0;
  std::int64_t contradictory = 0;
  std::int64_t equal = 0;
  for (int i = 0; i < n_ + m_; ++i) {
    not_finite |= lower[i] < kInfinity ? 0 : 1;  // 1 for NaN
    not_finite |= upper[i] > -kInfinity ? 0 : 1;
    contradictory |= lower[i] <= upper[i] ? 0 : 1;
    equal |= lower[i] == upper[i] ? 1 : 0;
    least[i] = lower[i] - kFeasible * (scale[i] + std::abs(lower[i]));
    greatest[i] = upper[i] + kFeasible * (scale[i] + std::abs(upper[i]));
  }
  has_equalities_ = equal != 0;
  if (not_finite != 0 || !std::isfinite(gradient_scale_)) return QpStatus::kNotFinite;
  return contradictory == 0 ? QpStatus::kOptimal : QpStatus::kInfeasible;
}

// Sides that the bounds and penalties of this problem allow: at no infinite bound, relaxed only if its penalty is finite,
// equalities always held.
void BoundedQp::Solver::startFrom(const QpSide* start) noexcept {
  const int constraints = n_ + m_;
  std::fill_n(lambda_.data(), constraints, 0.0);
  if (start == nullptr) {
    std::fill_n(side_.data(), constraints, QpSide::kInactive);
  } else {
    for (int i = 0; i < constraints; ++i) {
      const QpSide side = start[i] == QpSide::kInactive ? start[i] : allowed(i, start[i]);
      side_[static_cast<std::size_t>(i)] = side;
      if (side == QpSide::kUpperRelaxed || side == QpSide::kLowerRelaxed)
        relax(i, side == QpSide::kUpperRelaxed);
    }
  }
  for (int i = 0; has_equalities_ && i < constraints; ++i) {
    QpSide& side = side_[static_cast<std::size_t>(i)];
    if (side == QpSide::kInactive && isEquality(i)) side = QpSide::kUpper;
  }
  std::fill_n(x_.data(), n_, 0.0);
}

QpSide BoundedQp::Solver::allowed(int index, QpSide side) const noexcept {
  if (!std::isfinite(side < QpSide::kInactive ? lower_[index] : upper_[index])) return QpSide::kInactive;
  if (std::isfinite(penalty_[index])) return side;
  if (side == QpSide::kLowerRelaxed) return QpSide::kLower;
  return side == QpSide::kUpperRelaxed ? QpSide::kUpper : side;
}

QpStatus BoundedQp::Solver::finish(QpStatus status) noexcept {
  if (status != QpStatus::kOptimal) {
    entering_ = -1;
    for (int i = 0; i < n_; ++i) {
      if (!std::isfinite(x_[i])) x_[i] = 0.0;
    }
  }
  // Written so that contradictory bounds do no harm.
  for (int i = 0; i < n_; ++i) x_[i] = std::max(lower_[i], std::min(upper_[i], x_[i]));
  evaluateRows();
  violation_ = 0.0;
  for (int i = 0; i < m_; ++i) {
    violation_ = std::max({violation_, lower_[n_ + i] - row_value_[i], row_value_[i] - upper_[n_ + i]});
  }
  return status;
}

}  // namespace polyfly
