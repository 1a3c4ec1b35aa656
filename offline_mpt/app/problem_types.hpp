#pragma once

#include <string>

#include "command.hpp"
#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/verify.hpp"

namespace polyfly {

class RegionMap;

struct SolveArguments;

/// What the command line of `verify` says.
struct VerifyArguments {
  std::string map;
  std::string problem;       ///< empty: the one that the map carries
  std::string json;          ///< file to write, empty: none
  std::string certificate;   ///< file to write, empty: none
  std::string output;        ///< repaired map to write, empty: none
  std::string reduced_from;  ///< the map that this one was reduced from, where that is to be proven
  VerifyOptions verify;
  /// Prove the map in fractions. False: compare it with another solver at samples.
  bool exact = false;
  bool repair = false;
  bool quiet = false;
  double time_limit = 0.0;  ///< [s], of a proof; 0: none
};

/// The program of the problem file, else of the text in the map. Throws Error.
ParametricProgram programOf(const VerifyArguments& options, const RegionMap& map);

/// A type of problem with a solver of its own. The tool explores the parametric program of any other type, which
/// mpc_core/problem_type.hpp reads.
struct OwnSolver {
  /// Value of the key `type` of a problem file.
  const char* type;
  ExitCode (*solve)(const SolveArguments& options);
  /// The outputs are checked already.
  ExitCode (*verify)(const RegionMap& map, const VerifyArguments& options);
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
