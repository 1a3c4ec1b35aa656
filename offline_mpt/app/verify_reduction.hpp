#pragma once

#include <cstdint>
#include <string>

#include "command.hpp"
#include "offline_mpt/verify_reduction.hpp"
#include "progress.hpp"

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

/// Shows how far the proof of a reduction is, with `done` of `total` regions of both maps.
void showProof(Progress& progress, std::uint64_t done, std::uint64_t total);

}  // namespace polyfly
