#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

/// For the tests of all packages.
namespace polyfly {

/// The project's folder: POLYFLY_ROOT, which ctest sets, else, for a test that is run by hand, the one above
/// the program that holds the packages. Throws std::runtime_error that says what to set.
inline std::string projectRoot() {
  if (const char* root = std::getenv("POLYFLY_ROOT")) return root;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  for (auto folder = program.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    if (std::filesystem::exists(folder / "region_maps" / "FORMAT.md")) return folder;
  }
  throw std::runtime_error("set POLYFLY_ROOT to the project's folder: " + program.string() +
                           " does not lie below it");
}

/// A file or folder of region_maps/problems.
inline std::string problemFile(const std::string& name) {
  return projectRoot() + "/region_maps/problems/" + name;
}

}  // namespace polyfly
