#pragma once

#include <functional>

#include "lp/polytope.hpp"

namespace polyfly {

/// The same question that PolytopeSolver::furthest answers, about the same rows of doubles, by ExactLp: without rounding, and
/// hundreds of times later. PolytopeSolver asks it where rounding leads its own pivots astray.
///
/// Rows that `start` violates by rounding count as met there. False where the polytope is unbounded that way, or a row or
/// `start` is not finite.
bool maximiseRationally(int dimension, const double* rows, int count, const double* start,
                        const double* direction, double* point);

/// Finds a point of the rows, furthest in a direction.
using Furthest = std::function<bool(const double* rows, int count, const double* start,
                                    const double* direction, double* point)>;

/// As PolytopeSolver::minimalBeside, which documents it: by one maximum for each row.
bool minimalOneByOne(int kept, int dimension, const double* rows, int count, const double* interior,
                     double tolerance, const Furthest& furthest, MinimalRows& result);

}  // namespace polyfly
