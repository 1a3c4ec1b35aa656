#pragma once

/// Tolerances of the check of answers.
namespace polyfly::tolerance {

/// An input with a greater range has none [range of an input].
constexpr double kNoRange = 1e100;

/// Of a smaller inscribed ball, fractions decide how large it is [scaled].
constexpr double kCertainRadius = 1e-9;

/// A direction that approaches a face slower never meets it [scaled].
constexpr double kParallelFace = 1e-9;

/// Shorter directions are used up [scaled].
constexpr double kShortDirection = 1e-9;

/// Distances from a face at which parameters are drawn [scaled].
constexpr double kOffsets[] = {0.0, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-4};

/// Difference up to which the ranges of map and program are the same [range].
constexpr double kSameRange = 1e-12;

/// A pivot of squared lengths that is a smaller share of its diagonal entry is rounding of 32 digits [relative].
constexpr double kRankOfSquares = 1e-24;

/// A row moves a multiplier by a smaller share only by rounding of 32 digits [rows of unit length].
constexpr double kNoShare = 1e-16;

/// A row is violated by a smaller share of its terms only by rounding of 32 digits [relative].
constexpr double kRoundedExcess = 1e-22;

/// Multiple of the identity that makes a cost strictly convex, as a share of the greatest entry of H [relative].
constexpr double kRegularisedHessian = 1e-14;

/// Costs that differ by a smaller share of their greatest terms are the same [relative].
constexpr double kTiedCost = 1e-12;

/// Greatest error of u that the check of `solve` accepts, as a share of the input's range [relative].
constexpr double kCheckedError = 1e-6;

/// How much of it each row may be violated by [share of kCheckedError].
constexpr double kCheckedRow = 1e-4;

/// Parameters nearer to the edge of the feasible set may go either way [scaled].
constexpr double kCheckedEdge = 1e-7;

/// Distance behind a facet at which the map is checked [scaled].
constexpr double kCheckedBehind = 1e-6;

/// Outputs that are smaller in all samples count as zero [unit of u].
constexpr double kNoOutput = 1e-25;

}  // namespace polyfly::tolerance
