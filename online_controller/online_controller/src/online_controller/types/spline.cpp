#include "online_controller/types/spline.hpp"

#include <cstddef>

namespace polyfly {
namespace {

double width(const std::vector<Knot>& knots, std::size_t i) { return knots[i + 1].time - knots[i].time; }

Eigen::Vector4d chord(const std::vector<Knot>& knots, std::size_t i) {
  return (knots[i + 1].value - knots[i].value) / width(knots, i);
}

/// Thomas' algorithm: row i is before m[i-1] + at m[i] + after m[i+1] = right side, kept as m[i] + after_[i]
/// m[i+1].
void solveSlopes(std::vector<Knot>& knots, bool first_given, bool last_given) {
  const std::size_t last = knots.size() - 1;
  std::vector<double> after(knots.size(), 0.0);
  if (!first_given) {
    after[0] = 1.0;
    knots[0].slope = 2.0 * chord(knots, 0);
  }
  for (std::size_t i = 1; i < last; ++i) {
    const double left = 1.0 / width(knots, i - 1);
    const double right = 1.0 / width(knots, i);
    const Eigen::Vector4d side = 3.0 * (left * chord(knots, i - 1) + right * chord(knots, i));
    const double pivot = 2.0 * (left + right) - left * after[i - 1];
    knots[i].slope = (side - left * knots[i - 1].slope) / pivot;
    after[i] = right / pivot;
  }
  if (!last_given)
    knots[last].slope = (2.0 * chord(knots, last - 1) - knots[last - 1].slope) / (1.0 - after[last - 1]);
  for (std::size_t i = last; i-- > 0;) knots[i].slope -= after[i] * knots[i + 1].slope;
}

}  // namespace

void fitSpline(std::vector<Knot>& knots, bool first_given, bool last_given) {
  const std::size_t last = knots.size() - 1;
  if (last == 1 && !first_given && !last_given) {
    knots[0].slope = knots[1].slope = chord(knots, 0);  // a line
  } else {
    solveSlopes(knots, first_given, last_given);
  }
  for (std::size_t i = 0; i < last; ++i) {
    knots[i].curvature =
        (6.0 * chord(knots, i) - 4.0 * knots[i].slope - 2.0 * knots[i + 1].slope) / width(knots, i);
  }
  knots[last].curvature =
      (2.0 * knots[last - 1].slope + 4.0 * knots[last].slope - 6.0 * chord(knots, last - 1)) /
      width(knots, last - 1);
}

}  // namespace polyfly
