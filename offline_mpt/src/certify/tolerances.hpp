#pragma once

#include "program/tolerances.hpp"

/// Tolerances of the proofs. They choose what is tried; what is proven is decided in rational arithmetic.
namespace polyfly::tolerance {

/// A smaller weight is taken for zero [greatest weight].
constexpr double kNoWeight = 1e-9;

/// What rows that exclude each other are to imply of another one: more than it can be violated in the box [box].
constexpr double kFarAway = 16.0;

/// Takes a computed bound below the exact one [factor].
constexpr double kRoundDown = 1.0 - 0x1p-50;

/// Takes a computed bound above the exact one [factor].
constexpr double kRoundUp = 1.0 + 0x1p-50;

/// Share of a starting point's depth in the path rows that is left for the rows of its region [depth].
constexpr double kRegionShare = 0x1p-20;

/// How deep a starting point is to be in path rows that do not press, beside those that do [share].
constexpr double kLightRow = 0x1p-6;

/// A starting point that is as deep needs no better one [scaled].
constexpr double kDeepEnough = 0x1p-6;

/// Rounding of a row's value at a point of the box is less [scaled].
constexpr double kSurely = 1e-12;

/// Rows at this distance may have counted as one: the exploration compares with the first of several [unit rows].
constexpr double kMostRepeated = 2.0 * kRepeatedRow;

/// Regions with planes that differ by less may share a facet [unit rows].
constexpr double kTouchingPlanes = 1e-6;

/// Least radius at which a rounded centre counts as an interior point [scaled].
constexpr double kInteriorRadius = 1e-10;

/// Greatest difference of two rows that may be the same plane [unit rows].
constexpr double kNearPlanes = 1e-9;

/// A certificate states this law tolerance where all laws keep to it [max(1, greatest u of the law in the box)].
constexpr double kTightLaw = 1e-10;

/// Slack that the proof of a reduction may use [maps' tolerance].
constexpr double kReductionShare = 0.5;

/// Regions farther from a sliver's point are looked at only if the nearer ones fail [scaled].
constexpr double kNearSliver = 0.01;

}  // namespace polyfly::tolerance
