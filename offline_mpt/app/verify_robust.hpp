#pragma once

#include <cstdint>
#include <string>

#include "command.hpp"

namespace polyfly {

class RegionMap;

/// What `verify` was asked for, of a map of a problem of type robust_mpc.
struct VerifyRobustOptions {
  std::string problem;  ///< empty: the one that the map carries
  std::string json;     ///< file to write, empty: none
  bool exact = false;
  std::uint64_t samples = 0;
  std::uint64_t seed = 0;
  double tolerance = 0.0;
  int threads = 1;
  bool quiet = false;
};

bool isRobustMap(const RegionMap& map);

/// Proves the map in fractions, or compares it with linear programs at samples.
ExitCode verifyRobust(const RegionMap& map, const VerifyRobustOptions& options);

}  // namespace polyfly
