#pragma once

#include <cmath>

namespace polyfly {

/// An unevaluated sum of two doubles, |low| at most half an ulp of high: about 32 digits (Dekker, 1971). For
/// numbers between 1e-140 and 1e140 or so; zero is exact.
struct DoubleDouble {
  double high = 0.0;
  double low = 0.0;

  DoubleDouble() = default;
  DoubleDouble(double value) : high(value) {}  // NOLINT: every double is one
  DoubleDouble(double high_part, double low_part) : high(high_part), low(low_part) {}

  explicit operator double() const { return high; }
};

/// Relative rounding error of one operation, at most.
constexpr double kDoubleDoubleUnit = 0x1p-102;

/// a + b without loss; |a| >= |b|, or a = 0.
inline DoubleDouble orderedSum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

/// a + b without loss.
inline DoubleDouble exactSum(double a, double b) {
  const double sum = a + b;
  const double part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

/// a b without loss.
inline DoubleDouble exactProduct(double a, double b) {
  const double product = a * b;
#ifdef FP_FAST_FMA
  return {product, std::fma(a, b, -product)};
#else
  constexpr double kSplitter = 0x1.0p27 + 1.0;
  const double a_long = kSplitter * a, b_long = kSplitter * b;
  const double a_top = a_long - (a_long - a), b_top = b_long - (b_long - b);
  const double a_rest = a - a_top, b_rest = b - b_top;
  return {product, ((a_top * b_top - product) + a_top * b_rest + a_rest * b_top) + a_rest * b_rest};
#endif
}

inline DoubleDouble operator-(const DoubleDouble& a) { return {-a.high, -a.low}; }

inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble top = exactSum(a.high, b.high);
  const DoubleDouble rest = exactSum(a.low, b.low);
  const DoubleDouble sum = orderedSum(top.high, top.low + rest.high);
  return orderedSum(sum.high, sum.low + rest.low);
}

inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }

inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble top = exactProduct(a.high, b.high);
  return orderedSum(top.high, top.low + (a.high * b.low + a.low * b.high));
}

inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
  const double first = a.high / b.high;
  const DoubleDouble rest = a - first * b;
  const double second = rest.high / b.high;
  const double third = (rest - second * b).high / b.high;
  return orderedSum(first, second) + third;
}

/// a >= 0
inline DoubleDouble sqrt(const DoubleDouble& a) {
  if (a.high <= 0.0) return {};
  const double root = std::sqrt(a.high);
  const DoubleDouble rest = a - exactProduct(root, root);
  return orderedSum(root, rest.high / (2.0 * root));
}

inline DoubleDouble& operator+=(DoubleDouble& a, const DoubleDouble& b) { return a = a + b; }
inline DoubleDouble& operator-=(DoubleDouble& a, const DoubleDouble& b) { return a = a - b; }
inline DoubleDouble& operator*=(DoubleDouble& a, const DoubleDouble& b) { return a = a * b; }
inline DoubleDouble& operator/=(DoubleDouble& a, const DoubleDouble& b) { return a = a / b; }

inline bool operator==(const DoubleDouble& a, const DoubleDouble& b) {
  return a.high == b.high && a.low == b.low;
}
inline bool operator!=(const DoubleDouble& a, const DoubleDouble& b) { return !(a == b); }
inline bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
  return a.high < b.high || (a.high == b.high && a.low < b.low);
}
inline bool operator>(const DoubleDouble& a, const DoubleDouble& b) { return b < a; }
inline bool operator<=(const DoubleDouble& a, const DoubleDouble& b) {
  return a.high < b.high || (a.high == b.high && a.low <= b.low);
}
inline bool operator>=(const DoubleDouble& a, const DoubleDouble& b) { return b <= a; }

inline DoubleDouble abs(const DoubleDouble& a) { return a.high < 0.0 ? -a : a; }

}  // namespace polyfly
