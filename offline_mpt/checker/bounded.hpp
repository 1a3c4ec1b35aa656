#pragma once

#include <cmath>

namespace checker {

/// A double that stands for a real number which differs from it by at most `error`.
struct Bounded {
  double value = 0.0;
  double error = 0.0;

  Bounded() = default;
  Bounded(double exact) : value(exact) {}  // NOLINT: as fractions are made of doubles
  Bounded(double number, double bound) : value(number), error(bound) {}
};

/// What an operation adds: its rounding, that of the bounds themselves, and numbers too small for doubles.
inline Bounded rounded(double value, double error) {
  constexpr double kUnit = 0x1.0p-53, kUp = 1.0 + 0x1.0p-50, kTiny = 0x1.0p-1000;
  return {value, (error + std::abs(value) * kUnit) * kUp + kTiny};
}

inline Bounded operator+(const Bounded& a, const Bounded& b) {
  return rounded(a.value + b.value, a.error + b.error);
}
inline Bounded operator-(const Bounded& a, const Bounded& b) {
  return rounded(a.value - b.value, a.error + b.error);
}
inline Bounded operator*(const Bounded& a, const Bounded& b) {
  return rounded(a.value * b.value,
                 std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error);
}
/// NaN or an infinite error where b may be zero.
inline Bounded operator/(const Bounded& a, const Bounded& b) {
  const double least = std::abs(b.value) - b.error;
  if (!(least > 0.0)) return {0.0, HUGE_VAL};
  const double quotient = a.value / b.value;
  return rounded(quotient, (a.error + std::abs(quotient) * b.error) * (1.0 + 0x1.0p-50) / least);
}

/// Certainly positive: false says nothing.
inline bool isPositive(const Bounded& a) { return a.value > a.error; }

}  // namespace checker
