#pragma once

/// Tolerances of robust maps.
namespace polyfly::tolerance {

/// How far below zero a slack may lie.
constexpr double kFeasibleSlack = 1e-11;

/// Least pivot of the dual simplex.
constexpr double kLeastPivot = 1e-10;

/// Smaller reduced costs are alike in the ratio test.
constexpr double kSameCost = 1e-12;

/// Greatest allowed violation of a row.
constexpr double kRowViolation = 1e-10;

/// First slack of tau when the move is chosen.
constexpr double kFirstSlack = 1e-11;

/// In floating point, a vertex may be this far outside.
constexpr double kVertexOutside = 1e-9;

/// Smaller multipliers count as zero.
constexpr double kZeroMultiplier = 1e-9;

/// Least margin of all rows at the interior point.
constexpr double kLeastRoom = 1e-9;

}  // namespace polyfly::tolerance
