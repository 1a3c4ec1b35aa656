#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace polyfly {

/// Small linear programs in floating point, max c . x over a . x <= b and |x_j| <= 1. In proofs, what they
/// answer is proven or refused in whole numbers. The exploration uses it as it is.
class FloatLp {
 public:
  explicit FloatLp(int dimension) : dimension_(dimension) {}

  void clear() { rows_.clear(); }
  void add(const std::vector<double>& a_b);  ///< dimension + 1 numbers, |a| = 1 advised
  int count() const { return static_cast<int>(rows_.size()) / (dimension_ + 1); }

  enum class Status { kOptimal, kInfeasible, kFailed };

  /// kInfeasible: weights() combine rows and box to 0 . x <= negative.
  Status maximise(const std::vector<double>& c);

  const std::vector<double>& x() const { return x_; }
  double objective() const { return objective_; }

  /// Rows (by their order; the box follows, see boxIndex) with positive weight, whose combination is c, or 0
  /// where infeasible.
  const std::vector<std::pair<int, double>>& weights() const { return weights_; }

  /// Rows that are tight where it stopped, as many as dimensions.
  const std::vector<int>& basis() const { return basis_; }

  /// Simplex pivots since construction.
  std::uint64_t pivots() const { return pivots_; }

  /// Index in weights() and basis() of x_(index / 2) <= 1 (even), >= -1 (odd).
  int boxIndex(int index) const { return count() + index; }

 private:
  void coefficients(int row, double* a, double& b) const;
  int mostViolated() const;

  int dimension_;
  std::vector<double> rows_;
  std::vector<double> x_;
  std::vector<int> basis_;
  double objective_ = 0.0;
  std::uint64_t pivots_ = 0;
  std::vector<std::pair<int, double>> weights_;
};

}  // namespace polyfly
