#pragma once

#include "problem_types.hpp"

namespace polyfly {

/// Proves the map in rational arithmetic, or refutes it; with `output`, repairs it, writes the new map and
/// proves that one. kDone when what was asked for is proven. The processes of an MPI launcher prove together.
ExitCode verifyExact(const VerifyArguments& options);

/// Proves that a reduced map answers as the original, or refutes it. kDone when it is proven.
ExitCode verifyReducedMap(const VerifyArguments& options);

/// Proves the map of a robust_mpc in fractions, or compares it with linear programs at samples. Throws Error where a
/// repair is asked for, which there is not, or a certificate of another problem than the map carries.
ExitCode verifyRobust(const RegionMap& map, const VerifyArguments& options);

}  // namespace polyfly
