#include "tree/plane_sides.hpp"

namespace polyfly {
namespace {

/// The sum of term(kFirst) .. term(kEnd - 1) by halves: the additions do not wait for one another.
template <std::size_t kFirst, std::size_t kEnd, class Term>
double sumOf(const Term& term) {
  if constexpr (kEnd - kFirst > 1) {
    constexpr std::size_t kMiddle = (kFirst + kEnd + 1) / 2;
    return sumOf<kFirst, kMiddle>(term) + sumOf<kMiddle, kEnd>(term);
  } else {
    return term(kFirst);
  }
}

/// kP parameters; 0: any number.
template <std::size_t kP>
struct Kernels {
  template <class Term>
  static double sum(std::size_t p, const Term& term) {
    if constexpr (kP != 0) {
      return sumOf<0, kP>(term);
    } else {
      double total = 0.0;
      for (std::size_t j = 0; j < p; ++j) total += term(j);
      return total;
    }
  }

  static double distance(const double* plane, const double* point, std::size_t p) {
    return sum(p, [&](std::size_t j) { return plane[j] * point[j]; }) - plane[kP != 0 ? kP : p];
  }

  static unsigned ofPoints(const double* plane, const double* points, std::size_t count, double tolerance,
                           unsigned possible, unsigned sides, std::size_t p) {
    const std::size_t n = kP != 0 ? kP : p;
    for (std::size_t i = 0; i < count && sides != possible; ++i) {
      const double value = distance(plane, points + i * n, p);
      sides |= (value < -tolerance ? kBelow : 0u) | (value > tolerance ? kAbove : 0u);
    }
    return sides;
  }

  static PlaneSides all() { return {distance, ofPoints}; }
};

}  // namespace

PlaneSides planeSidesFor(std::size_t p) {
  switch (p) {
    case 1:
      return Kernels<1>::all();
    case 2:
      return Kernels<2>::all();
    case 3:
      return Kernels<3>::all();
    case 4:
      return Kernels<4>::all();
    case 5:
      return Kernels<5>::all();
    case 6:
      return Kernels<6>::all();
    case 7:
      return Kernels<7>::all();
    case 8:
      return Kernels<8>::all();
    default:
      return Kernels<0>::all();
  }
}

PlaneBlock::PlaneBlock(const std::vector<double>& planes, const std::vector<std::size_t>& chosen,
                       std::size_t p)
    : p_(p),
      padded_(padded(chosen.size())),
      coefficients_((p + 1) * padded_, 0.0),
      below_(padded_),
      above_(padded_) {
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    for (std::size_t j = 0; j <= p; ++j) coefficients_[j * padded_ + i] = planes[chosen[i] * (p + 1) + j];
  }
}

void PlaneBlock::weigh(const double* point, PointList others, double tolerance, double weight) {
  weighSides(coefficients_.data(), padded_, p_, point, others, tolerance, weight, below_.data(),
             above_.data());
}

}  // namespace polyfly
