#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace checker {

/// Numbers of the code, as they are written.
struct CodeNumbers {
  std::vector<std::string> texts;
  /// Numbers in each row of a table of two dimensions; 0: there is one dimension.
  std::size_t width = 0;
};

/// What the placeholders of an expected text stand for.
using CodeMatch = std::map<std::string, CodeNumbers>;

/// Requires that a C text has the tokens of an expected one, in which $NAME stands for a number, or for a table in braces.
/// Comments and spaces do not count. What could make a compiler see other tokens is refused: line splices, trigraphs, comments
/// in directives. Throws Refused.
CodeMatch matchCode(const std::string& text, const std::string& expected);

/// The text with the values in place of @key@, also within values. Each key must be known.
std::string filledIn(std::string text, const std::map<std::string, std::string>& values);

}  // namespace checker
