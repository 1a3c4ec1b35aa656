#pragma once

#include <stdexcept>
#include <string>

#include "core/text.hpp"

/// The files that the checkers read.
namespace checker {

/// A file that cannot be read, which says nothing about what it holds.
struct Unreadable : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws Unreadable where there is no file that can be read whole.
std::string readFile(const std::string& path);

/// What a file breaks that is not the one to check: the message names it.
struct RefusedFile : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Hands what the file holds to `use`. What that refuses is said of this file.
template <class Use>
auto withFile(const std::string& path, const Use& use) {
  const std::string content = readFile(path);
  try {
    return use(content);
  } catch (const Refused& error) {
    throw RefusedFile(path + ": refused: " + error.what());
  }
}

/// Throws Unreadable where `path` is neither a file nor a pipe.
void requireFile(const std::string& path);

}  // namespace checker
