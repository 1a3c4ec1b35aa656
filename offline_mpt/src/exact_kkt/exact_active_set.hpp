#pragma once

#include <optional>
#include <vector>

#include "exact_kkt/exact_program.hpp"
#include "offline_mpt/exact_lp.hpp"

namespace polyfly {

/// The active set of the optimum at t, without equalities, ascending: dual steps without rounding (Goldfarb and Idnani, 1983),
/// first from the rows of `start`. Where H is zero, it is that of the shortest optimum. Nothing where there is none.
std::optional<std::vector<int>> activeSetAt(const ExactProgram& program, const std::vector<Rational>& t,
                                            const std::vector<int>& start);

/// The rows of the program at t, over free columns z. Those of directions have 0 for all bounds.
ExactLp rowsAt(const ExactProgram& program, const std::vector<Rational>& t, bool of_directions = false);

/// Sets the cost of the program at t.
void setCostAt(const ExactProgram& program, const std::vector<Rational>& t, ExactLp& lp);

}  // namespace polyfly
