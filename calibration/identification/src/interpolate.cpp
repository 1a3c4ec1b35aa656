#include "interpolate.hpp"

#include <algorithm>
#include <cstddef>

namespace polyfly {

double interpolated(const TimeSeries& series, double time) {
  const auto after = std::upper_bound(series.time.begin(), series.time.end(), time);
  if (after == series.time.begin()) return series.value.front();
  if (after == series.time.end()) return series.value.back();
  const auto i = static_cast<std::size_t>(after - series.time.begin());
  const double share = (time - series.time[i - 1]) / (series.time[i] - series.time[i - 1]);
  return series.value[i - 1] + share * (series.value[i] - series.value[i - 1]);
}

}  // namespace polyfly
