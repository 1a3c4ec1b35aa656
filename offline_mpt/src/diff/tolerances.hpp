#pragma once

/// Tolerances of the comparison of maps.
namespace polyfly::tolerance {

/// Upper bound of the rounding of a unit row and of sums with it [weight of the row].
constexpr double kRoundingOfRow = 1e-12;

}  // namespace polyfly::tolerance
