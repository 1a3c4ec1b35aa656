#pragma once

#include <limits>
#include <vector>

#include "arithmetic/exact_matrix.hpp"

namespace polyfly {

/// More than any power of two that include() finds.
constexpr long kNoBit = std::numeric_limits<long>::max();

/// Lowers `least` to the power of two in a number that is a whole multiple of it, and of no greater one; zero
/// has none.
void include(long& least, const Rational& value);

/// The least double that is not below `value`; infinity where all are.
double above(const Rational& value);

/// value * 2^exponent, which must be whole.
Integer scaled(const Rational& value, long exponent);

/// value * 2^exponent
Rational timesPowerOfTwo(Rational value, long exponent);

/// The least whole number > 0 by which all values become whole.
Integer commonDenominator(const std::vector<Rational>& values);

/// Rows by powers of two: each has no fraction, and its numbers no common factor two.
IntegerMatrix wholeRows(const std::vector<Rational>& values, int columns);

}  // namespace polyfly
