#pragma once

#include <cstdint>
#include <vector>

#include "lookup_tables.hpp"

namespace checker {

/// Scales of code of 16-bit integers: an integer n with the exponent e stands for n * 2^-e.
struct IntegerScales {
  /// Of each parameter and of each input.
  std::vector<int> theta, u;
  /// Of distances and of the tolerance.
  int plane = 0;
  /// Factors of the constants of planes and of laws.
  double plane_unit = 0.0, law_unit = 0.0;
  /// Inputs are limited to this size.
  double greatest_input = 0.0;
  /// Each row's sum is divided by 2 to this power and rounded to the nearest.
  std::vector<std::uint32_t> law_shift;
};

/// Turns integers into the numbers that they stand for, and fills in the bounds of rounding. Throws Refused where a
/// number is no 16-bit integer, a sum may exceed 32 bits for a parameter of the box, or a scale is not as the code needs it.
void scaleIntegers(const IntegerScales& scales, LookupTables& tables);

}  // namespace checker
