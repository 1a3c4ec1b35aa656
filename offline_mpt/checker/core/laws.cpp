// Statement 3: the laws of the map are the exact ones.
#include <algorithm>

#include "core/certificate.hpp"

namespace checker {

/// The difference counts the rounding of u. Sum is the greatest |u| of the map's law in the box.
void Certificate::checkLaw(std::size_t index, const Region& region) const {
  for (std::size_t i = 0; i < q_; ++i) {
    const double* row = map_.laws.data() + (map_.regions[index].law * q_ + i) * (p_ + 1);
    const Vector mapped = scaling_.inBox(row, 1, Fraction(row[p_]));
    Fraction difference = scaling_.roundingOf(row, 1), sum;
    for (std::size_t j = 0; j <= p_; ++j) {
      difference += abs(mapped[j] - region.law[i * (p_ + 1) + j]);
      sum += abs(mapped[j]);
    }
    law_error_ = std::max(law_error_, difference);
    greatest_u_ = std::max(greatest_u_, sum);
    greatest_change_ = std::max(greatest_change_, Fraction(sum - abs(mapped[p_])));
    require(difference <= law_tolerance_ * std::max(Fraction(1), sum), "the map's law is not the exact one");
  }
}

}  // namespace checker
