#include "count/strict_complementarity_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "count/tolerances.hpp"

namespace polyfly {
namespace {

// Silent: equalities, multiples of active rows.
enum TestedRow : char { kRowInactive, kRowActive, kRowSilent };

}  // namespace

bool insideDomain(const StrictComplementaritySystem& system, const Witness& witness) {
  Eigen::VectorXd t(system.p);
  for (int j = 0; j < system.p; ++j)
    t(j) = tolerance::kWitnessStep * static_cast<double>(witness.t[static_cast<std::size_t>(j)]);
  if (t.cwiseAbs().maxCoeff() > 1.0 - tolerance::kDomainMargin) return false;
  for (Eigen::Index i = 0; i < system.domain.rows(); ++i) {
    const double room = system.domain(i, system.p) - system.domain.row(i).head(system.p).dot(t);
    if (room < tolerance::kDomainMargin) return false;
  }
  return true;
}

StrictComplementarityCheck::StrictComplementarityCheck(const StrictComplementaritySystem& system,
                                                       const std::vector<double>& gap)
    : system_(system), gap_(gap), size_(system.gram.cwiseAbs()), state_(static_cast<std::size_t>(system.m)) {}

// The rows of the set, and what must hold for each row.
bool StrictComplementarityCheck::take(const std::vector<int>& set) {
  active_.assign(system_.equalities.begin(), system_.equalities.end());
  std::fill(state_.begin(), state_.end(), kRowInactive);
  for (const int row : active_) state_[static_cast<std::size_t>(row)] = kRowSilent;
  for (const int row : set) {
    if (state_[static_cast<std::size_t>(row)] != kRowInactive) return false;
    state_[static_cast<std::size_t>(row)] = kRowActive;
    active_.push_back(row);
  }
  for (std::size_t i = 0; i < state_.size(); ++i) {
    const char first = state_[static_cast<std::size_t>(system_.first_of[i])];
    if (state_[i] == kRowInactive && first == kRowActive) state_[i] = kRowSilent;
  }
  return invert();
}

// The inverse of gram of the active rows, by its Cholesky factor; false where they depend on each other.
bool StrictComplementarityCheck::invert() {
  const auto k = static_cast<Eigen::Index>(active_.size());
  Eigen::MatrixXd& L = factor_;
  L.setZero(k, k);
  for (Eigen::Index c = 0; c < k; ++c) {
    for (Eigen::Index r = c; r < k; ++r) {
      double value = system_.gram(active_[static_cast<std::size_t>(r)], active_[static_cast<std::size_t>(c)]);
      for (Eigen::Index i = 0; i < c; ++i) value -= L(r, i) * L(c, i);
      if (r > c) {
        L(r, c) = value / L(c, c);
      } else if (value > tolerance::kIndependentRow) {
        L(c, c) = std::sqrt(value);
      } else {
        return false;
      }
    }
  }
  for (Eigen::Index c = 0; c < k; ++c) {  // L^-1 in the place of L
    for (Eigen::Index r = c; r < k; ++r) {
      double value = r == c ? 1.0 : 0.0;
      for (Eigen::Index i = c; i < r; ++i) value -= L(r, i) * L(i, c);
      L(r, c) = value / L(r, r);
    }
  }
  inverse_.noalias() = L.transpose() * L;
  return true;
}

// Multipliers and slacks for D (t, 1) = `distances`; multipliers in the places of the active rows' slacks.
void StrictComplementarityCheck::solve(const Eigen::VectorXd& distances, Eigen::VectorXd& values) {
  const auto k = static_cast<Eigen::Index>(active_.size());
  right_.resize(k);
  for (Eigen::Index r = 0; r < k; ++r) right_(r) = distances(active_[static_cast<std::size_t>(r)]);
  multipliers_.noalias() = -(inverse_ * right_);
  values = distances;
  for (Eigen::Index r = 0; r < k; ++r)
    values += multipliers_(r) * system_.gram.col(active_[static_cast<std::size_t>(r)]);
  for (Eigen::Index r = 0; r < k; ++r) values(active_[static_cast<std::size_t>(r)]) = multipliers_(r);
}

// What becomes of changes of the rows' distances D (t, 1), from above: of multipliers, and of slacks with
// them.
void StrictComplementarityCheck::carry(const Eigen::VectorXd& distances, Eigen::VectorXd& values) {
  const auto k = static_cast<Eigen::Index>(active_.size());
  right_.resize(k);
  for (Eigen::Index r = 0; r < k; ++r) right_(r) = distances(active_[static_cast<std::size_t>(r)]);
  multipliers_.noalias() = inverse_.cwiseAbs() * right_;
  values = distances;
  for (Eigen::Index r = 0; r < k; ++r)
    values += multipliers_(r) * size_.col(active_[static_cast<std::size_t>(r)]);
  for (Eigen::Index r = 0; r < k; ++r) values(active_[static_cast<std::size_t>(r)]) = multipliers_(r);
}

// What rounding may do to values_, about: what it does where the rows' distances meet the multipliers,
// carried on.
void StrictComplementarityCheck::findDoubts() {
  distances_ = system_.reach;
  for (const int row : active_) distances_ += std::abs(values_(row)) * size_.col(row);
  distances_ *= system_.noise * (static_cast<double>(active_.size()) + 2.0);
  carry(distances_, doubts_);
}

// Whether all of values_, at t, are as they must be: clearly positive, and for `radius` around t.
bool StrictComplementarityCheck::accept(const Eigen::VectorXd& t, double radius, Witness& witness) {
  witness.t.resize(static_cast<std::size_t>(system_.p));
  for (int j = 0; j < system_.p; ++j)
    witness.t[static_cast<std::size_t>(j)] = std::llround(t(j) / tolerance::kWitnessStep);
  if (!insideDomain(system_, witness)) return false;
  findDoubts();
  witness.law_apart = !gap_.empty();
  for (Eigen::Index i = 0; i < system_.m; ++i) {
    const char state = state_[static_cast<std::size_t>(i)];
    if (state == kRowSilent) continue;
    if (!(values_(i) > tolerance::kRoundingSafety * doubts_(i) + radius * slopes_(i))) return false;
    if (state == kRowInactive && witness.law_apart)
      witness.law_apart =
          values_(i) > tolerance::kClearlyApart * gap_[static_cast<std::size_t>(i)] / system_.length(i);
  }
  return true;
}

void StrictComplementarityCheck::evaluate(const double* t) {
  point_ = Eigen::Map<const Eigen::VectorXd>(t, system_.p);
  distances_.noalias() = system_.D.leftCols(system_.p) * point_;
  distances_ += system_.D.col(system_.p);
  solve(distances_, values_);
}

// Where a ray leaves the box or A_theta.
double StrictComplementarityCheck::edge(const double* direction) const {
  double most = 2.0 * std::sqrt(static_cast<double>(system_.p));
  const auto clip = [&](double room, double change) {
    if (change > 0.0) most = std::min(most, room / change);
  };
  const Eigen::Map<const Eigen::VectorXd> ahead(direction, system_.p);
  for (int j = 0; j < system_.p; ++j)
    clip(1.0 - std::copysign(1.0, ahead(j)) * point_(j), std::abs(ahead(j)));
  for (Eigen::Index i = 0; i < system_.domain.rows(); ++i) {
    const auto row = system_.domain.row(i).head(system_.p);
    clip(system_.domain(i, system_.p) - row.dot(point_), row.dot(ahead));
  }
  return most;
}

// How values_ change along a ray.
void StrictComplementarityCheck::differentiate(const double* direction) {
  distances_.noalias() =
      system_.D.leftCols(system_.p) * Eigen::Map<const Eigen::VectorXd>(direction, system_.p);
  solve(distances_, changes_);
}

bool StrictComplementarityCheck::at(const std::vector<int>& set, const double* t, double radius,
                                    Witness& witness) {
  if (radius < tolerance::kLeastRadius || !take(set)) return false;
  evaluate(t);
  slopes_.setZero(system_.m);
  return accept(point_, 0.0, witness);
}

int StrictComplementarityCheck::leaving(const std::vector<int>& set, int entering, const double* from) {
  if (!take(set)) return kNone;
  const auto k = static_cast<Eigen::Index>(active_.size());
  right_.resize(k);
  for (Eigen::Index r = 0; r < k; ++r)
    right_(r) = system_.gram(active_[static_cast<std::size_t>(r)], entering);
  const Eigen::VectorXd weights = inverse_ * right_;
  if (system_.gram(entering, entering) - weights.dot(right_) > tolerance::kIndependentRow) return kNone;
  evaluate(from);
  double least = std::numeric_limits<double>::infinity();
  int first = kNone;
  for (Eigen::Index r = 0; r < k; ++r) {
    const int row = active_[static_cast<std::size_t>(r)];
    if (state_[static_cast<std::size_t>(row)] != kRowActive || weights(r) <= tolerance::kIndependentRow)
      continue;
    const double ratio = values_(row) / weights(r);
    if (ratio >= least) continue;
    least = ratio;
    first = row;
  }
  return first;
}

bool StrictComplementarityCheck::onRay(const std::vector<int>& set, const double* from,
                                       const double* direction, Witness& witness) {
  if (!take(set)) return false;
  evaluate(from);
  differentiate(direction);
  double least = 0.0, most = edge(direction);
  for (Eigen::Index i = 0; i < system_.m; ++i) {
    if (state_[static_cast<std::size_t>(i)] == kRowSilent) continue;
    const double value = values_(i), change = changes_(i);
    if (change > 0.0) {
      least = std::max(least, -value / change);
    } else if (change < 0.0) {
      most = std::min(most, -value / change);
    } else if (value <= 0.0) {
      return false;
    }
    if (most <= least) return false;
  }
  const double middle = 0.5 * (least + most);
  values_ += middle * changes_;
  point_ += middle * Eigen::Map<const Eigen::VectorXd>(direction, system_.p);
  carry(system_.slope, slopes_);
  return accept(point_, tolerance::kLeastRadius, witness);
}

}  // namespace polyfly
