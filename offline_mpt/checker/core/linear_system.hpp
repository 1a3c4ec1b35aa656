#pragma once

#include <vector>

#include "core/rows.hpp"

namespace checker {

/// Solves the square system of equations in place, without fractions: its last columns then are determinant * solution.
/// Returns the determinant's absolute value. Unknowns from `required` on may be left free, and are zero then; the others
/// must be unique. Throws Refused.
Integer solveSystem(std::vector<Row>& system, std::size_t required);

}  // namespace checker
