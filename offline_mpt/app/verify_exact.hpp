#pragma once

#include <string>

#include "command.hpp"

namespace polyfly {

/// What `verify --exact` was asked for.
struct VerifyExactOptions {
  std::string map;
  /// Problem file. Empty: the problem that the map carries.
  std::string problem;
  /// Certificate file to write. Empty: none.
  std::string certificate;
  /// JSON file to write. Empty: none.
  std::string json;
  /// File of the repaired map. Empty: no repair.
  std::string output;
  int threads = 1;
  bool quiet = false;
  double time_limit = 0.0;  ///< [s], 0: none
};

/// Proves the map in rational arithmetic, or refutes it; with `output`, repairs it, writes the new map and
/// proves that one. kDone when what was asked for is proven. The processes of an MPI launcher prove together.
ExitCode verifyExact(const VerifyExactOptions& options);

}  // namespace polyfly
