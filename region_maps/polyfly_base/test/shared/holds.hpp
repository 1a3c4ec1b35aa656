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

/// The text with a part of it replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  EXPECT_TRUE(holds(text, from));
  const std::size_t at = text.find(from);
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

}  // namespace polyfly
