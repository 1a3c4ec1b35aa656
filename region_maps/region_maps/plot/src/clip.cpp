#include "clip.hpp"

namespace polyfly {

Ring clip(const Ring& ring, double a, double b, double c) {
  Ring kept;
  kept.reserve(ring.size() + 1);
  for (std::size_t index = 0; index < ring.size(); ++index) {
    const auto& here = ring[index];
    const auto& next = ring[(index + 1) % ring.size()];
    const double excess_here = a * here.first + b * here.second - c;
    const double excess_next = a * next.first + b * next.second - c;
    if (excess_here <= 0.0) {
      kept.push_back(here);
    }
    if ((excess_here < 0.0 && excess_next > 0.0) || (excess_here > 0.0 && excess_next < 0.0)) {
      const double part = excess_here / (excess_here - excess_next);
      kept.emplace_back(here.first + part * (next.first - here.first),
                        here.second + part * (next.second - here.second));
    }
  }
  return kept;
}

double area(const Ring& ring) {
  double twice = 0.0;
  for (std::size_t index = 0; index < ring.size(); ++index) {
    const auto& here = ring[index];
    const auto& next = ring[(index + 1) % ring.size()];
    twice += here.first * next.second - next.first * here.second;
  }
  return 0.5 * twice;
}

}  // namespace polyfly
