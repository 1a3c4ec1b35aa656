#pragma once

#include <string>

#include "command.hpp"
#include "offline_mpt/verify_reduction.hpp"

namespace polyfly {

/// What `verify --reduced-from` was asked for.
struct VerifyReductionOptions {
  std::string map;
  std::string original;
  std::string json;         ///< file to write, empty: none
  std::string certificate;  ///< likewise
  int threads = 1;
  bool quiet = false;
};

/// Proves that a reduced map answers as the original, or refutes it. kDone when it is proven.
ExitCode verifyReducedMap(const VerifyReductionOptions& options);

/// verifyReduction with a progress line. With `certificate` the report has the proof.
ReductionReport proveReduction(const RegionMap& reduced, const RegionMap& original, int threads, bool quiet,
                               bool certificate);

}  // namespace polyfly
