#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "reference_data.hpp"

namespace polyfly {

/// Folder of the reference problems, or an empty path where they are absent.
inline std::filesystem::path referenceProblems() { return referenceData("mp_problems"); }

inline nlohmann::json readJson(const std::filesystem::path& path) {
  std::ifstream file(path);
  return nlohmann::json::parse(file);
}

}  // namespace polyfly
