#include "polyfly_base/decimal.hpp"

#include <algorithm>
#include <cctype>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>

namespace polyfly {
namespace {

/// The end of the digits that begin at a place.
std::size_t endOfDigits(const std::string& text, std::size_t begin) {
  return std::min(text.find_first_not_of("0123456789", begin), text.size());
}

std::size_t behindSign(const std::string& text, std::size_t begin) {
  return begin < text.size() && (text[begin] == '-' || text[begin] == '+') ? begin + 1 : begin;
}

double read(const char* text, double /*type*/) { return std::strtod(text, nullptr); }
float read(const char* text, float /*type*/) { return std::strtof(text, nullptr); }

/// digits * 10^exponent
struct Decimal {
  std::uint64_t digits = 0;
  int exponent = 0;
};

template <typename Number>
bool isRead(const Decimal& decimal, Number value) {
  const std::string text = std::to_string(decimal.digits) + "e" + std::to_string(decimal.exponent);
  return read(text.c_str(), value) == value;
}

/// The nearest number of so many digits. The decimal point of the locale is passed over.
Decimal rounded(double value, int count) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*e", count - 1, value);
  Decimal decimal;
  const char* place = text;
  for (; *place != 'e'; ++place) {
    if (std::isdigit(static_cast<unsigned char>(*place)) != 0)
      decimal.digits = 10 * decimal.digits + static_cast<std::uint64_t>(*place - '0');
  }
  decimal.exponent = std::atoi(place + 1) - (count - 1);
  return decimal;
}

/// Below a power of two numbers lie closer than above, so the nearest decimal may be read as a neighbour where the next
/// one is not.
template <typename Number>
Decimal shortest(Number value) {
  for (int count = 1;; ++count) {
    Decimal decimal = rounded(value, count);
    if (count == std::numeric_limits<Number>::max_digits10 || isRead(decimal, value)) return decimal;
    ++decimal.digits;
    if (isRead(decimal, value)) return decimal;
  }
}

std::string scientific(const std::string& digits, int exponent) {
  char power[16];
  std::snprintf(power, sizeof power, "e%+03d", exponent);
  return digits.substr(0, 1) + (digits.size() > 1 ? "." + digits.substr(1) : "") + power;
}

/// `point` of the digits stand before the point. All digits of a whole number are its own.
std::string fixed(const std::string& digits, int point, double value) {
  const int count = static_cast<int>(digits.size());
  if (point <= 0) return "0." + std::string(static_cast<std::size_t>(-point), '0') + digits;
  if (point < count) return digits.substr(0, point) + "." + digits.substr(point);
  char text[400];
  std::snprintf(text, sizeof text, "%.0f", value);
  return text;
}

template <typename Number>
std::string shortestTextOf(Number value) {
  const std::string sign = std::signbit(value) ? "-" : "";
  const Number size = std::abs(value);
  if (std::isnan(size)) return sign + "nan";
  if (std::isinf(size)) return sign + "inf";
  if (size == 0) return sign + "0";
  const Decimal decimal = shortest(size);
  const std::string digits = std::to_string(decimal.digits);
  const int point = static_cast<int>(digits.size()) + decimal.exponent;
  const std::string short_one = scientific(digits, point - 1);
  const std::string plain = fixed(digits, point, size);
  return sign + (plain.size() <= short_one.size() ? plain : short_one);
}

}  // namespace

bool isDecimal(const std::string& text) {
  const std::size_t whole = behindSign(text, 0);
  std::size_t end = endOfDigits(text, whole);
  std::size_t digits = end - whole;
  if (digits > 1 && text[whole] == '0') return false;
  if (end < text.size() && text[end] == '.') {
    const std::size_t point = end;
    end = endOfDigits(text, point + 1);
    digits += end - point - 1;
  }
  if (digits == 0) return false;
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    const std::size_t exponent = behindSign(text, end + 1);
    end = endOfDigits(text, exponent);
    if (end == exponent) return false;
  }
  return end == text.size();
}

std::optional<double> numberOf(const std::string& text) {
  // Whatever the locale of the program, the point is a point.
  static const locale_t classic = ::newlocale(LC_ALL_MASK, "C", nullptr);
  if (text.empty() || text.find_first_of("xX") != std::string::npos) return std::nullopt;
  if (std::isspace(static_cast<unsigned char>(text.front())) != 0) return std::nullopt;
  char* end = nullptr;
  const double value = ::strtod_l(text.c_str(), &end, classic);
  if (end != text.c_str() + text.size()) return std::nullopt;
  // Infinite without its name: beyond doubles.
  if (std::isinf(value) && text.find_first_of("nN") == std::string::npos) return std::nullopt;
  return value;
}

std::optional<double> decimalNumber(const std::string& text) {
  return isDecimal(text) ? numberOf(text) : std::nullopt;
}

std::string shortestText(double value) { return shortestTextOf(value); }
std::string shortestText(float value) { return shortestTextOf(value); }

}  // namespace polyfly
