#pragma once

#include "offline_mpt/explore_options.hpp"

/// Tolerances of the count of regions.
namespace polyfly::tolerance {

/// Witnesses are multiples of this: 40 bits each [scaled].
constexpr double kWitnessStep = 0x1p-39;

/// By how much a slack must exceed a gap between laws, for the rounding of both.
constexpr double kClearlyApart = 1.01;

/// Least radius of a region that counts: twice what the exploration keeps [scaled].
constexpr double kLeastRadius = 2.0 * kDefaultRadiusTolerance;

/// Least distance of a witness from the planes of the domain [scaled].
constexpr double kDomainMargin = kLeastRadius / 2.0;

/// A row at a greater squared distance from the span of the others is independent of them.
constexpr double kIndependentRow = 1e-9;

/// By how much a value must exceed the estimate of what rounding does.
constexpr double kRoundingSafety = 100.0;

/// Least eigenvalue of H that doubles can be sure of.
constexpr double kDefiniteUnitDiagonal = 1e-13;

/// Rows that differ by more need no exact look.
constexpr double kMultiple = 1e-12;

/// Weight of |(z, t)|^2 that makes the search for bounds strictly convex.
constexpr double kBoundWeight = 1e-9;

/// Greatest sum of |coefficients| that the weights may leave besides z_j.
constexpr double kMostLeft = 0.5;

/// Factor that covers the rounding of the bounds.
constexpr double kRoundingUp = 1.01;

/// Two laws that a map stores as one differ from the first of them by kSameLaw each. The other half is for
/// rounding.
constexpr double kLawErrors = 4.0;

}  // namespace polyfly::tolerance
