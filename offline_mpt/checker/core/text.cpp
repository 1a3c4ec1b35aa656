#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace checker {

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
