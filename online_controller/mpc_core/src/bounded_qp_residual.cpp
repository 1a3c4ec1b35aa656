// The KKT conditions of a quadratic program at what the solver left, computed anew.
#include <algorithm>
#include <cmath>

#include "bounded_qp_solver.hpp"

namespace polyfly {

double BoundedQp::Solver::kktResidual() const noexcept {
  double worst = 0.0;
  double scale = 1.0;
  for (int i = 0; i < n_; ++i) scale = std::max(scale, std::abs(g_[i]));
  for (int i = 0; i < n_; ++i) {
    double stationarity = g_[i] + lambda_[i];
    for (int j = 0; j < n_; ++j) stationarity += H_[j * stride_ + i] * x_[j];
    for (int r = 0; r < m_; ++r) stationarity += rows_[r * stride_ + i] * lambda_[n_ + r];
    worst = std::max(worst, std::abs(stationarity) / scale);
  }
  for (int i = 0; i < n_ + m_; ++i) {
    double value = i < n_ ? x_[i] : 0.0;
    for (int j = 0; i >= n_ && j < n_; ++j) value += rows_[(i - n_) * stride_ + j] * x_[j];
    const double below = lower_[i] - value;
    const double above = value - upper_[i];
    const double multiplier = lambda_[i];
    const bool relaxed = std::isfinite(penalty_[i]) && std::abs(multiplier) >= penalty_[i];
    if (!relaxed) worst = std::max({worst, below, above});
    // A multiplier off its bound: no further than that distance, or its own size.
    const double slack = multiplier > 0.0 ? -above : -below;
    if (multiplier != 0.0 && !relaxed)
      worst = std::max(worst, std::min(std::abs(slack), std::abs(multiplier) / scale));
  }
  return worst;
}

}  // namespace polyfly
