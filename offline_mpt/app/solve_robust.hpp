#pragma once

#include <cstdint>
#include <string>

#include "command.hpp"
#include "offline_mpt/search_tree.hpp"

namespace polyfly {

/// What `solve` was asked for, of a problem of type robust_mpc.
struct SolveRobustOptions {
  std::string problem;
  std::string map;
  std::string stats;        ///< file to write, empty: none
  double time_limit = 0.0;  ///< [s], of all phases; 0: none
  TreeMode tree_mode = TreeMode::kAuto;
  std::uint64_t tree_nodes = 0;
  int threads = 1;
  bool quiet = false;
};

/// Whether a problem file is of type robust_mpc; false for .json. Throws Error.
bool isRobustFile(const std::string& path);

ExitCode solveRobust(const SolveRobustOptions& options);

}  // namespace polyfly
