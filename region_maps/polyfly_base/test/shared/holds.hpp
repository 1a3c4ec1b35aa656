#pragma once

#include <gtest/gtest.h>

#include <string>

/// For the tests of all packages.
namespace polyfly {

/// Whether a text holds a part; a test that fails shows both.
inline testing::AssertionResult holds(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "no '" << part << "' in: " << text;
}

}  // namespace polyfly
