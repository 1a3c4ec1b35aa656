#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/partition.hpp"

namespace polyfly {

struct ExploreProgress {
  std::uint64_t regions = 0;  ///< finished
  std::uint64_t open = 0;     ///< found, not yet described
};

struct ExploreOptions {
  int threads = 1;  ///< worker threads, at most the machine's; the result does not depend on it
  std::uint64_t region_limit = 10'000'000;  ///< stop after so many regions
  double time_limit = 0.0;                  ///< [s], 0: none
  double facet_tolerance = 1e-9;  ///< least violation that makes a half-space count as a facet [scaled]
  double radius_tolerance =
      1e-10;  ///< regions with a smaller inscribed ball are left to their neighbours [scaled]
  const std::atomic<bool>* stop = nullptr;               ///< set from outside to interrupt
  std::function<void(const ExploreProgress&)> progress;  ///< called now and then from the calling thread
};

/// Partitions the parameter set of a convex program into critical regions.
///
/// H positive definite: the law is unique and continuous. H = 0: of several optima the shortest z is taken,
/// which is unique and, where the cost does not depend on theta, continuous. H singular otherwise: 1e-8 of
/// its mean eigenvalue is added to it, so that z is close to the shortest optimum. Rows may repeat, depend on
/// each other or hold with equality everywhere. Throws Error when H is indefinite, the parameter set is
/// unbounded, or the parameters that admit a solution form a lower-dimensional set.
Partition explore(const ParametricProgram& program, const ExploreOptions& options = {});

}  // namespace polyfly
