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
  double tolerance = 1e-7;  ///< greatest error of u, relative to max(1, |u|), or of the objective likewise
  /// A parameter nearer to the edge of the feasible set may go either way [scaled].
  double edge_tolerance = 1e-7;
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to end early
  /// Called now and then from the calling thread.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
};

/// What is compared where map and program both have an answer.
enum class VerifyMode {
  kOutput,     ///< u itself: the minimiser is unique
  kObjective,  ///< the best objective that u admits: the program is only convex, so u need not be unique
};

/// Samples that break one rule.
struct Finding {
  std::uint64_t count = 0;
  double worst = 0.0;       ///< in the measure of the rule
  Eigen::VectorXd example;  ///< parameter of the worst, empty if count is 0
};

/// Result of `verify`. "[scaled]" means in units of half a parameter's range.
struct VerifyReport {
  VerifyMode mode = VerifyMode::kOutput;
  std::uint64_t seed = 0;
  double tolerance = 0.0;
  double edge_tolerance = 0.0;
  std::uint64_t requested = 0;
  std::uint64_t samples = 0;  ///< tried
  /// Of them uniform in the box; the others near faces, edges, vertices and centres.
  std::uint64_t uniform = 0;
  std::uint64_t inside = 0;    ///< of them the map answers
  std::uint64_t compared = 0;  ///< of them compared with the program
  /// Of `compared`: oracle and map differed by more than the tolerance, and the region's active set met the
  /// conditions of optimality in rational arithmetic, so that its solution took the oracle's place.
  std::uint64_t settled = 0;
  std::uint64_t infeasible = 0;  ///< the program has no solution there
  /// Map and program differ, but within edge_tolerance of the feasible set's edge.
  std::uint64_t borderline = 0;
  double max_error = 0.0;         ///< of u [unit of u] or of the objective
  double max_scaled_error = 0.0;  ///< divided by max(1, |u|) or max(1, |objective|)
  Eigen::VectorXd max_error_theta;

  Finding errors;        ///< scaled error above the tolerance
  Finding missed;        ///< feasible, but the map has no region
  Finding false_inside;  ///< infeasible, but the map answers; worst: distance to the feasible set [scaled]
  Finding overlaps;      ///< regions that both hold the sample and differ in u; worst: scaled difference
  Finding tree_errors;   ///< the tree and the test of all regions disagree
  Finding unbounded;     ///< the program has solutions there, but its cost is unbounded below
  Finding undecided;     ///< the oracle was not accurate enough
  /// Regions without a point inside, among those visited; worst: by how much [scaled].
  Finding empty_regions;

  std::uint64_t regions = 0;
  std::uint64_t regions_hit = 0;
  double oracle_residual = 0.0;  ///< greatest scaled KKT residual of the oracle where it decided
  int oracle_iterations = 0;     ///< greatest
  std::string map_status;        ///< solver status written in the map
  bool interrupted = false;

  /// Every sample was tried and decided, none breaks a rule, and the map says that it is complete.
  bool passed() const;
};

/// Compares a map with direct solutions of its program at random parameters: half uniform in the box, half at
/// degenerate places. Deterministic in (map, program, samples, seed). Throws Error when map and program do
/// not have the same signals.
VerifyReport verify(const RegionMap& map, const ParametricProgram& program,
                    const VerifyOptions& options = {});

std::string verifyText(const VerifyReport& report);  ///< for people, several lines
std::string verifyJson(const VerifyReport& report);

}  // namespace polyfly
