#pragma once

#include "offline_mpt/explore_options.hpp"
#include "program/tolerances.hpp"

/// Tolerances of the exploration.
namespace polyfly::tolerance {

/// A region holds a probe within this, as a look-up does [scaled].
constexpr double kHeldProbe = kMembership;

/// A region holds a point of its own facet within this [scaled].
constexpr double kHeldOnFacet = kMembership;

/// Error of a plane or law up to which doubles are used. Two regions that share a facet have its plane from systems of
/// their own. Between these planes lies a wedge that no region holds, which may be thousands of times as long as it is
/// wide. All of it must lie within kMembership of some region [scaled; laws: relative to max(1, |u|)].
constexpr double kAccurate = kMembership / 1e3;

/// Factor by which an estimated error may be too small [factor].
constexpr double kErrorMargin = 10.0;

/// By how much a plane may miss the box and count as one that meets it [box].
constexpr double kBoxMargin = 1e-9;

/// A row at a greater distance from the span of the others is independent of them [unit rows].
constexpr double kIndependent = 1e-10;

/// At a smaller distance even estimates of errors mislead [unit rows].
constexpr double kDistant = kIndependent / 1e-3;

/// At a smaller squared distance products of rows mislead [unit rows, squared].
constexpr double kSafePivot = 1e-6;

/// A smaller residual outside of the span of the active rows is rounding [greatest entry of the cost].
constexpr double kCostResidual = 1e-9;

/// A row with a smaller slope does not depend on the parameters [greatest entry of the active rows' sides, at least 1].
constexpr double kConstantRow = 1e-11;

/// The same for slacks that are known to the last digit [greatest entry of the active rows' sides, at least 1].
constexpr double kConstantSlack = 1e-14;

/// By how much rows may overlap, or part, with nothing between them [scaled].
constexpr double kFlatness = kMembership;

/// By how much the half-spaces of a flat set are moved outwards [scaled].
constexpr double kOutwards = 4.0 * kFlatness;

/// Rows with a smaller product are opposite [unit rows].
constexpr double kOppositeProduct = 1e-6 - 1.0;

/// A greater slack leaves no doubt, whatever the slope [greatest multiplier].
constexpr double kClearSlack = 1e-4;

/// Rows that differ by less nearly repeat each other [unit rows].
constexpr double kNearRow = 1e-5;

/// Greatest radius of a region that is left to its neighbours where rows nearly repeat each other. There such regions lie
/// between the planes of the search tree, thousands of times as long as they are wide [scaled].
constexpr double kNearRowRadius = kDefaultRadiusTolerance / 100.0;

/// Rounding of what the others leave beyond the half-space of such a row is less [scaled].
constexpr double kImpliedNearRow = 1e-13;

/// How far beyond the half-space of such a row a point is looked for [scaled].
constexpr double kNearRowReach = 1.0;

/// Half-spaces that differ by less are the same plane [unit rows].
constexpr double kSameFacet = 1e-9;

/// A row with a greater weight can leave in an exchange [unit rows].
constexpr double kExchangeWeight = 1e-9;

/// Least pivot and weight with which estimates of changes are trusted [unit rows].
constexpr double kSoundPivot = 1e-3;

/// Distance behind a crossing of which something is said [scaled].
constexpr double kRoomBehind = 1e-5;

/// Step of a probe across a degenerate facet [scaled].
constexpr double kProbeStep = 1e-7;

/// Weight of |z|^2 in programs that find active sets where H is zero [cost].
constexpr double kLinearStart = 1e-5;

/// Factor of step and edge where the cost of a linear program depends on the parameters: just behind a facet, the
/// weight of |z|^2 would decide [factor].
constexpr double kLinearProbe = 1e4;

/// A point at this distance from all half-spaces shows that a region has an interior [scaled].
constexpr double kClearlyInside = 1e-10;

/// A probe whose rows cannot all keep this slack lies at the edge of the feasible set [rows' distances].
constexpr double kProbeEdge = 1e-9;

/// Rows with smaller multipliers are not active in a starting point [rows' distances].
constexpr double kActiveMultiplier = 1e-10;

/// Error of multipliers up to which 32 digits are enough [relative].
constexpr double kTrustedMultipliers = 1e-16;

/// Factor by which the error of a sum of products exceeds that of one operation [factor].
constexpr double kErrorOfSums = 64.0;

}  // namespace polyfly::tolerance
