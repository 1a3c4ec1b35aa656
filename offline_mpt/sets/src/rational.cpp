#include "polytope_sets/rational.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>

#include "polyfly_base/decimal.hpp"

namespace polyfly {
namespace {

constexpr long kMaxExponent = 400;  // beyond the range of a double
constexpr std::size_t kMaxDigits = 4000;

bool isWhole(const std::string& text) {
  return text.size() <= kMaxDigits && text.find_first_not_of("0123456789") == std::string::npos &&
         isDecimal(text);
}

// "12.5e-3" without its sign.
bool parseDecimal(const std::string& text, Rational& value) {
  if (!isDecimal(text) || text[0] == '-' || text[0] == '+') return false;
  const std::size_t e = text.find_first_of("eE");
  std::string mantissa = text.substr(0, e);
  long exponent = 0;
  if (e != std::string::npos) {
    std::string digits = text.substr(e + 1);
    const bool negative = !digits.empty() && digits[0] == '-';
    if (!digits.empty() && (digits[0] == '-' || digits[0] == '+')) digits.erase(0, 1);
    if (digits.size() > 4) return false;
    exponent = std::strtol(digits.c_str(), nullptr, 10);
    if (exponent > kMaxExponent) return false;
    if (negative) exponent = -exponent;
  }
  const std::size_t point = mantissa.find('.');
  if (point != std::string::npos) {
    exponent -= static_cast<long>(mantissa.size() - point - 1);
    mantissa.erase(point, 1);
  }
  if (mantissa.size() > kMaxDigits) return false;
  Integer power;
  mpz_ui_pow_ui(power.get_mpz_t(), 10, static_cast<unsigned long>(std::labs(exponent)));
  const Integer whole(mantissa, 10);
  value = exponent >= 0 ? Rational(whole * power) : Rational(whole, power);
  value.canonicalize();
  return true;
}

}  // namespace

RationalMatrix exactly(const Eigen::MatrixXd& matrix) { return matrix.cast<Rational>(); }

Eigen::MatrixXd toDoubles(const RationalMatrix& matrix) { return matrix.unaryExpr(&nearestDouble); }

Rational dot(const RationalVector& a, const RationalVector& b) {
  Rational sum;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] != 0 && b[i] != 0) sum += a[i] * b[i];
  }
  return sum;
}

RationalVector affine(const RationalMatrix& M, const RationalVector& x, const RationalVector& m) {
  RationalVector result(static_cast<std::size_t>(M.rows()));
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    Rational& sum = result[static_cast<std::size_t>(i)];
    if (!m.empty()) sum = m[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < M.cols(); ++j) {
      if (M(i, j) != 0) sum += M(i, j) * x[static_cast<std::size_t>(j)];
    }
  }
  return result;
}

RationalVector applyTransposed(const RationalMatrix& M, const RationalVector& a) {
  RationalVector result(static_cast<std::size_t>(M.cols()));
  for (Eigen::Index j = 0; j < M.cols(); ++j) {
    for (Eigen::Index i = 0; i < M.rows(); ++i) {
      if (M(i, j) != 0) result[static_cast<std::size_t>(j)] += M(i, j) * a[static_cast<std::size_t>(i)];
    }
  }
  return result;
}

double nearestDouble(const Rational& value) {
  const double toward_zero = value.get_d();  // GMP cuts off
  if (!std::isfinite(toward_zero)) return toward_zero;
  const double away = std::nextafter(toward_zero, sgn(value) < 0 ? -std::numeric_limits<double>::infinity()
                                                                 : std::numeric_limits<double>::infinity());
  if (!std::isfinite(away)) return toward_zero;
  const Rational below = abs(value - Rational(toward_zero)), above = abs(value - Rational(away));
  return above <= below && value != 0 ? away : toward_zero;
}

Rational nearestMultiple(const Rational& value, const Rational& step) {
  const Rational steps = value / step + Rational(1, 2);
  Integer whole;
  mpz_fdiv_q(whole.get_mpz_t(), steps.get_num_mpz_t(), steps.get_den_mpz_t());
  return whole * step;
}

bool parseRational(const std::string& text, Rational& value) {
  std::string rest = text;
  const bool negative = !rest.empty() && rest[0] == '-';
  if (!rest.empty() && (rest[0] == '-' || rest[0] == '+')) rest.erase(0, 1);
  const std::size_t slash = rest.find('/');
  if (slash == std::string::npos) {
    if (!parseDecimal(rest, value)) return false;
  } else {
    const std::string above = rest.substr(0, slash), below = rest.substr(slash + 1);
    if (!isWhole(above) || !isWhole(below)) return false;
    const Integer denominator(below, 10);
    if (denominator == 0) return false;
    value = Rational(Integer(above, 10), denominator);
    value.canonicalize();
  }
  if (negative) value = -value;
  return true;
}

}  // namespace polyfly
