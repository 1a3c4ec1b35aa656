#pragma once

#include <cstdint>
#include <string>

#include "command.hpp"
#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/search_tree.hpp"

namespace polyfly {

class RegionMap;

/// What `solve` was asked for.
struct SolveTask {
  std::string problem;
  std::string map;
  std::string stats;        ///< file to write, empty: none
  double time_limit = 0.0;  ///< [s], of all phases; 0: none
  TreeMode tree_mode = TreeMode::kAuto;
  std::uint64_t tree_nodes = 0;
  int threads = 1;
  bool quiet = false;
  std::string checkpoint;          ///< file of an unfinished run
  bool resume = false;             ///< continue from it
  double checkpoint_period = 0.0;  ///< [s], 0: only at the end
};

/// What `verify` was asked for.
struct VerifyTask {
  std::string problem;      ///< empty: the one that the map carries
  std::string json;         ///< file to write, empty: none
  std::string certificate;  ///< file to write, empty: none
  std::string output;       ///< repaired map to write, empty: none
  /// Prove the map in fractions. False: compare it with another solver at samples.
  bool exact = false;
  std::uint64_t samples = 0;
  std::uint64_t seed = 0;
  double tolerance = 0.0;
  int threads = 1;
  bool quiet = false;
};

/// A type of problem with a solver of its own. The tool explores the parametric program of any other type, which
/// mpc_core/problem_type.hpp reads.
struct OwnSolver {
  /// Value of the key `type` of a problem file.
  const char* type;
  ExitCode (*solve)(const SolveTask& task);
  /// The outputs are checked already.
  ExitCode (*verify)(const RegionMap& map, const VerifyTask& task);
};

/// The solver of a problem file's type; nullptr where its program is explored. Throws Error.
const OwnSolver* ownSolverOf(const std::string& problem);

/// The same for the problem that a map carries.
const OwnSolver* ownSolverOf(const RegionMap& map);

/// What each process of a job reads.
struct JobInput {
  const OwnSolver* own = nullptr;
  ParametricProgram program;  ///< where there is no solver of its own
  std::string summary;        ///< for MpiSession::readAlike

  /// In words, for the summary.
  std::string kind() const {
    return own == nullptr ? "a parametric program" : std::string("type ") + own->type;
  }
};

}  // namespace polyfly
