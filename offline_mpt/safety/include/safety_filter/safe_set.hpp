#pragma once

#include <string>

#include "mpc_core/parametric_program.hpp"
#include "mpc_core/safety_filter.hpp"

namespace polyfly {

/// The maximal robust control invariant set of a problem, less its margin, and the inputs that are admissible
/// in it. The doubles of the result are what the proof (prove_filter.hpp) is about; it is not made here.
/// Throws Error when there is no such set, or when the recursion does not end.
SafeSet computeSafeSet(const SafetyFilterProblem& problem);

/// Reads a problem file and completes it: computes the safe set where the file has none, and proves it. The
/// result has the text that a map carries. Throws Error also when the proof fails.
SafetyFilterProblem loadSafetyFilter(const std::string& path);

/// As loadProgram, of every type that has a parametric program; completes safety filters.
ParametricProgram loadCompleteProgram(const std::string& path);

}  // namespace polyfly
