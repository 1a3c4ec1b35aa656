#pragma once

#include <stdexcept>
#include <string>

/// The files that the checkers read.
namespace checker {

/// A file that cannot be read, which says nothing about what it holds.
struct Unreadable : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws Unreadable where there is no file that can be read whole.
std::string readFile(const std::string& path);

/// Throws Unreadable where `path` is neither a file nor a pipe.
void requireFile(const std::string& path);

}  // namespace checker
