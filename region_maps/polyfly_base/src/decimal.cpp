#include "polyfly_base/decimal.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

namespace polyfly {
namespace {

/// The end of the digits that begin at a place.
std::size_t endOfDigits(const std::string& text, std::size_t begin) {
  return std::min(text.find_first_not_of("0123456789", begin), text.size());
}

std::size_t behindSign(const std::string& text, std::size_t begin) {
  return begin < text.size() && (text[begin] == '-' || text[begin] == '+') ? begin + 1 : begin;
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

std::optional<double> decimalNumber(const std::string& text) {
  if (!isDecimal(text)) return std::nullopt;
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double value = 0.0;
  stream >> value;
  if (stream.fail() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace polyfly
