#pragma once

#include <utility>
#include <vector>

namespace polyfly {

using Ring = std::vector<std::pair<double, double>>;

/// The part of a convex polygon where a x + b y <= c (Sutherland and Hodgman, one half-space). Empty if none
/// is left.
Ring clip(const Ring& ring, double a, double b, double c);

/// Signed area; positive when counter-clockwise.
double area(const Ring& ring);

}  // namespace polyfly
