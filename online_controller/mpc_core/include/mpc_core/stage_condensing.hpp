#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

#include "mpc_core/aligned_array.hpp"
#include "mpc_core/qp_kernels.hpp"

namespace polyfly {

/// Condensing of a linearised optimal control problem to its n = N kInputs inputs (Andersson, 2013), in O(N^2):
///
///     x_{k+1} = A_k x_k + B_k u_k,   cost sum_k 1/2 (x_k, u_k)' W_k (x_k, u_k) + 1/2 x_N' W_N x_N.
///
/// Only the constructor allocates. One object serves one thread.
template <int kStates, int kInputs>
class StageCondensing {
 public:
  using StateMatrix = Eigen::Matrix<double, kStates, kStates>;
  struct Stage {
    StateMatrix A = StateMatrix::Zero();
    Eigen::Matrix<double, kStates, kInputs> B = Eigen::Matrix<double, kStates, kInputs>::Zero();
    /// W, symmetric, of the states and then the inputs.
    Eigen::Matrix<double, kStates + kInputs, kStates + kInputs> weight =
        Eigen::Matrix<double, kStates + kInputs, kStates + kInputs>::Zero();
  };

  /// N >= 1 stages.
  explicit StageCondensing(int horizon)
      : horizon_(horizon),
        stride_(wholePacks(kInputs * horizon)),
        stages_(static_cast<std::size_t>(horizon)),
        sensitivities_(static_cast<std::size_t>((horizon + 1) * kStates * stride_)),
        adjoint_(static_cast<std::size_t>(kStates * stride_)),
        adjoint_next_(static_cast<std::size_t>(kStates * stride_)),
        row_(static_cast<std::size_t>(stride_)),
        hessian_(static_cast<std::size_t>(kInputs * horizon * kInputs * horizon)) {}

  // What the caller fills before `condense`.
  std::vector<Stage>& stages() noexcept { return stages_; }
  const std::vector<Stage>& stages() const noexcept { return stages_; }
  StateMatrix& terminalWeight() noexcept { return terminal_weight_; }
  const StateMatrix& terminalWeight() const noexcept { return terminal_weight_; }

  void condense() noexcept {
    for (int k = 0; k < horizon_; ++k) extendSensitivities(k);
    for (int i = 0; i < kStates; ++i) {
      double* row = clearedRow(adjoint_, i, stride_);
      addRows(terminal_weight_.col(i), sensitivity(horizon_, 0), stride_, row);
    }
    for (int k = horizon_ - 1; k >= 0; --k) {
      writeHessianRows(k);
      if (k > 0) stepAdjoint(k);
    }
  }

  /// n x n, column by column; only the lower triangle is written.
  const double* hessian() const noexcept { return hessian_.data(); }
  /// d x_k(state) / d u: n numbers, those of the inputs from k on are 0.
  const double* sensitivity(int k, int state) const noexcept {
    return sensitivities_.data() + (k * kStates + state) * stride_;
  }

 private:
  double* clearedRow(AlignedArray& rows, int i, int width) noexcept {
    double* row = rows.data() + i * stride_;
    std::fill_n(row, width, 0.0);
    return row;
  }

  // out += sum of factors(i) times row i; most factors of a vehicle's model are zero.
  template <class Factors>
  void addRows(const Factors& factors, const double* rows, int width, double* out) const noexcept {
    int used[kStates];
    double factor[kStates];
    int count = 0;
    for (int i = 0; i < kStates; ++i) {
      if (factors(i) == 0.0) continue;
      used[count] = i;
      factor[count++] = factors(i);
    }
    qpKernels().addColumns(rows, width, stride_, used, count, factor, out);
  }

  void extendSensitivities(int k) noexcept {
    const Stage& stage = stages_[static_cast<std::size_t>(k)];
    const int before = wholePacks(kInputs * k);
    for (int i = 0; i < kStates; ++i) {
      double* row = clearedRow(sensitivities_, (k + 1) * kStates + i, wholePacks(kInputs * (k + 1)));
      addRows(stage.A.row(i), sensitivity(k, 0), before, row);
      for (int j = 0; j < kInputs; ++j) row[kInputs * k + j] = stage.B(i, j);
    }
  }

  // The adjoint of stage k, states x inputs, is the second derivative of the cost from there on by its state and the inputs.
  void stepAdjoint(int k) noexcept {
    const Stage& stage = stages_[static_cast<std::size_t>(k)];
    const int before = wholePacks(kInputs * k);
    for (int i = 0; i < kStates; ++i) {
      double* row = clearedRow(adjoint_next_, i, before);
      addRows(stage.A.col(i), adjoint_.data(), before, row);
      addRows(stage.weight.col(i), sensitivity(k, 0), before, row);
    }
    std::swap(adjoint_, adjoint_next_);
  }

  // Rows of the inputs k, up to the diagonal.
  void writeHessianRows(int k) noexcept {
    const Stage& stage = stages_[static_cast<std::size_t>(k)];
    const int n = kInputs * horizon_;
    for (int i = 0; i < kInputs; ++i) {
      std::fill_n(row_.data(), wholePacks(kInputs * (k + 1)), 0.0);
      addRows(stage.B.col(i), adjoint_.data(), wholePacks(kInputs * (k + 1)), row_.data());
      addRows(stage.weight.col(kStates + i), sensitivity(k, 0), wholePacks(kInputs * k), row_.data());
      const int row = kInputs * k + i;
      for (int j = 0; j < kInputs; ++j) row_[kInputs * k + j] += stage.weight(kStates + j, kStates + i);
      for (int j = 0; j <= row; ++j) hessian_[j * n + row] = row_[j];
    }
  }

  int horizon_ = 0;
  // Number of inputs in whole packs.
  int stride_ = 0;
  std::vector<Stage> stages_;
  StateMatrix terminal_weight_ = StateMatrix::Zero();
  // (N + 1) x states rows.
  AlignedArray sensitivities_;
  AlignedArray adjoint_, adjoint_next_, row_, hessian_;
};

}  // namespace polyfly
