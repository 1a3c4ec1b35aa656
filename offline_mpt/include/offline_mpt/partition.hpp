#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// How an exploration ended.
enum class ExploreStatus {
  kComplete,     ///< every facet of every region leads to a region or to the edge of the feasible set
  kIncomplete,   ///< a gap was left: `witness` is a parameter that no region holds
  kLimited,      ///< a limit on regions, time or memory was reached
  kInterrupted,  ///< stopped from outside
  kInfeasible,   ///< no parameter in the box admits a solution
  kUnbounded,    ///< complete where the optimum is finite; not so at `unbounded_at`
};

const char* toString(ExploreStatus status);

/// Set of parameters for which one active set is optimal, with its law. Half-spaces are in the program's own
/// parameters: G theta <= g, minimal. Each row is scaled so that G theta - g is a distance when every parameter's
/// range is mapped to [-1, 1].
struct CriticalRegion {
  std::vector<int> active;  ///< sorted row indices of the program
  Eigen::MatrixXd G;        ///< rows x p
  Eigen::VectorXd g;        ///< rows
  Eigen::MatrixXd K;        ///< q x p
  Eigen::VectorXd k;        ///< q, u = K theta + k
  Eigen::VectorXd centre;   ///< p, an interior parameter (Chebyshev centre in scaled parameters)
  double radius = 0.0;      ///< Chebyshev radius [scaled]
};

struct ExploreStats {
  std::uint64_t regions = 0;
  /// Active sets that were processed.
  std::uint64_t candidate_sets = 0;
  std::uint64_t degenerate_facets = 0;
  std::uint64_t lp_pivots = 0;
  /// Active sets found, but not processed, since the exploration was stopped.
  std::uint64_t open_sets = 0;
  /// Number of `regions` that come from a checkpoint.
  std::uint64_t resumed_regions = 0;
  /// Greatest accounted memory, see ExploreOptions::memory_limit.
  std::uint64_t memory_bytes = 0;  ///< [bytes]
  /// The checkpoint of an exploration that reached its end could not be written.
  bool unsaved = false;
  /// Number of a lost process of the group. 0: none.
  int lost_process = 0;
};

/// The solution of a parametric program. Regions are sorted by active set.
struct Partition {
  ExploreStatus status = ExploreStatus::kInfeasible;
  std::vector<CriticalRegion> regions;
  Eigen::VectorXd witness;  ///< p, with kIncomplete
  /// p, with kUnbounded, and with any other status where it is known: a parameter that has solutions, but
  /// whose cost falls without end. An exploration that was stopped asks at its start and at some corners of
  /// the box alone: empty, it promises nothing.
  Eigen::VectorXd unbounded_at;
  /// Rows of the program that nearly repeat another one: unit rows differ by less than 1e-5. Regions between them may
  /// be very thin.
  std::vector<int> near_rows;
  ExploreStats stats;
};

}  // namespace polyfly
