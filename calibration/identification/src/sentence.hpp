#pragma once

#include <cstdio>
#include <string>

namespace polyfly {

/// A text of up to 399 characters with numbers in it, in the words of printf.
template <class... Values>
std::string sentence(const char* format, Values... values) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

}  // namespace polyfly
