#pragma once

#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "lp/polytope_kernel.hpp"

namespace polyfly {

/// Small linear programs in floating point, max c . x over a . x <= b and |x_j| <= 1, on the dictionaries of PolytopeSolver.
/// In proofs, what they answer is proven or refused in whole numbers. The exploration uses it as it is.
class FloatLp {
 public:
  using Status = BoxOptimum::Status;

  /// More than PolytopeSolver::kMaxDimension + 1 dimensions always fail: there is no guess then.
  explicit FloatLp(int dimension) : dimension_(dimension), kernel_(makeKernel(dimension)) {}

  void clear() { rows_.clear(); }
  /// dimension + 1 numbers, |a| = 1 advised.
  void add(const std::vector<double>& a_b) { rows_.insert(rows_.end(), a_b.begin(), a_b.end()); }
  int count() const { return static_cast<int>(rows_.size()) / (dimension_ + 1); }

  Status maximise(const std::vector<double>& c) {
    optimum_ = {};
    if (!kernel_) return Status::kFailed;
    const Status status = kernel_->maximiseInBox(rows_.data(), count(), c.data(), optimum_);
    if (status == Status::kFailed) optimum_ = {};
    if (status == Status::kOptimal)
      objective_ = std::inner_product(c.begin(), c.end(), optimum_.t.begin(), 0.0);
    return status;
  }

  /// Of the last answer, see BoxOptimum. Empty if it failed.
  const std::vector<double>& x() const { return optimum_.t; }
  double objective() const { return objective_; }
  const std::vector<std::pair<int, double>>& weights() const { return optimum_.weights; }
  const std::vector<int>& basis() const { return optimum_.basis; }

  /// Simplex pivots since construction.
  unsigned long long pivots() const { return kernel_ ? kernel_->pivots() : 0; }

  /// Index in weights() and basis() of x_(index / 2) <= 1 (even), >= -1 (odd).
  int boxIndex(int index) const { return count() + index; }

 private:
  int dimension_;
  std::unique_ptr<PolytopeSolver::Kernel> kernel_;
  std::vector<double> rows_;
  BoxOptimum optimum_;
  double objective_ = 0.0;
};

}  // namespace polyfly
