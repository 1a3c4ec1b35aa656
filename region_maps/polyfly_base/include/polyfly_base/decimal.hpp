#pragma once

#include <optional>
#include <string>

namespace polyfly {

/// Whether the text is a number in decimal digits: perhaps a sign, a point and an exponent. No zero leads other digits,
/// because YAML readers disagree on 010. 0x8, .inf and .nan are none.
bool isDecimal(const std::string& text);

/// The number that a decimal text states; none where it is no such text, or beyond doubles.
std::optional<double> decimalNumber(const std::string& text);

/// The rule, as messages add it.
constexpr const char* kDecimalRule = " (decimal digits, without leading zeros)";

}  // namespace polyfly
