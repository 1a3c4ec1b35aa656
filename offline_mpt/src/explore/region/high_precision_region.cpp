#include "explore/region/high_precision_region.hpp"

namespace polyfly {

bool HighPrecisionRegionSolver::solve(const std::vector<std::uint16_t>& active) {
  if (!long_) long_.emplace(reduced_);
  is_long_ = long_->solve(active);
  return is_long_ || exact_.solve(active);
}

void HighPrecisionRegionSolver::multiplier(std::size_t place, double* affine) const {
  is_long_ ? long_->multiplier(place, affine) : exact_.multiplier(place, affine);
}

void HighPrecisionRegionSolver::slack(int row, double* affine) const {
  is_long_ ? long_->slack(row, affine) : exact_.slack(row, affine);
}

void HighPrecisionRegionSolver::law(std::vector<double>& out) const {
  is_long_ ? long_->law(out) : exact_.law(out);
}

}  // namespace polyfly
