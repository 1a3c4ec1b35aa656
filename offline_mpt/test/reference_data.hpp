#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace polyfly {

/// Folder of the reference problems, or an empty path where they are absent.
inline std::filesystem::path referenceProblems() {
  std::filesystem::path folder;
  if (const char* data = std::getenv("POLYFLY_DATA")) {
    folder = std::filesystem::path(data) / "mp_problems";
  } else if (const char* root = std::getenv("POLYFLY_ROOT")) {
    folder = std::filesystem::path(root) / ".." / "shared" / "data" / "mp_problems";
  }
  return !folder.empty() && std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

inline nlohmann::json readJson(const std::filesystem::path& path) {
  std::ifstream file(path);
  return nlohmann::json::parse(file);
}

}  // namespace polyfly
