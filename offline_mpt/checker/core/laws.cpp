// Statement 3: the laws of the map are the exact ones.
#include <algorithm>
#include <cmath>

#include "core/certificate.hpp"

namespace checker {

/// Its range; without one, the greatest |u| of all laws in the box.
Fraction Certificate::sizeOf(std::size_t input) const {
  const double *bounds = map_.bounds.data() + 2 * (p_ + input), *end = map_.laws.data() + map_.laws.size();
  Fraction size;
  if (std::isfinite(bounds[0]) && std::isfinite(bounds[1])) {
    size = Fraction(bounds[1]) - Fraction(bounds[0]);
  } else {
    for (const double* row = map_.laws.data() + input * (p_ + 1); row < end; row += q_ * (p_ + 1))
      size = std::max(size, scaling_.greatestInBox(row));
  }
  return size > 0 ? size : Fraction(1);
}

/// The difference counts the rounding of u. Sum is the greatest |u| of the map's law in the box. Tolerances are shares of it, at
/// least 1, but of no more than the input's size.
void Certificate::checkLaw(std::size_t index, const Region& region) const {
  for (std::size_t i = 0; i < q_; ++i) {
    const double* row = map_.laws.data() + (map_.regions[index].law * q_ + i) * (p_ + 1);
    const Vector mapped = scaling_.inBox(row, 1, Fraction(row[p_]));
    const Fraction sum = scaling_.greatestInBox(row);
    Fraction difference = scaling_.roundingOf(row, 1);
    for (std::size_t j = 0; j <= p_; ++j) difference += abs(mapped[j] - region.law[i * (p_ + 1) + j]);
    law_error_ = std::max(law_error_, difference);
    greatest_change_ = std::max(greatest_change_, Fraction(sum - abs(mapped[p_])));
    if (input_sizes_.size() <= i) input_sizes_.push_back(sizeOf(i));
    const Fraction scale = std::min(std::max(Fraction(1), sum), input_sizes_[i]);
    greatest_scale_ = std::max(greatest_scale_, scale);
    require(difference <= law_tolerance_ * scale, "the map's law is not the exact one");
  }
}

}  // namespace checker
