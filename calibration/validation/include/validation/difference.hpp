#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace polyfly {

/// Greatest and root-mean-square difference of two series.
struct Difference {
  double max = 0.0;
  double rms = 0.0;
  /// Time of the greatest difference [s].
  double stamp = 0.0;
};

// The greater of two sizes, NaN if one of them is: it must never hide.
inline double worse(double one, double other) {
  if (std::isnan(one) || std::isnan(other)) return std::numeric_limits<double>::quiet_NaN();
  return std::max(one, other);
}

// Collects differences into their greatest and their mean square.
class DifferenceCollector {
 public:
  void add(double difference, double stamp) {
    const double size = std::abs(difference);
    if (!std::isnan(result_.max) && !(size <= result_.max)) {
      result_.max = size;
      result_.stamp = stamp;
    }
    sum_ += size * size;
    ++count_;
    result_.rms = std::sqrt(sum_ / static_cast<double>(count_));
  }
  const Difference& result() const { return result_; }
  std::size_t count() const { return count_; }

 private:
  Difference result_;
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

}  // namespace polyfly
