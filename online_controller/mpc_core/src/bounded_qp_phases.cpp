// The two phases: guessing the active bounds, and ascending the dual.
#include <algorithm>
#include <cmath>
#include <limits>

#include "bounded_qp_solver.hpp"
#include "mpc_core/qp_kernels.hpp"
#include "qp_tolerances.hpp"

namespace polyfly {
namespace {

constexpr int kPredictionRounds = 12;
// Sweeps replace the signs where the bounds of so many variables change: a sixth, or a third after a given working set,
// which is more reliable than an empty one.
constexpr int kManyChanges = 6;
constexpr int kManyChangesOfStart = 3;
// Number of rounds after which the number of changes must fall in each round.
constexpr int kRoundsBySigns = 2;
constexpr int kSweeps = 2;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

// In each round: solve with the predicted set as equalities, then correct each prediction that its sign contradicts.
// Sweeps predict where the corrections do not converge. Leaves a working set whose multipliers have the right signs,
// and its solution; false at the limit of iterations.
bool BoundedQp::Solver::predictBounds() noexcept {
  int before = -1;
  for (int round = 0; round < kPredictionRounds; ++round) {
    if (!solveWorkingSet()) return false;
    const bool given = before < 0 && bound_count_ > 0;
    const int changes = correctPrediction();
    if (changes == 0) {
      predicted_ = true;
      return true;
    }
    const int many = given ? kManyChangesOfStart : kManyChanges;
    const bool diverges = many * changes >= n_ && changes > before;
    const bool stuck = round >= kRoundsBySigns && changes >= before;
    if (diverges || stuck) sweepBounds();
    before = changes;
  }
  return makeDualFeasible();
}

// Gauss-Seidel sweeps from the last solution, moved into the box, predict the active bounds better than the signs where
// many may change. Held variables have the gradient -lambda, free ones 0.
void BoundedQp::Solver::sweepBounds() noexcept {
  for (int i = 0; i < n_; ++i) gradient_[i] = -lambda_[i];
  for (int i = 0; i < n_; ++i) {
    const double inside = std::max(lower_[i], std::min(upper_[i], x_[i]));
    if (inside == x_[i]) continue;
    qpKernels().addMultiple(stride_, inside - x_[i], H_.data() + i * stride_, gradient_.data());
    x_[i] = inside;
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    qpKernels().sweep(H_.data(), n_, stride_, stride_, lower_.data(), upper_.data(), gradient_.data(),
                      x_.data());
  }
  for (int i = 0; i < n_; ++i) {
    if (isEquality(i)) continue;
    side_[static_cast<std::size_t>(i)] = x_[i] <= lower_[i]   ? QpSide::kLower
                                         : x_[i] >= upper_[i] ? QpSide::kUpper
                                                              : QpSide::kInactive;
  }
}

int BoundedQp::Solver::correctPrediction() noexcept {
  int changes = dropWrongSigns();
  const double* const x = x_.data();
  const double* const least = least_.data();
  const double* const greatest = greatest_.data();
  QpSide* const sides = side_.data();
  for (int i = 0; i < n_; ++i) {  // without branches: which bounds are violated is not to be foreseen
    const QpSide free = x[i] < least[i]      ? QpSide::kLower
                        : x[i] > greatest[i] ? QpSide::kUpper
                                             : QpSide::kInactive;
    const QpSide side = sides[i] == QpSide::kInactive ? free : sides[i];
    changes += side != sides[i] ? 1 : 0;
    sides[i] = side;
  }
  return changes;
}

// Takes out of the working set what its multiplier contradicts; how many constraints that were.
int BoundedQp::Solver::dropWrongSigns() noexcept {
  const double tolerance = kRounding * (gradient_scale_ + largestMultiplier());
  int dropped = 0;
  for (int j = 0; j < working_count_; ++j) {
    const int i = working_[static_cast<std::size_t>(j)];
    QpSide& side = side_[static_cast<std::size_t>(i)];
    const double outward = side == QpSide::kUpper ? lambda_[i] : -lambda_[i];
    if (std::abs(lambda_[i]) > penalty_[i]) {
      relax(i, lambda_[i] > 0.0);
    } else if (outward < -tolerance && !isEquality(i)) {
      side = QpSide::kInactive;
    } else {
      continue;
    }
    ++dropped;
  }
  return dropped;
}

double BoundedQp::Solver::largestMultiplier() const noexcept {
  double largest = 0.0;
  for (int j = 0; j < working_count_; ++j) {
    largest = std::max(largest, std::abs(lambda_[working_[static_cast<std::size_t>(j)]]));
  }
  return largest;
}

// The working set only shrinks here, so this ends. False at the limit of iterations.
bool BoundedQp::Solver::makeDualFeasible() noexcept {
  do {
    if (!solveWorkingSet()) return false;
  } while (dropWrongSigns() > 0);
  return true;
}

void BoundedQp::Solver::considerSide(int index, double violation, double direction, QpSide reached,
                                     Candidate& worst) const noexcept {
  const double tolerance =
      reached < QpSide::kInactive ? lower_[index] - least_[index] : greatest_[index] - upper_[index];
  if (!(violation > tolerance) || violation <= worst.violation * scale_[index]) return;
  worst = {index, direction, violation / scale_[index], reached};
}

BoundedQp::Solver::Candidate BoundedQp::Solver::mostViolated() const noexcept {
  Candidate worst;
  for (int i = 0; i < n_ + m_; ++i) {
    const double value = i < n_ ? x_[i] : row_value_[i - n_];
    switch (side_[static_cast<std::size_t>(i)]) {
      case QpSide::kInactive:
        considerSide(i, lower_[i] - value, -1.0, QpSide::kLower, worst);
        considerSide(i, value - upper_[i], 1.0, QpSide::kUpper, worst);
        break;
      case QpSide::kUpperRelaxed:
        considerSide(i, upper_[i] - value, -1.0, QpSide::kUpper, worst);
        break;
      case QpSide::kLowerRelaxed:
        considerSide(i, value - lower_[i], 1.0, QpSide::kLower, worst);
        break;
      case QpSide::kLower:
      case QpSide::kUpper:
        break;
    }
  }
  return worst;
}

// How far the multipliers of the working set let that of the candidate move.
double BoundedQp::Solver::blockingStep(int* blocking) const noexcept {
  double least = kInfinity;
  for (int j = 0; j < working_count_; ++j) {
    const int i = working_[static_cast<std::size_t>(j)];
    const double rate = dlambda_[i];
    if (std::abs(rate) <= kNegative) continue;
    const bool upper = side_[static_cast<std::size_t>(i)] == QpSide::kUpper;
    const double ceiling = upper || isEquality(i) ? penalty_[i] : 0.0;
    const double floor = upper && !isEquality(i) ? 0.0 : -penalty_[i];
    const double room = rate > 0.0 ? ceiling - lambda_[i] : lambda_[i] - floor;
    const double step = std::max(0.0, room) / std::abs(rate);
    if (step < least) {
      least = step;
      *blocking = i;
    }
  }
  return least;
}

// A constraint of the working set whose multiplier has come to one of its ends leaves it there.
void BoundedQp::Solver::release(int index) noexcept {
  QpSide& side = side_[static_cast<std::size_t>(index)];
  const bool at_penalty = isEquality(index) || std::abs(lambda_[index]) > 0.5 * penalty_[index];
  if (!at_penalty) {
    side = QpSide::kInactive;
    lambda_[index] = 0.0;
    return;
  }
  relax(index, lambda_[index] > 0.0);
}

// The multiplier of a relaxed row is its penalty, towards the side that is violated.
void BoundedQp::Solver::relax(int index, bool upper) noexcept {
  side_[static_cast<std::size_t>(index)] = upper ? QpSide::kUpperRelaxed : QpSide::kLowerRelaxed;
  lambda_[index] = upper ? penalty_[index] : -penalty_[index];
}

// Moves the multiplier of the most violated constraint until the constraint holds or its penalty is reached;
// constraints whose multipliers come to an end on the way leave the working set.
BoundedQp::Solver::Pass BoundedQp::Solver::ascend() noexcept {
  if (predicted_ && m_ == 0) return Pass::kOptimal;  // all bounds have been looked at
  evaluateRows();
  const Candidate candidate = mostViolated();
  if (candidate.index < 0) return Pass::kOptimal;
  const int p = candidate.index;
  const bool relaxed = side_[static_cast<std::size_t>(p)] != QpSide::kInactive;
  const double at = candidate.reached == QpSide::kLower ? lower_[p] : upper_[p];
  const double self = along(p, inverseColumn(p));
  side_[static_cast<std::size_t>(p)] = QpSide::kInactive;
  entering_ = p;
  for (;;) {
    solveDirection(candidate);
    const double curvature = -candidate.direction * along(p, dx_.data());
    const double missing = candidate.direction * (along(p, x_.data()) - at);
    const double primal = curvature > kDependent * self ? std::max(0.0, missing) / curvature : kInfinity;
    const double own = relaxed ? std::abs(lambda_[p]) : penalty_[p] - std::abs(lambda_[p]);
    int blocking = -1;
    const double dual = blockingStep(&blocking);
    const double step = std::min({primal, own, dual});
    if (!std::isfinite(step)) return Pass::kInfeasible;
    for (int j = 0; j < working_count_; ++j) {
      const int i = working_[static_cast<std::size_t>(j)];
      lambda_[i] += step * dlambda_[i];
    }
    lambda_[p] += step * candidate.direction;
    if (step == primal) {
      side_[static_cast<std::size_t>(p)] = candidate.reached;
      entering_ = -1;
    } else if (step == own) {
      addToWorkingSet(candidate, relaxed);
    } else {
      release(blocking);
    }
    if (!solveWorkingSet()) return Pass::kIterationLimit;
    if (entering_ < 0) return Pass::kAdvanced;
  }
}

// The candidate's own multiplier has come to its end.
void BoundedQp::Solver::addToWorkingSet(const Candidate& candidate, bool was_relaxed) noexcept {
  const int p = candidate.index;
  entering_ = -1;
  if (was_relaxed) {
    lambda_[p] = 0.0;
    return;
  }
  relax(p, candidate.direction > 0.0);
}

}  // namespace polyfly
