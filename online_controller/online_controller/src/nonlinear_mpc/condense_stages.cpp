// Condensing: the Hessian of the QP in the inputs alone, and its rows.
#include <algorithm>
#include <cmath>
#include <utility>

#include "mpc_core/qp_kernels.hpp"
#include "nonlinear_mpc/nonlinear_mpc.hpp"

namespace polyfly {
namespace {

constexpr int kNx = kMultirotorStates;
constexpr int kNu = kMultirotorInputs;

}  // namespace

// The state k depends on the inputs before k: d x_{k+1} = A_k d x_k + B_k d u_k gives the sensitivities
// forwards, and their weighted sum goes backwards, so that the Hessian costs O(N^2) products.
void NonlinearMpc::condense(double end_yaw) noexcept {
  for (int k = 0; k < options_.horizon; ++k) extendSensitivities(k);
  startAdjoint(end_yaw);
  for (int k = options_.horizon - 1; k > 0; --k) {
    writeHessianRows(k);
    stepAdjoint(k);
  }
  writeHessianRows(0);
}

void NonlinearMpc::extendSensitivities(int k) noexcept {
  const Stage& stage = stages_[static_cast<std::size_t>(k)];
  for (int i = 0; i < kNx; ++i) {
    double* row = sensitivity(k + 1) + i * stride_;
    std::fill_n(row, wholePacks(kNu * (k + 1)), 0.0);
    if (k > 0) {
      qpKernels().addColumns(sensitivity(k), wholePacks(kNu * k), stride_, nullptr, kNx,
                             stage.step.A.row(i).data(), row);
    }
    for (int j = 0; j < kNu; ++j) row[kNu * k + j] = stage.step.B(i, j);
  }
}

// The adjoint of stage k, states x inputs, is the second derivative of the cost from there on by the state k
// and the inputs. At the end it is the terminal weight, turned by the yaw.
void NonlinearMpc::startAdjoint(double end_yaw) noexcept {
  Block turn = Block::Identity();
  const double cosine = std::cos(end_yaw);
  const double sine = std::sin(end_yaw);
  for (const int i : {0, 3}) turn.block<2, 2>(i, i) << cosine, sine, -sine, cosine;
  terminal_weight_.noalias() = turn.transpose() * (hover_weight_ * turn).eval();
  for (int i = 0; i < kNx; ++i) {
    double* row = adjoint_.data() + i * stride_;
    std::fill_n(row, stride_, 0.0);
    qpKernels().addColumns(sensitivity(options_.horizon), stride_, stride_, nullptr, kNx,
                           terminal_weight_.row(i).data(), row);
  }
}

// out += slope times the weighted derivative of the lift by the inputs before k.
void NonlinearMpc::addLift(int k, double slope, double* out) noexcept {
  const Eigen::Vector3d& by = transitions_[static_cast<std::size_t>(k)].lift_slope;
  for (int i = 0; i < 2; ++i) {
    qpKernels().addMultiple(wholePacks(kNu * k), slope * options_.thrust_weight * by(i),
                            sensitivity(k) + (6 + i) * stride_, out);
  }
}

// Rows of the inputs k, up to the diagonal.
void NonlinearMpc::writeHessianRows(int k) noexcept {
  const Stage& stage = stages_[static_cast<std::size_t>(k)];
  const int n = kNu * options_.horizon;
  const int width = wholePacks(kNu * (k + 1));
  const double by_thrust = transitions_[static_cast<std::size_t>(k)].lift_slope(2);
  for (int i = 0; i < kNu; ++i) {
    std::fill_n(row_.data(), width, 0.0);
    qpKernels().addColumns(adjoint_.data(), width, stride_, nullptr, kNx, stage.B_transposed.row(i).data(),
                           row_.data());
    // The lift depends on the tilt and on the thrust.
    const bool thrust = i == kNu - 1;
    if (thrust && k > 0) addLift(k, by_thrust, row_.data());
    const int row = kNu * k + i;
    row_[row] += thrust ? options_.thrust_weight * by_thrust * by_thrust
                        : (i == 0 ? options_.roll_command_weight : options_.pitch_command_weight);
    for (int j = 0; j <= row; ++j) H_[j * n + row] = row_[j];
  }
}

void NonlinearMpc::stepAdjoint(int k) noexcept {
  const Stage& stage = stages_[static_cast<std::size_t>(k)];
  const int before = wholePacks(kNu * k);
  for (int i = 0; i < kNx; ++i) {
    double* out = adjoint_next_.data() + i * stride_;
    std::fill_n(out, before, 0.0);
    qpKernels().addColumns(adjoint_.data(), before, stride_, nullptr, kNx, stage.A_transposed.row(i).data(),
                           out);
    qpKernels().addMultiple(before, state_weight_(i), sensitivity(k) + i * stride_, out);
    if (i >= 6) addLift(k, transitions_[static_cast<std::size_t>(k)].lift_slope(i - 6), out);
  }
  std::swap(adjoint_, adjoint_next_);
}

void NonlinearMpc::setSoftRows() noexcept {
  const int N = options_.horizon;
  const int m = rowCount();
  int index = 0;
  for (int k = 0; k < N; ++k) {
    const int width = kNu * (k + 1);
    for (const SoftLimit& limit : soft_limits_) {
      const double* row = sensitivity(k + 1) + limit.state * stride_;
      for (int j = 0; j < kNu * N; ++j) rows_[j * m + index] = j < width ? row[j] : 0.0;
      ++index;
    }
  }
  qp_.setRows(rows_.data());
}

}  // namespace polyfly
