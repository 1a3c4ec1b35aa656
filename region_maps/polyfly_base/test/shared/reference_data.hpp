#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "project_root.hpp"

/// For the tests of all packages.
namespace polyfly {

/// A file or folder of the reference data, which are not part of the project: below POLYFLY_DATA, else beside
/// the project. Empty where it is absent; tests then say that they skip.
inline std::filesystem::path referenceData(const std::string& name) {
  const char* data = std::getenv("POLYFLY_DATA");
  const std::filesystem::path path =
      (data != nullptr ? std::filesystem::path(data)
                       : std::filesystem::path(projectRoot()) / "../shared/data") /
      name;
  return std::filesystem::exists(path) ? path : std::filesystem::path();
}

}  // namespace polyfly
