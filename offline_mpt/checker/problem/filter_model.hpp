#pragma once

#include "problem/filter_problem.hpp"

namespace checker {

/// The model of a safety filter over one period, with bounds of all that is uncertain:
///
///     xi+ = A xi + B u + c + w,   |w_i| <= W_i
///
/// While xi is in [lower, upper] at the samples, and in one convex set with all its successors, the state is in its ranges
/// at all times (offline_mpt/checker/README.md, "Safety filters").
struct FilterModel {
  BallMatrix A, B, c;
  Vector W, lower, upper;
  /// What must be left of each row, so that answers may be off: the margin times half of upper - lower.
  Vector slack;
};

/// Throws Refused where the period is too long for the series, or a range vanishes.
FilterModel filterModel(const FilterProblem& problem);

}  // namespace checker
