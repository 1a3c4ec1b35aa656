#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/explore.hpp"
#include "offline_mpt/partition.hpp"

namespace polyfly {

/// What is known of a map that was not made.
struct MapCount {
  /// Active sets that are critical regions with an interior, each counted once.
  std::uint64_t proven = 0;
  /// Active rows of all proven sets together.
  std::uint64_t active_rows = 0;
  /// Regions whose laws are proven to be stored separately.
  std::uint64_t laws = 0;
};

/// Bytes that a map of such regions takes at the least, see COUNT.md. `program` gives its sizes.
std::uint64_t leastMapBytes(const ParametricProgram& program, const MapCount& count);

struct CountOptions {
  int threads = 1;  ///< worker threads, at most the machine's; the result does not depend on it
  std::uint64_t region_limit = 0;  ///< stop when so many sets are proven, 0: none
  double time_limit = 0.0;         ///< [s], 0: none
  std::uint64_t memory_limit = 0;  ///< [bytes] that counting takes, 0: none
  std::uint64_t map_limit = 0;     ///< [bytes] stop when the map is proven to take more, 0: none
  std::string proof;               ///< file of all proven sets with witnesses (COUNT.md), empty: none
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to interrupt
  /// Called now and then from the calling thread; its regions are those proven.
  std::function<void(const ExploreProgress&)> progress;
};

struct CountResult {
  /// kComplete: all regions were found; kLimited, kInterrupted: counts are lower bounds; kIncomplete: a gap
  /// was left, as explore tells.
  ExploreStatus status = ExploreStatus::kInfeasible;
  MapCount count;
  /// Regions that explore would have, of the described sets.
  std::uint64_t regions = 0;
  /// Number of `regions` that are not proven: degenerate, or too thin.
  std::uint64_t unproven = 0;
  /// Facets of `regions`.
  std::uint64_t facets = 0;
  /// Active sets that were described.
  std::uint64_t described = 0;
  /// Active sets found, but not described. Some of them are proven.
  std::uint64_t open = 0;
  /// Proven sets of which the solver makes no region.
  std::uint64_t contradicted = 0;
  /// Least size of the map.
  std::uint64_t map_bytes = 0;  ///< [bytes]
  /// Greatest memory that counting took.
  std::uint64_t memory_bytes = 0;  ///< [bytes]
  double cpu_seconds = 0.0;
  Eigen::VectorXd witness;  ///< p, with kIncomplete
};

/// Explores as `explore` does, but stores only the active sets, some tens of bytes each. A set is counted once a
/// parameter with strict complementarity is found for it. The search looks on the ray across the facet that led to
/// it, else at its Chebyshev centre.
///
/// The counting order is the processing order. So results, proofs and the set at which a limit stops do not
/// depend on threads. Throws Error as explore does, when H is not positive definite, and when the proof cannot
/// be written.
CountResult countRegions(const ParametricProgram& program, const CountOptions& options = {});

}  // namespace polyfly
