#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace polyfly {

/// The value below which this share of the values lies; 0 without values.
inline double quantileOf(std::vector<double> values, double share = 0.5) {
  if (values.empty()) return 0.0;
  const auto place = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::min(place, values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace polyfly
