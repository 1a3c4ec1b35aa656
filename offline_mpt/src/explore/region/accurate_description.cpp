#include "explore/region/accurate_description.hpp"

namespace polyfly {

bool AccurateDescription::describe(const std::vector<std::uint16_t>& active) {
  if (!long_) long_.emplace(reduced_);
  is_long_ = long_->describe(active);
  return is_long_ || exact_.describe(active);
}

void AccurateDescription::multiplier(std::size_t place, double* affine) const {
  is_long_ ? long_->multiplier(place, affine) : exact_.multiplier(place, affine);
}

void AccurateDescription::slack(int row, double* affine) const {
  is_long_ ? long_->slack(row, affine) : exact_.slack(row, affine);
}

void AccurateDescription::law(std::vector<double>& out) const {
  is_long_ ? long_->law(out) : exact_.law(out);
}

}  // namespace polyfly
