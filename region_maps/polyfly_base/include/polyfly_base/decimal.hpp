#pragma once

#include <optional>
#include <string>

namespace polyfly {

/// Whether the text is a number in decimal digits: perhaps a sign, a point and an exponent. No zero leads other digits,
/// because YAML readers disagree on 010. 0x8, .inf and .nan are none.
bool isDecimal(const std::string& text);

/// The number that a text of decimal digits states, or that `inf` or `nan` names, in small or large letters. Zeros may lead.
/// None where it is no such text, or beyond doubles.
std::optional<double> numberOf(const std::string& text);

/// The number that a decimal text states; none where it is no such text, or beyond doubles.
std::optional<double> decimalNumber(const std::string& text);

/// The shortest text that is read as exactly this number, with a point or an exponent only where needed; of equally short
/// ones the nearest, and rather without exponent. Independent of the locale.
std::string shortestText(double value);
std::string shortestText(float value);

/// The rule, as messages add it.
constexpr const char* kDecimalRule = " (decimal digits, without leading zeros)";

}  // namespace polyfly
