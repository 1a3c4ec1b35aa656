#include "explore/region/high_precision_region.hpp"

#include "explore/region/tolerances.hpp"

namespace polyfly {

KktSolver::Outcome HighPrecisionRegionSolver::solve(const ActiveSet& active) {
  if (!long_) long_.emplace(reduced_);
  is_long_ = long_->solve(active);
  if (is_long_) return Outcome::kSolved;
  const ExactStatus status = exact_.solve(active);
  if (status == ExactStatus::kCostNotSpanned) return Outcome::kNoOptimum;
  return status == ExactStatus::kRegion ? Outcome::kSolved : Outcome::kDependent;
}

void HighPrecisionRegionSolver::multiplier(std::size_t place, double* affine) const {
  is_long_ ? long_->multiplier(place, affine) : exact_.multiplier(place, affine);
}

void HighPrecisionRegionSolver::slack(int row, double* affine) const {
  is_long_ ? long_->slack(row, affine) : exact_.slack(row, affine);
}

double HighPrecisionRegionSolver::constantSlack() const { return tolerance::kConstantSlack; }

double HighPrecisionRegionSolver::law(std::vector<double>& out) const {
  is_long_ ? long_->law(out) : exact_.law(out);
  return 0.0;
}

}  // namespace polyfly
