#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace checker {
namespace {

/// The place behind the digits that begin at `at`.
std::size_t behindDigits(const std::string& text, std::size_t at) {
  return std::min(text.find_first_not_of("0123456789", at), text.size());
}

/// The place behind a sign that may stand at `at`.
std::size_t behindSign(const std::string& text, std::size_t at) {
  return at < text.size() && (text[at] == '-' || text[at] == '+') ? at + 1 : at;
}

}  // namespace

bool isDecimal(const std::string& text) {
  const std::size_t first = behindSign(text, 0);
  std::size_t at = behindDigits(text, first);
  std::size_t digits = at - first;
  if (digits > 1 && text[first] == '0') return false;
  if (at < text.size() && text[at] == '.') {
    const std::size_t point = at;
    at = behindDigits(text, point + 1);
    digits += at - point - 1;
  }
  if (digits == 0) return false;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    const std::size_t exponent = behindSign(text, at + 1);
    at = behindDigits(text, exponent);
    if (at == exponent) return false;
  }
  return at == text.size();
}

bool Line::done() {
  at_ = std::min(text_.find_first_not_of(" \t\r", at_), text_.size());
  return at_ == text_.size();
}

std::string Line::word() {
  require(!done(), "a line is shorter than its rule");
  const std::size_t first = at_;
  at_ = std::min(text_.find_first_of(" \t\r", first), text_.size());
  return text_.substr(first, at_ - first);
}

bool Line::next(const std::string& expected) {
  const std::size_t before = at_;
  if (!done() && word() == expected) return true;
  at_ = before;
  return false;
}

std::string Line::rest() { return done() ? "" : text_.substr(std::exchange(at_, text_.size())); }

std::size_t Line::count(std::size_t limit) {
  const std::string text = word();
  require(text.size() <= 18 && text.find_first_not_of("0123456789") == std::string::npos,
          text + " is no count");
  const std::size_t value = std::stoull(text);
  require(value <= limit, text + " is out of range");
  return value;
}

mpz_class Line::integer() {
  mpz_class value;
  const std::string text = word();
  require(text.find_first_not_of("-0123456789abcdef") == std::string::npos && value.set_str(text, 16) == 0,
          text + " is no whole number");
  return value;
}

mpq_class Line::fraction() {
  mpq_class value;
  const std::string text = word();
  require(text.find_first_not_of("-/0123456789abcdef") == std::string::npos && value.set_str(text, 16) == 0 &&
              value.get_den() > 0,
          text + " is no fraction");
  value.canonicalize();
  return value;
}

mpq_class Line::real() {
  const std::string text = word();
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  require(end == text.c_str() + text.size() && std::isfinite(value), text + " is no finite number");
  return mpq_class(value);
}

}  // namespace checker
