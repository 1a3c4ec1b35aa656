#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace polyfly {

/// A text of up to 399 characters with numbers in it, in the words of printf.
template <class... Values>
std::string sentence(const char* format, Values... values) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

/// The words one after the other.
template <class Words>
std::string listOf(const Words& words, const char* between = ", ") {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : between) + word;
  return list;
}

}  // namespace polyfly
