#pragma once

#include <string>

#include "command.hpp"

namespace polyfly {

/// What `verify --exact` was asked for.
struct VerifyExactOptions {
  std::string map;
  std::string problem;      ///< empty: the one that the map carries
  std::string certificate;  ///< file to write, empty: none
  std::string json;         ///< file to write, empty: none
  std::string output;       ///< of the repaired map; empty: no repair
  int threads = 1;
  bool quiet = false;
  double time_limit = 0.0;  ///< [s], 0: none
};

/// Proves the map in rational arithmetic, or refutes it; with `output`, repairs it, writes the new map and
/// proves that one. kDone when what was asked for is proven.
ExitCode verifyExact(const VerifyExactOptions& options);

}  // namespace polyfly
