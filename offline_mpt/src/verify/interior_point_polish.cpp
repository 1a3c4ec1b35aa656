// The end of InteriorPointQp: from an interior point to the exact active set, and back to the program as
// given.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "mpc_core/decompositions.hpp"
#include "verify/interior_point_parts.hpp"
#include "verify/interior_point_qp.hpp"
#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

constexpr int kMaxPolishRounds = 8;

}  // namespace

double InteriorPointQp::reducedResidual() const {
  const Eigen::VectorXd stationarity = kappa_ * (H_y_ * y_) + g_y_ + A_y_.transpose() * l_;
  const Eigen::VectorXd slack = b_y_ - A_y_ * y_;
  double residual = maxAbs(stationarity);
  for (Eigen::Index i = 0; i < slack.size(); ++i) {
    const double scaled_slack = slack[i] / std::max(1.0, std::abs(b_y_[i]));
    residual = std::max({residual, -scaled_slack, -l_[i], std::min(l_[i], scaled_slack)});
  }
  return residual;
}

// Least-norm correction of (y, l) to the KKT system of the rows in `active`; the others get l = 0. Least norm
// keeps multipliers near the analytic centre that the iteration found, hence positive, where they are not
// unique.
bool InteriorPointQp::correct(const std::vector<int>& active) {
  const Eigen::Index n = y_.size(), k = static_cast<Eigen::Index>(active.size());
  Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + k, n + k);
  Eigen::VectorXd residual(n + k);
  kkt.topLeftCorner(n, n) = kappa_ * H_y_;
  Eigen::VectorXd kept = Eigen::VectorXd::Zero(l_.size());
  for (Eigen::Index i = 0; i < k; ++i) {
    const int row = active[static_cast<std::size_t>(i)];
    kkt.block(n + i, 0, 1, n) = A_y_.row(row);
    kkt.block(0, n + i, n, 1) = A_y_.row(row).transpose();
    residual[n + i] = b_y_[row] - A_y_.row(row).dot(y_);
    kept[row] = l_[row];
  }
  residual.head(n) = -(kappa_ * (H_y_ * y_) + g_y_ + A_y_.transpose() * kept);
  Eigen::VectorXd step;
  bool solved = false;
  if (k <= n) {
    step = Eigen::PartialPivLU<Eigen::MatrixXd>(kkt).solve(residual);
    const double size = maxAbs(residual);
    solved = step.allFinite() && maxAbs(step) <= 1.0 &&
             maxAbs(kkt * step - residual) <= tolerance::kTrustedSolution * size;
  }
  if (!solved) step = ShortestLeastSquares(kkt, tolerance::kInteriorPointRank).solve(residual);
  if (!step.allFinite()) return false;
  y_ += step.head(n);
  l_ = kept;
  for (Eigen::Index i = 0; i < k; ++i) l_[active[static_cast<std::size_t>(i)]] += step[n + i];
  return true;
}

// Guesses the active set by comparing multipliers with slacks; where that does not lead to a solution, rows
// of which both are nearly zero are taken out of it or into it.
void InteriorPointQp::polish() {
  double best = reducedResidual();
  if (!(best <= tolerance::kPolishStart)) return;
  best_y_ = y_;
  best_l_ = l_;
  const Eigen::VectorXd y = y_, l = l_;
  for (const double bias : tolerance::kActiveBias) {
    y_ = y;
    l_ = l;
    std::vector<int> active;
    for (int i = 0; i < static_cast<int>(l_.size()); ++i) {
      if (l_[i] > bias * s_[i]) active.push_back(i);
    }
    follow(std::move(active), best);
    if (best <= tolerance::kPolished) break;
  }
  y_ = best_y_;
  l_ = best_l_;
}

// Solves for an active set and lets rows of the wrong sign leave or enter. The best point seen is kept.
void InteriorPointQp::follow(std::vector<int> active, double& best) {
  for (int round = 0; round < kMaxPolishRounds; ++round) {
    if (!correct(active)) return;
    const double residual = reducedResidual();
    if (residual < best) {
      best = residual;
      best_y_ = y_;
      best_l_ = l_;
    }
    std::vector<int> next;
    for (int i = 0; i < static_cast<int>(l_.size()); ++i) {
      const bool was_active = std::binary_search(active.begin(), active.end(), i);
      const double slack = b_y_[i] - A_y_.row(i).dot(y_);
      const double scale = std::max(1.0, std::abs(b_y_[i]));
      if (was_active ? l_[i] >= -tolerance::kWrongSign : slack < -tolerance::kWrongSign * scale)
        next.push_back(i);
    }
    if (next == active) return;
    active = std::move(next);
  }
}

// Multipliers of the equalities that cancel `gradient` best.
void InteriorPointQp::addEqualityMultipliers(const Eigen::VectorXd& gradient) {
  if (equalities_.empty()) return;
  const Eigen::VectorXd nu = eq_transposed_factor_.solve(Eigen::VectorXd(-gradient));
  for (std::size_t i = 0; i < equalities_.size(); ++i) {
    solution_.lambda[equalities_[i]] = nu[static_cast<Eigen::Index>(i)];
  }
}

// Back to z and the original rows; residuals are measured on the problem as it was given.
void InteriorPointQp::expand(const Eigen::VectorXd& g, const Eigen::VectorXd& b) {
  Eigen::VectorXd& z = solution_.z;
  Eigen::VectorXd& lambda = solution_.lambda;
  lambda.setZero();
  z = z0_;
  z.noalias() += N_ * y_;
  for (Eigen::Index i = 0; i < l_.size(); ++i) {
    lambda[rows_[static_cast<std::size_t>(i)]] = l_[i] / (norm_y_[i] * kappa_);
  }
  Eigen::VectorXd gradient = H_ * z + g;
  solution_.objective = 0.5 * z.dot(gradient + g);
  gradient.noalias() += A_.transpose() * lambda;
  if (!equalities_.empty()) {
    addEqualityMultipliers(gradient);
    gradient = H_ * z + g + A_.transpose() * lambda;
  }
  const double cost_scale = std::max({1.0, maxAbs(g), H_scale_});
  double residual = maxAbs(gradient) / cost_scale;
  for (Eigen::Index i = 0; i < A_.rows(); ++i) {
    const double norm = row_norm_[i] > 0.0 ? row_norm_[i] : 1.0;
    const double slack = (b[i] - A_.row(i).dot(z)) / norm;
    const double slack_scale = std::max(1.0, std::abs(b[i]) / norm);
    const bool equality = std::binary_search(equalities_.begin(), equalities_.end(), static_cast<int>(i));
    residual = std::max(residual, (equality ? std::abs(slack) : -slack) / slack_scale);
    if (equality) continue;
    const double multiplier = lambda[i] * norm / cost_scale;
    residual = std::max({residual, -multiplier, std::min(multiplier, slack / slack_scale)});
  }
  solution_.residual = residual;
}

}  // namespace polyfly
