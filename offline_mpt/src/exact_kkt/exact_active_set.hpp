#pragma once

#include <optional>
#include <vector>

#include "exact_kkt/exact_program.hpp"

namespace polyfly {

/// The active set of the optimum at t, without equalities, ascending: dual steps without rounding (Goldfarb and Idnani, 1983),
/// first from the rows of `start`. Where H is zero, it is that of the shortest optimum. Nothing where there is none.
std::optional<std::vector<int>> activeSetAt(const ExactProgram& program, const std::vector<Rational>& t,
                                            const std::vector<int>& start);

}  // namespace polyfly
