#include "verify/interior_point_qp.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "mpc_core/decompositions.hpp"
#include "verify/interior_point_parts.hpp"
#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

constexpr int kMaxIterations = 80;
constexpr int kMehrotraIterations = 30;
// Target of plain path-following steps after the Mehrotra iterations, as a share of the mean product.
constexpr double kPlainCentring = 0.2;
constexpr int kMaxStalledSteps = 4;
// Share of the way to the boundary that a step may take, at first.
constexpr double kStepFraction = 0.995;
// Share of the way to the boundary that a step may take, near the end.
constexpr double kLastStepFraction = 0.999999;

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
    eq_factor_ = ShortestLeastSquares(A_eq_, tolerance::kInteriorPointRank);
    eq_transposed_factor_ = ShortestLeastSquares(A_eq_.transpose(), tolerance::kInteriorPointRank);
    const PivotedQr qr(A_eq_.transpose(), tolerance::kInteriorPointRank);
    N_ = qr.Q().rightCols(n - qr.rank());
  }
  H_y_ = N_.transpose() * H_ * N_;

  const Eigen::MatrixXd rows = A_ * N_;
  for (int i = 0; i < static_cast<int>(m); ++i) {
    if (std::binary_search(equalities_.begin(), equalities_.end(), i)) continue;
    const bool vanishes = rows.row(i).norm() <= tolerance::kImpliedByEqualities *
                                                    std::max(row_norm_[i], tolerance::kImpliedByEqualities);
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
  for (const bool careful : {false, true}) {
    careful_ = careful;
    start();
    switch (iterate()) {
      case End::kInfeasible:
        setCertificate();
        return solution_;
      case End::kUnbounded:
        solution_.status = InteriorPointStatus::kUnbounded;
        return solution_;
      case End::kConverged:
      case End::kStalled:
        break;
    }
    polish();
    expand(g, b);
    if (solution_.residual <= tolerance::kInteriorPointAccuracy) {
      solution_.status = InteriorPointStatus::kOptimal;
      return solution_;
    }
  }
  return solution_;
}

void InteriorPointQp::setCertificate() {
  solution_.status = InteriorPointStatus::kInfeasible;
  solution_.lambda.setZero();
  const double sum = l_.sum();
  for (Eigen::Index i = 0; i < l_.size(); ++i) {
    solution_.lambda[rows_[static_cast<std::size_t>(i)]] = l_[i] / (norm_y_[i] * sum);
  }
  addEqualityMultipliers(A_.transpose() * solution_.lambda);
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
      if (std::abs(target_[i]) <= tolerance::kConsistentEqualities * std::max(norm, std::abs(rhs_[i])))
        continue;
      // The residual of the least-squares solution is orthogonal to the rows' span: it is the certificate.
      solution_.status = InteriorPointStatus::kInfeasible;
      for (Eigen::Index j = 0; j < eq_count; ++j)
        solution_.lambda[equalities_[static_cast<std::size_t>(j)]] = -target_[j];
      return false;
    }
  }
  for (const int row : fixed_) {
    const double slack = b[row] - A_.row(row).dot(z0_);
    if (slack >= -tolerance::kConsistentEqualities *
                     std::max({row_norm_[row], std::abs(b[row]), tolerance::kConsistentEqualities}))
      continue;
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
  normal_.diagonal().array() += tolerance::kResidualGoal;
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

// Quick: the normal matrix H + A' diag(l / s) A. Careful: the whole Newton system in (dy, dl), its rows
// divided by max(l, s), which stays well-conditioned up to the end; several times as dear.
void InteriorPointQp::factorise() {
  if (careful_) {
    const Eigen::Index n = y_.size(), m = s_.size();
    row_scale_ = l_.cwiseMax(s_);
    newton_.setZero(n + m, n + m);
    newton_.topLeftCorner(n, n) = kappa_ * H_y_;
    newton_.topLeftCorner(n, n).diagonal().array() += tolerance::kRegularisation;
    newton_.topRightCorner(n, m) = A_y_.transpose();
    newton_.bottomLeftCorner(m, n) = l_.cwiseQuotient(row_scale_).asDiagonal() * A_y_;
    newton_.bottomRightCorner(m, m).diagonal() = -s_.cwiseQuotient(row_scale_);
    newton_factor_.compute(newton_);
    return;
  }
  weight_ = l_.cwiseQuotient(s_);
  scaled_rows_ = weight_.cwiseSqrt().asDiagonal() * A_y_;
  normal_ = kappa_ * H_y_;
  normal_.selfadjointView<Eigen::Lower>().rankUpdate(scaled_rows_.transpose());
  factor_.compute(normal_);
  double shift = tolerance::kRegularisation *
                 std::max(1.0, normal_.diagonal().size() == 0 ? 0.0 : normal_.diagonal().maxCoeff());
  while (factor_.info() != Eigen::Success && shift < 1.0) {
    normal_.diagonal().array() += shift;
    factor_.compute(normal_);
    shift *= 100.0;
  }
}

// Newton direction for H dy + A'dl = -r_dual, A dy + ds = -r_primal, l ds + s dl = -complementarity.
void InteriorPointQp::direction(const Eigen::VectorXd& complementarity) {
  const Eigen::Index n = y_.size(), m = s_.size();
  row_work_ = complementarity - l_.cwiseProduct(r_primal_);
  if (careful_) {
    rhs_.resize(n + m);
    rhs_ << -r_dual_, row_work_.cwiseQuotient(row_scale_);
    newton_step_ = newton_factor_.solve(rhs_);
    dy_ = newton_step_.head(n);
    dl_ = newton_step_.tail(m);
    ds_ = -r_primal_;
    ds_.noalias() -= A_y_ * dy_;
    return;
  }
  row_work_ = row_work_.cwiseQuotient(s_);
  rhs_.noalias() = A_y_.transpose() * row_work_;
  rhs_ -= r_dual_;
  dy_ = factor_.solve(rhs_);
  ds_ = -r_primal_;
  ds_.noalias() -= A_y_ * dy_;
  dl_ = -(complementarity + l_.cwiseProduct(ds_)).cwiseQuotient(s_);
}

double InteriorPointQp::stepLength() const {
  double step = std::numeric_limits<double>::max();
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
    const double goal = mu_ <= tolerance::kGapGoal ? tolerance::kLateResidualGoal : tolerance::kResidualGoal;
    const double gap_goal = careful_ ? tolerance::kCarefulGapGoal : tolerance::kEarlyGapGoal;
    if (mu_ <= gap_goal && maxAbs(r_dual_) <= goal * std::max(1.0, maxAbs(l_)) &&
        maxAbs(r_primal_) <= goal * b_scale) {
      return End::kConverged;
    }
    // What is left is rounding: chasing it would push slacks smaller than it across zero.
    for (Eigen::Index i = 0; i < r_primal_.size(); ++i) {
      if (std::abs(r_primal_[i]) <= tolerance::kRowRounding * (1.0 + std::abs(b_y_[i]))) r_primal_[i] = 0.0;
    }
    if (provesInfeasible()) return End::kInfeasible;
    if (provesUnbounded()) return End::kUnbounded;

    factorise();
    target_ = s_.cwiseProduct(l_);
    direction(target_);
    const double affine_step = std::min(1.0, stepLength());
    const double affine_mu = (s_ + affine_step * ds_).dot(l_ + affine_step * dl_) / count;
    const double ratio = mu_ > 0.0 ? affine_mu / mu_ : 0.0;
    if (iteration < kMehrotraIterations) {
      target_ += ds_.cwiseProduct(dl_);
      target_.array() -= ratio * ratio * ratio * mu_;
    } else {
      // The predictor can cycle, but a plain path-following step cannot.
      target_.array() -= kPlainCentring * mu_;
    }
    direction(target_);
    const double fraction =
        careful_ ? kStepFraction : std::clamp(1.0 - mu_, kStepFraction, kLastStepFraction);
    const double step = std::min(1.0, fraction * stepLength());
    if (!std::isfinite(step) || !dy_.allFinite() || !dl_.allFinite()) return End::kStalled;
    y_ += step * dy_;
    s_ += step * ds_;
    l_ += step * dl_;
    stalled = step < tolerance::kStalledStep ? stalled + 1 : 0;
    if (stalled >= kMaxStalledSteps) return End::kStalled;
  }
  return End::kStalled;
}

// w = l / sum(l) with A'w = 0 and b'w < 0 admits no solution. With A'w small but not zero it still excludes
// every y with |y|_1 < -b'w / |A'w|_inf.
bool InteriorPointQp::provesInfeasible() {
  const double sum = l_.sum();
  if (!(sum > tolerance::kCertificateSum)) return false;
  const double value = b_y_.dot(l_) / sum;
  if (value >= -tolerance::kInteriorPointAccuracy) return false;
  y_work_.noalias() = A_y_.transpose() * l_;
  return -value >=
         tolerance::kCertificateRadius * std::max(maxAbs(y_work_) / sum, std::numeric_limits<double>::min());
}

bool InteriorPointQp::provesUnbounded() {
  const double length = y_.norm();
  if (!(length > tolerance::kRayGrowth)) return false;
  if (g_y_.dot(y_) >= -tolerance::kRayTolerance * length) return false;
  y_work_.noalias() = kappa_ * (H_y_ * y_);
  if (maxAbs(y_work_) > tolerance::kRayTolerance * length) return false;
  row_work_.noalias() = A_y_ * y_;
  return row_work_.size() == 0 || row_work_.maxCoeff() <= tolerance::kRayTolerance * length;
}

}  // namespace polyfly
