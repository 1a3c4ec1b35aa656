#pragma once

/// Tolerances of robust maps.
namespace polyfly::tolerance {

/// How far below zero a slack may lie [scaled rows].
constexpr double kFeasibleSlack = 1e-11;

/// Least pivot of the dual simplex [scaled rows].
constexpr double kLeastPivot = 1e-10;

/// Smaller reduced costs are alike in the ratio test [reduced costs].
constexpr double kSameCost = 1e-12;

/// Greatest allowed violation of a row [scaled rows].
constexpr double kRowViolation = 1e-10;

/// First slack of tau when the move is chosen [tau].
constexpr double kFirstSlack = 1e-11;

/// In floating point, a vertex may be this far outside [distance from the interior point].
constexpr double kVertexOutside = 1e-9;

/// Smaller multipliers count as zero [greatest multiplier].
constexpr double kZeroMultiplier = 1e-9;

/// Least margin of all rows at the interior point [scaled rows].
constexpr double kLeastRoom = 1e-9;

}  // namespace polyfly::tolerance
