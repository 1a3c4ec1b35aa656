#pragma once

/// Tolerances of sets.
namespace polyfly::tolerance {

/// Sides of a domain that differ by less are one [scaled].
constexpr double kSameDomainSide = 1e-10;

/// Rounding of a vertex [scaled].
constexpr double kVertexRounding = 1e-12;

/// A smaller entry is zero [unit rows].
constexpr double kZeroEntry = 1e-12;

/// Rows that differ by less are the same [unit rows].
constexpr double kSameRow = 1e-11;

/// The recursion takes a loop that grows by this factor more, so that its set is invariant with a margin [factor].
constexpr double kLoopGrowth = 1.0 + 1e-6;

/// The set is scaled by this, so that rounding keeps it within the bounds [factor].
constexpr double kSetShrink = 1.0 - 1e-9;

}  // namespace polyfly::tolerance
