#pragma once

#include "offline_mpt/explore_options.hpp"
#include "program/tolerances.hpp"

/// Tolerances of the search tree and of the map's tables.
namespace polyfly::tolerance {

/// Planes that differ by less are written once [scaled].
constexpr double kSamePlane = kDefaultRadiusTolerance / 10.0;

/// The same where rows of the program nearly repeat each other, whose regions may be thinner [scaled].
constexpr double kSamePlaneOfNearRows = kSamePlane / 100.0;

/// A law that is written for several regions differs from the law of each in the box by less, relative to its |u|, or
/// to that of all laws where they are less than 1. Proofs allow twice as much [max(1, |u|)].
constexpr double kSharedLaw = 5e-9;

/// Smaller entries do not decide the sign of a plane [unit rows].
constexpr double kLeadingEntry = 1e-6;

/// A point on a row shows that it is needed if the others leave at least this there [scaled].
constexpr double kNeededRow = 1e-9;

/// Rows that others imply up to this are dropped. It is far below kMembership, so that dropped rows do not change
/// which candidate is the nearest [scaled].
constexpr double kImpliedRow = 1e-12;

/// By how many tolerances rows that are not tested may be violated. A certificate proves 8; the rest is for rounding
/// [kMembership].
constexpr double kUntestedReach = 5.0;

/// By how much a parameter that a look-up accepts may lie outside of the box: 2^-26, as certificates have it [scaled].
constexpr double kMissedBox = 1.0 / (1 << 26);

/// By how much a parameter may have missed a plane on the way to a cell, by rounding [scaled].
constexpr double kMissedPlane = 1e-13;

/// Rows that differ by less from a side of the box count as that side [scaled].
constexpr double kSameAsBox = 1e-12;

/// Where no member reaches further across a plane, the cell would have a flat side [scaled].
constexpr double kFlatCell = 1e-7;

/// Least radius of a ball in each cell, where rows of the program nearly repeat each other: three planes that nearly share
/// a line would enclose cells as thin as the noise of the rows. By rounding, parameters arrive beyond such a cell at a
/// distance of its diameter times kMissedPlane over this radius: about kMembership [scaled].
constexpr double kLeastCell = kMissedPlane / kMembership;

/// Where all planes of a cell move by some distance, its corners move at most so many times as far along an axis. By
/// rounding, parameters may arrive as far beyond them, and no candidate need hold what it misses by more than
/// kMembership. Parts of regions that reach too little across a plane are left out too: three tenths leave room for
/// them [ratio of lengths].
constexpr double kMostCornerShift = 0.3 * kMembership / kMissedPlane;

/// Planes at a smaller angle that cross in the box leave an edge of a cell. By rounding, parameters may arrive beyond
/// it at a distance of kMissedPlane over the angle, and more where several planes meet. No candidate need hold them
/// beyond kMembership, so the angle leaves ten times the room [unit rows, sum of differences].
constexpr double kSharpAngle = 10.0 * kMissedPlane / kMembership;

}  // namespace polyfly::tolerance
