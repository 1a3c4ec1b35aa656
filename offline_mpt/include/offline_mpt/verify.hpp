#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

class RegionMap;

struct VerifyOptions {
  std::uint64_t samples = 10'000;  ///< parameters to try
  std::uint64_t seed = 1;
  int threads = 1;          ///< 1..256; the report does not depend on it
  double tolerance = 1e-7;  ///< greatest VerifyReport::max_scaled_error
  /// A parameter nearer to the edge of the feasible set may go either way [scaled].
  double edge_tolerance = 1e-7;
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to end early
  /// Called now and then from the calling thread.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
};

/// Samples that break one rule.
struct Finding {
  std::uint64_t count = 0;
  /// Greatest violation, in the measure of the rule.
  double worst = 0.0;
  /// Parameter of the greatest violation. Empty if count is 0.
  Eigen::VectorXd example;
};

/// Result of `verify`. "[scaled]" means in units of half a parameter's range.
struct VerifyReport {
  std::uint64_t seed = 0;
  double tolerance = 0.0;
  double edge_tolerance = 0.0;
  std::uint64_t requested = 0;
  /// Samples that were tried.
  std::uint64_t samples = 0;
  /// Samples drawn uniformly in the box. The others are near faces, edges, vertices and centres.
  std::uint64_t uniform = 0;
  /// Samples that the map answers.
  std::uint64_t inside = 0;
  /// Samples that were compared with the program.
  std::uint64_t compared = 0;
  /// Samples at which the program has no solution.
  std::uint64_t infeasible = 0;
  /// Map and program differ, but within edge_tolerance of the feasible set's edge.
  std::uint64_t borderline = 0;
  /// Greatest error of u [unit of u].
  double max_error = 0.0;
  /// Greatest error as a share of the input's range; without one, of the greatest |u| of samples.
  double max_scaled_error = 0.0;
  Eigen::VectorXd max_error_theta;
  std::uint32_t max_error_region = 0;

  /// The scaled error is above the tolerance.
  Finding errors;
  /// The sample is feasible, but the map has no region.
  Finding missed;
  /// The sample is infeasible, but the map answers. Worst: distance to the feasible set [scaled].
  Finding false_inside;
  /// Would be an error or false inside, but is right at the nearest parameter of the region that answers: no fault. Look-ups
  /// answer so far beyond a region. Worst: scaled error, or distance to the feasible set.
  Finding beyond;
  /// Two regions hold the sample and differ in u. Worst: scaled difference.
  Finding overlaps;
  /// The tree and the test of all regions disagree.
  Finding tree_errors;
  /// The program has solutions at the sample, but its cost is unbounded below.
  Finding unbounded;
  /// The optimum could not be found.
  Finding undecided;
  /// Visited regions without a point inside. Worst: by how much [scaled].
  Finding empty_regions;

  std::uint64_t regions = 0;
  std::uint64_t regions_hit = 0;
  /// Solver status that is written in the map.
  std::string map_status;
  bool interrupted = false;

  /// Every sample was tried and decided, none breaks a rule, and the map says that it is complete.
  bool passed() const;
};

/// Compares a map with the optima of its program at random parameters, by the arithmetic of `solve`'s own check: half uniform
/// in the box, half at degenerate places. With H = 0 the optimum may not be unique; the nearest one counts. Deterministic in
/// (map, program, samples, seed). Throws Error when map and program do not have the same signals, or H is neither zero nor
/// positive definite where the equalities leave z free.
VerifyReport verify(const RegionMap& map, const ParametricProgram& program,
                    const VerifyOptions& options = {});

/// The report for people, several lines.
std::string verifyText(const VerifyReport& report);
std::string verifyJson(const VerifyReport& report);

}  // namespace polyfly
