#pragma once

#include "problem_types.hpp"

namespace polyfly {

/// Proves the map of a robust_mpc in fractions, or compares it with linear programs at samples. Throws Error where a
/// repair is asked for, which there is not, or a certificate of another problem than the map carries.
ExitCode verifyRobust(const RegionMap& map, const VerifyTask& task);

}  // namespace polyfly
