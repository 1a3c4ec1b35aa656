// Lists and factorises a working set, by one of two factors.
#include <algorithm>
#include <cmath>

#include "bounded_qp_solver.hpp"
#include "mpc_core/qp_kernels.hpp"
#include "qp_tolerances.hpp"

namespace polyfly {

double BoundedQp::Solver::along(int index, const double* x) const noexcept {
  return index < n_ ? x[index] : qpKernels().dot(stride_, rows_.data() + (index - n_) * stride_, x);
}

// y += factor a_index
void BoundedQp::Solver::addMultiple(int index, double factor, double* y) const noexcept {
  if (index < n_) {
    y[index] += factor;
  } else {
    qpKernels().addMultiple(stride_, factor, rows_.data() + (index - n_) * stride_, y);
  }
}

void BoundedQp::Solver::evaluateRows() noexcept {
  for (int i = 0; i < m_; ++i) row_value_[i] = along(n_ + i, x_.data());
}

void BoundedQp::Solver::solveHessian(double* x) const noexcept {
  qpKernels().solveLower(factor_.data(), factor_inverse_.data(), stride_, stride_, x);
  qpKernels().solveUpper(factor_.data(), factor_inverse_.data(), stride_, stride_, x);
}

// H^-1 a_index, computed when it is first asked for.
const double* BoundedQp::Solver::inverseColumn(int index) noexcept {
  double* column = inverse_.data() + index * stride_;
  if (!has_inverse_[static_cast<std::size_t>(index)]) {
    std::fill_n(column, stride_, 0.0);
    addMultiple(index, 1.0, column);
    solveHessian(column);
    has_inverse_[static_cast<std::size_t>(index)] = 1;
  }
  return column;
}

// Bounds first, then rows, so that a dependent row shows as such. Bounds that stay keep their order and new
// ones come after them: the factor of those before the first that left is that of the last working set.
void BoundedQp::Solver::listWorkingSet() noexcept {
  for (int j = 0; j < working_count_; ++j) {
    const int i = working_[static_cast<std::size_t>(j)];
    if (side_[static_cast<std::size_t>(i)] == QpSide::kInactive && i != entering_) lambda_[i] = 0.0;
  }
  int held = 0;
  int kept = bound_count_;
  int* const working = working_.data();
  char* const listed = listed_.data();
  const QpSide* const sides = side_.data();
  for (int j = 0; j < bound_count_; ++j) {
    const int i = working[j];
    const bool holds = isHeld(sides[i]);
    working[held] = i;
    listed[i] = holds ? 1 : 0;
    held += holds ? 1 : 0;
    kept = !holds && kept > j ? j : kept;
  }
  for (int i = 0; i < n_; ++i) {  // without branches: which bounds are held is not to be foreseen
    const bool enters = isHeld(sides[i]) && listed[i] == 0;
    working[held] = i;
    listed[i] = static_cast<char>(listed[i] | (enters ? 1 : 0));
    held += enters ? 1 : 0;
  }
  gram_done_ = std::min(gram_done_, kept) / kPack * kPack;
  bound_count_ = held;
  free_count_ = n_ - held;
  for (int i = n_; i < n_ + m_; ++i) {
    if (isHeld(sides[i])) working[held++] = i;
  }
  working_count_ = held;
}

void BoundedQp::Solver::listFree() noexcept {
  int free = 0;
  int* const frees = free_.data();
  for (int i = 0; i < n_; ++i) {
    frees[free] = i;
    free += listed_[static_cast<std::size_t>(i)] == 0 ? 1 : 0;
  }
}

// Counts multiplications.
bool BoundedQp::Solver::dualIsCheaper() const noexcept {
  const double n = n_;
  const double k = working_count_;
  const double f = free_count_;
  const double rows = working_count_ - bound_count_;
  double missing = has_base_ || entering_ >= 0 ? 0.0 : 1.0;
  for (int j = has_hessian_inverse_ ? bound_count_ : 0; j < working_count_; ++j) {
    if (!has_inverse_[static_cast<std::size_t>(working_[static_cast<std::size_t>(j)])]) missing += 1.0;
  }
  const double done = gram_done_;
  const double dual = missing * n * n + (k * k * k - done * done * done) / 6.0 + k * k * (1.0 + rows) + k * n;
  const double primal =
      (bound_count_ == 0 ? 0.0 : f * f * f / 6.0 + f * f) + f * f * (1.0 + 0.5 * rows) + n * n;
  return dual <= primal;
}

// Solves with the working set; rows that depend on the others leave it. False at the limit of iterations.
bool BoundedQp::Solver::solveWorkingSet() noexcept {
  for (;;) {
    if (++iterations_ > iteration_limit_) return false;
    listWorkingSet();
    if (factoriseWorkingSet()) break;
    if (dependent_ < 0) return false;
    side_[static_cast<std::size_t>(dependent_)] = QpSide::kInactive;
  }
  solveEquality();
  return true;
}

bool BoundedQp::Solver::factoriseWorkingSet() noexcept {
  dependent_ = -1;
  if (working_count_ > n_) {
    dependent_ = working_[static_cast<std::size_t>(working_count_ - 1)];
    return false;
  }
  dual_ = dualIsCheaper();
  return dual_ ? factoriseDual() : factorisePrimal();
}

bool BoundedQp::Solver::factoriseDual() noexcept {
  for (int j = 0; j < working_count_; ++j) {
    const double* column = inverseColumn(working_[static_cast<std::size_t>(j)]);
    double* gram = gram_.data() + j * stride_;
    for (int i = std::max(j, gram_done_); i < bound_count_; ++i)
      gram[i] = column[working_[static_cast<std::size_t>(i)]];
    for (int i = std::max(j, bound_count_); i < working_count_; ++i) {
      gram[i] = along(working_[static_cast<std::size_t>(i)], column);
    }
  }
  if (!factoriseGram(working_count_, 0)) return false;
  gram_done_ = working_count_;
  return true;
}

// The Gram matrix of the `count` constraints of the working set from `first` on.
bool BoundedQp::Solver::factoriseGram(int count, int first) noexcept {
  gram_size_ = wholePacks(count);
  setIdentityTail(gram_.data(), count, gram_size_, stride_);
  const int done = qpKernels().factorise(gram_.data(), gram_size_, stride_, kIndependent,
                                         gram_inverse_.data(), gram_done_);
  if (done == gram_size_) return true;
  gram_done_ = 0;
  dependent_ = working_[static_cast<std::size_t>(first + done)];
  return false;
}

bool BoundedQp::Solver::factorisePrimal() noexcept {
  const int rows = working_count_ - bound_count_;
  gram_done_ = 0;
  if (rows > free_count_) {
    dependent_ = working_[static_cast<std::size_t>(working_count_ - 1)];
    return false;
  }
  listFree();
  reduced_size_ = wholePacks(free_count_);
  all_free_ = bound_count_ == 0;
  if (!all_free_ && !factoriseReduced()) return false;
  for (int r = 0; r < rows; ++r) {
    const double* row = rows_.data() + (working_[static_cast<std::size_t>(bound_count_ + r)] - n_) * stride_;
    double* range = range_.data() + r * stride_;
    gatherFree(row, range);
    solveReduced(range, true, false);
    for (int s = 0; s <= r; ++s) {
      gram_[s * stride_ + r] = qpKernels().dot(reduced_size_, range_.data() + s * stride_, range);
    }
  }
  return factoriseGram(rows, bound_count_);
}

bool BoundedQp::Solver::factoriseReduced() noexcept {
  for (int c = 0; c < free_count_; ++c) {
    const double* column = H_.data() + free_[static_cast<std::size_t>(c)] * stride_;
    double* reduced = reduced_.data() + c * stride_;
    for (int r = c; r < free_count_; ++r) reduced[r] = column[free_[static_cast<std::size_t>(r)]];
  }
  setIdentityTail(reduced_.data(), free_count_, reduced_size_, stride_);
  return qpKernels().factorise(reduced_.data(), reduced_size_, stride_, kPositive, reduced_inverse_.data(),
                               0) == reduced_size_;
}

void BoundedQp::Solver::gatherFree(const double* from, double* to) const noexcept {
  for (int i = 0; i < free_count_; ++i) to[i] = from[free_[static_cast<std::size_t>(i)]];
  std::fill(to + free_count_, to + reduced_size_, 0.0);
}

void BoundedQp::Solver::solveReduced(double* x, bool lower, bool upper) const noexcept {
  const double* factor = all_free_ ? factor_.data() : reduced_.data();
  const double* blocks = all_free_ ? factor_inverse_.data() : reduced_inverse_.data();
  if (lower) qpKernels().solveLower(factor, blocks, reduced_size_, stride_, x);
  if (upper) qpKernels().solveUpper(factor, blocks, reduced_size_, stride_, x);
}

void BoundedQp::Solver::solveGram(double* x) const noexcept {
  qpKernels().solveLower(gram_.data(), gram_inverse_.data(), gram_size_, stride_, x);
  qpKernels().solveUpper(gram_.data(), gram_inverse_.data(), gram_size_, stride_, x);
}

}  // namespace polyfly
