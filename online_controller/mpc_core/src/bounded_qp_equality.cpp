// Solves with the factorised working set as equalities: by the dual factor or by the primal one.
#include <algorithm>
#include <cmath>

#include "bounded_qp_solver.hpp"
#include "mpc_core/qp_kernels.hpp"
#include "qp_tolerances.hpp"

namespace polyfly {

// Fills x and the multipliers of the working set; those of relaxed and partial constraints are data.
void BoundedQp::Solver::solveEquality() noexcept {
  if (dual_) {
    startFromBase();
    solveDual(x_.data(), lambda_.data(), false);
    return;
  }
  std::copy_n(g_.data(), stride_, gradient_.data());
  forFixedMultipliers([&](int i) { addMultiple(i, lambda_[i], gradient_.data()); });
  solvePrimal(x_.data(), lambda_.data(), false);
}

// x: the minimiser without the working set.
void BoundedQp::Solver::startFromBase() noexcept {
  if (!has_base_) {
    std::fill_n(base_.data(), stride_, 0.0);
    for (int i = 0; i < n_; ++i) gradient_[i] = -g_[i];
    if (has_hessian_inverse_) {
      qpKernels().addColumns(inverse_.data(), stride_, stride_, nullptr, n_, gradient_.data(), base_.data());
    } else {
      std::copy_n(gradient_.data(), n_, base_.data());
      solveHessian(base_.data());
    }
    has_base_ = true;
  }
  std::copy_n(base_.data(), stride_, x_.data());
  forFixedMultipliers(
      [&](int i) { qpKernels().addMultiple(stride_, -lambda_[i], inverseColumn(i), x_.data()); });
}

// The rates of x and of the multipliers as the candidate's multiplier grows along its direction.
void BoundedQp::Solver::solveDirection(const Candidate& candidate) noexcept {
  if (dual_) {
    std::fill_n(dx_.data(), stride_, 0.0);
    qpKernels().addMultiple(stride_, -candidate.direction, inverseColumn(candidate.index), dx_.data());
    solveDual(dx_.data(), dlambda_.data(), true);
    return;
  }
  std::fill_n(gradient_.data(), stride_, 0.0);
  addMultiple(candidate.index, candidate.direction, gradient_.data());
  solvePrimal(dx_.data(), dlambda_.data(), true);
}

// From the minimiser without the working set in x to the one with it.
void BoundedQp::Solver::solveDual(double* x, double* lambda, bool homogeneous) noexcept {
  const int k = working_count_;
  for (int j = 0; j < k; ++j) {
    const int i = working_[static_cast<std::size_t>(j)];
    multipliers_[j] = along(i, x) - (homogeneous ? 0.0 : bound(i));
  }
  std::fill(multipliers_.data() + k, multipliers_.data() + gram_size_, 0.0);
  solveGram(multipliers_.data());
  for (int j = 0; j < k; ++j) {
    const int i = working_[static_cast<std::size_t>(j)];
    lambda[i] = multipliers_[j];
    multipliers_[j] = -multipliers_[j];
  }
  qpKernels().addColumns(inverse_.data(), stride_, stride_, working_.data(), k, multipliers_.data(), x);
  for (int j = 0; j < bound_count_; ++j) {
    const int i = working_[static_cast<std::size_t>(j)];
    x[i] = homogeneous ? 0.0 : bound(i);
  }
}

// Minimises 1/2 x'Hx + gradient'x with the working set as equalities.
void BoundedQp::Solver::solvePrimal(double* x, double* lambda, bool homogeneous) noexcept {
  const int rows = working_count_ - bound_count_;
  const QpKernels& kernels = qpKernels();
  std::copy_n(gradient_.data(), stride_, work_.data());
  std::fill_n(x, stride_, 0.0);
  if (!homogeneous && bound_count_ > 0) {
    for (int j = 0; j < bound_count_; ++j) {
      const int i = working_[static_cast<std::size_t>(j)];
      small_[j] = x[i] = bound(i);
    }
    kernels.addColumns(H_.data(), stride_, stride_, working_.data(), bound_count_, small_.data(),
                       work_.data());
  }
  gatherFree(work_.data(), small_.data());
  for (int i = 0; i < free_count_; ++i) small_[i] = -small_[i];
  solveReduced(small_.data(), true, false);
  for (int r = 0; r < rows; ++r) {
    const int i = working_[static_cast<std::size_t>(bound_count_ + r)];
    const double wanted = (homogeneous ? 0.0 : bound(i)) - along(i, x);
    multipliers_[r] = kernels.dot(reduced_size_, range_.data() + r * stride_, small_.data()) - wanted;
  }
  std::fill(multipliers_.data() + rows, multipliers_.data() + gram_size_, 0.0);
  solveGram(multipliers_.data());
  for (int r = 0; r < rows; ++r) {
    const int i = working_[static_cast<std::size_t>(bound_count_ + r)];
    lambda[i] = multipliers_[r];
    kernels.addMultiple(reduced_size_, -lambda[i], range_.data() + r * stride_, small_.data());
    addMultiple(i, lambda[i], work_.data());
  }
  solveReduced(small_.data(), false, true);
  for (int i = 0; i < free_count_; ++i) x[free_[static_cast<std::size_t>(i)]] = small_[i];
  if (bound_count_ == 0) return;
  kernels.addColumns(H_.data(), stride_, stride_, free_.data(), free_count_, small_.data(), work_.data());
  for (int j = 0; j < bound_count_; ++j) {
    const int i = working_[static_cast<std::size_t>(j)];
    lambda[i] = -work_[i];
  }
}

// One step of iterative refinement, where rounding may have left something to refine.
void BoundedQp::Solver::refine() noexcept {
  if (well_conditioned_) return;
  const QpKernels& kernels = qpKernels();
  std::copy_n(g_.data(), stride_, gradient_.data());
  kernels.addColumns(H_.data(), stride_, stride_, nullptr, n_, x_.data(), gradient_.data());
  for (int i = 0; i < n_ + m_; ++i) {
    if (lambda_[i] != 0.0) addMultiple(i, lambda_[i], gradient_.data());
  }
  const double worst = kernels.greatest(stride_, gradient_.data());
  if (worst <= kResidual * (gradient_scale_ + largestMultiplier())) return;
  if (dual_) {
    for (int i = 0; i < n_; ++i) dx_[i] = -gradient_[i];
    solveHessian(dx_.data());
    solveDual(dx_.data(), dlambda_.data(), true);
  } else {
    solvePrimal(dx_.data(), dlambda_.data(), true);
  }
  for (int i = 0; i < n_; ++i) x_[i] += dx_[i];
  for (int j = 0; j < working_count_; ++j) {
    const int i = working_[static_cast<std::size_t>(j)];
    lambda_[i] += dlambda_[i];
  }
}

}  // namespace polyfly
