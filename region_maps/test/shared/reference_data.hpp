#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

/// For the tests of all packages.
namespace polyfly {

/// A folder of the reference data, which are not part of the project: below POLYFLY_DATA, else beside the
/// project. Empty where it is absent; tests then say that they skip.
inline std::filesystem::path referenceData(const std::string& name) {
  std::filesystem::path folder;
  if (const char* data = std::getenv("POLYFLY_DATA")) {
    folder = std::filesystem::path(data) / name;
  } else if (const char* root = std::getenv("POLYFLY_ROOT")) {
    folder = std::filesystem::path(root) / ".." / "shared" / "data" / name;
  }
  return !folder.empty() && std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

}  // namespace polyfly
