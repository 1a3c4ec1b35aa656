#include "offline_mpt/interior_point_qp.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace polyfly {
namespace {

constexpr int kMaxIterations = 80;
constexpr int kMaxStalledSteps = 4;
constexpr int kMaxPolishRounds = 8;
constexpr double kStalledStep = 1e-6;       // a shorter step is no progress
constexpr double kStepFraction = 0.995;     // of the way to the boundary
constexpr double kResidualGoal = 1e-11;     // of the Newton iteration [scaled]
constexpr double kEarlyGapGoal = 1e-12;     // mean complementarity product, when residuals are small [scaled]
constexpr double kGapGoal = 1e-14;          // the same, when they are not
constexpr double kLateResidualGoal = 1e-6;  // residuals that the final correction can take away [scaled]
constexpr double kPolishStart = 1e-3;       // residual below which the active set is worth guessing [scaled]
constexpr double kRankTolerance = 1e-11;    // relative, in rank-revealing factorisations
constexpr double kRowTolerance =
    1e-11;                             // a row shorter than this times its norm is implied by the equalities
constexpr double kConsistency = 1e-9;  // equalities off by less hold [scaled]
constexpr double kRegularisation = 1e-14;  // added to the normal matrix when it is not positive definite
constexpr double kCertificateSum = 1e2;    // multipliers must have grown so far before a certificate is tried
constexpr double kCertificateRadius = 1e7;  // a Farkas certificate excludes all solutions up to this norm
constexpr double kRayGrowth = 1e6;          // iterates must have grown so far before unboundedness is tried
constexpr double kRayTolerance = 1e-7;      // relative, for a direction of unlimited descent
constexpr double kWrongSign =
    1e-12;  // a multiplier or slack below minus this changes the active set [scaled]
constexpr double kSolveTolerance = 1e-10;  // relative residual at which an LU solution is trusted

double maxAbs(const Eigen::VectorXd& v) { return v.size() == 0 ? 0.0 : v.cwiseAbs().maxCoeff(); }

}  // namespace

const char* toString(InteriorPointStatus status) {
  switch (status) {
    case InteriorPointStatus::kOptimal:
      return "optimal";
    case InteriorPointStatus::kInfeasible:
      return "infeasible";
    case InteriorPointStatus::kUnbounded:
      return "unbounded";
    case InteriorPointStatus::kInaccurate:
      return "inaccurate";
  }
  return "unknown";
}

InteriorPointQp::InteriorPointQp(const Eigen::MatrixXd& H, const Eigen::MatrixXd& A,
                                 std::vector<int> equalities)
    : H_(0.5 * (H + H.transpose())), A_(A), equalities_(std::move(equalities)) {
  const Eigen::Index n = H_.rows(), m = A_.rows();
  assert(H.cols() == n && A.cols() == n);
  std::sort(equalities_.begin(), equalities_.end());
  equalities_.erase(std::unique(equalities_.begin(), equalities_.end()), equalities_.end());
  H_scale_ = n == 0 ? 0.0 : H_.cwiseAbs().maxCoeff();
  row_norm_ = A_.rowwise().norm();

  const auto eq_count = static_cast<Eigen::Index>(equalities_.size());
  A_eq_.resize(eq_count, n);
  for (Eigen::Index i = 0; i < eq_count; ++i) A_eq_.row(i) = A_.row(equalities_[static_cast<std::size_t>(i)]);
  if (eq_count == 0) {
    N_ = Eigen::MatrixXd::Identity(n, n);
  } else {
    eq_factor_.setThreshold(kRankTolerance);
    eq_factor_.compute(A_eq_);
    eq_transposed_factor_.setThreshold(kRankTolerance);
    eq_transposed_factor_.compute(A_eq_.transpose());
    // The last columns of Q in A_eq' P = Q R span the null space.
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
    qr.setThreshold(kRankTolerance);
    qr.compute(A_eq_.transpose());
    const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(n, n);
    N_ = Q.rightCols(n - qr.rank());
  }
  H_y_ = N_.transpose() * H_ * N_;

  const Eigen::MatrixXd rows = A_ * N_;
  for (int i = 0; i < static_cast<int>(m); ++i) {
    if (std::binary_search(equalities_.begin(), equalities_.end(), i)) continue;
    const bool vanishes = rows.row(i).norm() <= kRowTolerance * std::max(row_norm_[i], kRowTolerance);
    (vanishes ? fixed_ : rows_).push_back(i);
  }
  A_y_.resize(static_cast<Eigen::Index>(rows_.size()), N_.cols());
  norm_y_.resize(A_y_.rows());
  for (Eigen::Index i = 0; i < A_y_.rows(); ++i) {
    const auto row = rows.row(rows_[static_cast<std::size_t>(i)]);
    norm_y_[i] = row.norm();
    A_y_.row(i) = row / norm_y_[i];
  }
  solution_.z.setZero(n);
  solution_.lambda.setZero(m);
}

const InteriorPointSolution& InteriorPointQp::solve(const Eigen::VectorXd& g, const Eigen::VectorXd& b) {
  assert(g.size() == H_.rows() && b.size() == A_.rows());
  solution_.status = InteriorPointStatus::kInaccurate;
  solution_.iterations = 0;
  solution_.residual = std::numeric_limits<double>::infinity();
  solution_.lambda.setZero();
  if (!reduce(g, b)) return solution_;
  start();
  const End end = iterate();
  if (end == End::kInfeasible) {
    solution_.status = InteriorPointStatus::kInfeasible;
    const double sum = l_.sum();
    for (Eigen::Index i = 0; i < l_.size(); ++i) {
      solution_.lambda[rows_[static_cast<std::size_t>(i)]] = l_[i] / (norm_y_[i] * sum);
    }
    addEqualityMultipliers(A_.transpose() * solution_.lambda);
    return solution_;
  }
  if (end == End::kUnbounded) {
    solution_.status = InteriorPointStatus::kUnbounded;
    return solution_;
  }
  polish();
  expand(g, b);
  if (solution_.residual <= kInteriorPointAccuracy) solution_.status = InteriorPointStatus::kOptimal;
  return solution_;
}

// Moves to the null space of the equalities. False, with the status set, when no z meets the rows that
// leave no freedom.
bool InteriorPointQp::reduce(const Eigen::VectorXd& g, const Eigen::VectorXd& b) {
  const Eigen::Index eq_count = A_eq_.rows();
  if (eq_count == 0) {
    z0_.setZero(H_.rows());
  } else {
    rhs_.resize(eq_count);
    for (Eigen::Index i = 0; i < eq_count; ++i) rhs_[i] = b[equalities_[static_cast<std::size_t>(i)]];
    z0_ = eq_factor_.solve(rhs_);
    target_ = rhs_ - A_eq_ * z0_;
    for (Eigen::Index i = 0; i < eq_count; ++i) {
      const double norm = row_norm_[equalities_[static_cast<std::size_t>(i)]];
      if (std::abs(target_[i]) <= kConsistency * std::max(norm, std::abs(rhs_[i]))) continue;
      // The residual of the least-squares solution is orthogonal to the rows' span: it is the certificate.
      solution_.status = InteriorPointStatus::kInfeasible;
      for (Eigen::Index j = 0; j < eq_count; ++j)
        solution_.lambda[equalities_[static_cast<std::size_t>(j)]] = -target_[j];
      return false;
    }
  }
  for (const int row : fixed_) {
    const double slack = b[row] - A_.row(row).dot(z0_);
    if (slack >= -kConsistency * std::max({row_norm_[row], std::abs(b[row]), kConsistency})) continue;
    solution_.status = InteriorPointStatus::kInfeasible;
    solution_.lambda[row] = 1.0;
    addEqualityMultipliers(A_.row(row).transpose());
    return false;
  }
  y_work_.noalias() = H_ * z0_;
  y_work_ += g;
  g_y_.noalias() = N_.transpose() * y_work_;
  b_y_.resize(A_y_.rows());
  for (Eigen::Index i = 0; i < b_y_.size(); ++i) {
    const int row = rows_[static_cast<std::size_t>(i)];
    b_y_[i] = (b[row] - A_.row(row).dot(z0_)) / norm_y_[i];
  }
  const double cost_scale = std::max(H_y_.size() == 0 ? 0.0 : H_y_.cwiseAbs().maxCoeff(), maxAbs(g_y_));
  kappa_ = cost_scale > 0.0 ? 1.0 / cost_scale : 1.0;
  g_y_ *= kappa_;
  return true;
}

void InteriorPointQp::start() {
  normal_.noalias() = A_y_.transpose() * A_y_;
  normal_ += kappa_ * H_y_;
  normal_.diagonal().array() += kResidualGoal;
  factor_.compute(normal_);
  rhs_.noalias() = A_y_.transpose() * b_y_;
  rhs_ -= g_y_;
  y_ = factor_.solve(rhs_);
  row_work_ = b_y_;
  row_work_.noalias() -= A_y_ * y_;
  const double floor = 0.1 * std::max(1.0, maxAbs(row_work_));
  s_ = row_work_.cwiseMax(floor);
  l_.setOnes(s_.size());
}

void InteriorPointQp::factorise() {
  weight_ = l_.cwiseQuotient(s_);
  scaled_rows_ = weight_.cwiseSqrt().asDiagonal() * A_y_;
  normal_ = kappa_ * H_y_;
  normal_.selfadjointView<Eigen::Lower>().rankUpdate(scaled_rows_.transpose());
  factor_.compute(normal_);
  double shift =
      kRegularisation * std::max(1.0, normal_.diagonal().size() == 0 ? 0.0 : normal_.diagonal().maxCoeff());
  while (factor_.info() != Eigen::Success && shift < 1.0) {
    normal_.diagonal().array() += shift;
    factor_.compute(normal_);
    shift *= 100.0;
  }
}

// Newton direction for H dy + A'dl = -r_dual, A dy + ds = -r_primal, l ds + s dl = -complementarity.
void InteriorPointQp::direction(const Eigen::VectorXd& complementarity) {
  row_work_ = (l_.cwiseProduct(r_primal_) - complementarity).cwiseQuotient(s_);
  rhs_.noalias() = -(A_y_.transpose() * row_work_);
  rhs_ -= r_dual_;
  dy_ = factor_.solve(rhs_);
  ds_ = -r_primal_;
  ds_.noalias() -= A_y_ * dy_;
  dl_ = -(complementarity + l_.cwiseProduct(ds_)).cwiseQuotient(s_);
}

double InteriorPointQp::stepLength() const {
  double step = 1.0;
  for (Eigen::Index i = 0; i < s_.size(); ++i) {
    if (ds_[i] < 0.0) step = std::min(step, -s_[i] / ds_[i]);
    if (dl_[i] < 0.0) step = std::min(step, -l_[i] / dl_[i]);
  }
  return step;
}

InteriorPointQp::End InteriorPointQp::iterate() {
  const double count = std::max<double>(1.0, static_cast<double>(s_.size()));
  const double b_scale = std::max(1.0, maxAbs(b_y_));
  int stalled = 0;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    solution_.iterations = iteration;
    r_dual_.noalias() = kappa_ * (H_y_ * y_);
    r_dual_ += g_y_;
    r_dual_.noalias() += A_y_.transpose() * l_;
    r_primal_ = s_ - b_y_;
    r_primal_.noalias() += A_y_ * y_;
    mu_ = s_.dot(l_) / count;
    // Past the goal for the gap the normal matrix is too ill-conditioned to gain more: the correction does
    // the rest.
    const double goal = mu_ <= kGapGoal ? kLateResidualGoal : kResidualGoal;
    if (mu_ <= kEarlyGapGoal && maxAbs(r_dual_) <= goal * std::max(1.0, maxAbs(l_)) &&
        maxAbs(r_primal_) <= goal * b_scale) {
      return End::kConverged;
    }
    if (provesInfeasible()) return End::kInfeasible;
    if (provesUnbounded()) return End::kUnbounded;

    factorise();
    target_ = s_.cwiseProduct(l_);
    direction(target_);
    const double affine_step = stepLength();
    const double affine_mu = (s_ + affine_step * ds_).dot(l_ + affine_step * dl_) / count;
    const double ratio = mu_ > 0.0 ? affine_mu / mu_ : 0.0;
    const double centring = ratio * ratio * ratio * mu_;
    target_ += ds_.cwiseProduct(dl_);
    target_.array() -= centring;
    direction(target_);
    const double step = std::min(1.0, std::max(kStepFraction, 1.0 - mu_) * stepLength());
    if (!std::isfinite(step) || !dy_.allFinite() || !dl_.allFinite()) return End::kStalled;
    y_ += step * dy_;
    s_ += step * ds_;
    l_ += step * dl_;
    stalled = step < kStalledStep ? stalled + 1 : 0;
    if (stalled >= kMaxStalledSteps) return End::kStalled;
  }
  return End::kStalled;
}

// w = l / sum(l) with A'w = 0 and b'w < 0 admits no solution. With A'w small but not zero it still excludes
// every y with |y|_1 < -b'w / |A'w|_inf.
bool InteriorPointQp::provesInfeasible() {
  const double sum = l_.sum();
  if (!(sum > kCertificateSum)) return false;
  const double value = b_y_.dot(l_) / sum;
  if (value >= -kInteriorPointAccuracy) return false;
  y_work_.noalias() = A_y_.transpose() * l_;
  return -value >= kCertificateRadius * std::max(maxAbs(y_work_) / sum, std::numeric_limits<double>::min());
}

bool InteriorPointQp::provesUnbounded() {
  const double length = y_.norm();
  if (!(length > kRayGrowth)) return false;
  if (g_y_.dot(y_) >= -kRayTolerance * length) return false;
  y_work_.noalias() = kappa_ * (H_y_ * y_);
  if (maxAbs(y_work_) > kRayTolerance * length) return false;
  row_work_.noalias() = A_y_ * y_;
  return row_work_.size() == 0 || row_work_.maxCoeff() <= kRayTolerance * length;
}

double InteriorPointQp::reducedResidual() const {
  const Eigen::VectorXd stationarity = kappa_ * (H_y_ * y_) + g_y_ + A_y_.transpose() * l_;
  const Eigen::VectorXd slack = b_y_ - A_y_ * y_;
  double residual = maxAbs(stationarity);
  for (Eigen::Index i = 0; i < slack.size(); ++i) {
    residual = std::max(
        {residual, -slack[i] / std::max(1.0, std::abs(b_y_[i])), -l_[i], std::abs(l_[i] * slack[i])});
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
    solved =
        step.allFinite() && maxAbs(step) <= 1.0 && maxAbs(kkt * step - residual) <= kSolveTolerance * size;
  }
  if (!solved) {
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
    factor.setThreshold(kRankTolerance);
    factor.compute(kkt);
    step = factor.solve(residual);
  }
  if (!step.allFinite()) return false;
  y_ += step.head(n);
  l_ = kept;
  for (Eigen::Index i = 0; i < k; ++i) l_[active[static_cast<std::size_t>(i)]] += step[n + i];
  return true;
}

// Guesses the active set by comparing multipliers with slacks, solves for it, and lets rows of the wrong sign
// leave or enter. The best point seen is kept.
void InteriorPointQp::polish() {
  double best = reducedResidual();
  if (!(best <= kPolishStart)) return;
  best_y_ = y_;
  best_l_ = l_;
  std::vector<int> active;
  for (int i = 0; i < static_cast<int>(l_.size()); ++i) {
    if (l_[i] > s_[i]) active.push_back(i);
  }
  for (int round = 0; round < kMaxPolishRounds; ++round) {
    if (!correct(active)) break;
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
      if (was_active ? l_[i] >= -kWrongSign : slack < -kWrongSign * std::max(1.0, std::abs(b_y_[i])))
        next.push_back(i);
    }
    if (next == active) break;
    active = std::move(next);
  }
  y_ = best_y_;
  l_ = best_l_;
}

// Multipliers of the equalities that cancel `gradient` best.
void InteriorPointQp::addEqualityMultipliers(const Eigen::VectorXd& gradient) {
  if (equalities_.empty()) return;
  const Eigen::VectorXd nu = eq_transposed_factor_.solve(-gradient);
  for (std::size_t i = 0; i < equalities_.size(); ++i) {
    solution_.lambda[equalities_[i]] = nu[static_cast<Eigen::Index>(i)];
  }
}

// Back to z and the original rows; residuals are measured on the problem as it was given.
void InteriorPointQp::expand(const Eigen::VectorXd& g, const Eigen::VectorXd& b) {
  Eigen::VectorXd& z = solution_.z;
  Eigen::VectorXd& lambda = solution_.lambda;
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
    residual = std::max(residual, -lambda[i] * norm / cost_scale);
    residual = std::max(residual, std::abs(lambda[i] * norm * slack) / (cost_scale * slack_scale));
  }
  solution_.residual = residual;
}

}  // namespace polyfly
