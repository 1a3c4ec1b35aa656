#pragma once

#include "lp/polytope.hpp"

namespace polyfly {

/// The same questions that PolytopeSolver answers, about the same rows of doubles, by ExactLp: without rounding, and
/// thousands of times later. PolytopeSolver asks them where rounding leads its own pivots astray.

/// A point where direction . t is greatest. Rows that `start` violates by rounding count as met there. False where the
/// polytope is unbounded that way, or a row is not finite.
bool maximiseRationally(int dimension, const double* rows, int count, const double* start,
                        const double* direction, double* point);

/// As PolytopeSolver::minimalBeside, which documents it.
bool minimalRationally(int kept, int dimension, const double* rows, int count, const double* interior,
                       double tolerance, MinimalRows& result);

}  // namespace polyfly
