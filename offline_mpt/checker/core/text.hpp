#pragma once

#include <gmpxx.h>

#include <cstddef>
#include <stdexcept>
#include <string>

/// Lines and words of certificates.
namespace checker {

/// The rule that a file breaks.
struct Refused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline void require(bool condition, const std::string& rule) {
  if (!condition) throw Refused(rule);
}

/// Whether a text is one number in decimal digits: an optional sign, digits of which no zero leads, an optional point and
/// an optional exponent. Readers of YAML, JSON and C disagree on anything else.
bool isDecimal(const std::string& text);

/// Words of one line, from the first to the last.
class Line {
 public:
  explicit Line(const std::string& text) : text_(text) {}
  std::string word();
  bool done();
  std::size_t count(std::size_t limit);    ///< whole, at most `limit`
  mpz_class integer();                     ///< base 16
  mpq_class fraction();                    ///< base 16, as numerator/denominator
  mpq_class real();                        ///< a double as printf's %a writes it, at its exact value
  bool next(const std::string& expected);  ///< takes the next word if it is this one
  std::string rest();                      ///< all words that are left
  void end() { require(done(), "a line is longer than its rule"); }

 private:
  std::string text_;
  /// Where the next word begins, or spaces before it.
  std::size_t at_ = 0;
};

}  // namespace checker
