#pragma once

#include "arithmetic/tolerances.hpp"
#include "region_maps/format.hpp"

/// Tolerances of the program's normal form, and of what all layers share.
namespace polyfly::tolerance {

/// How far outside of a half-space a look-up still counts a parameter as inside [scaled].
constexpr double kMembership = format::kMaxTolerance;

/// With a greater least eigenvalue, doubles know that H is positive definite where equalities leave z free [greatest
/// entry of H].
constexpr double kClearlyDefinite = 1e-9;

/// A smaller pivot or length is zero [greatest pivot].
constexpr double kProgramRank = 1e-11;

/// Equalities with a smaller pivot are dependent [greatest pivot].
constexpr double kEqualityRank = kProgramRank;

/// Rows that differ by less are parallel [unit rows].
constexpr double kParallelRows = 1e-12;

/// Right-hand sides that differ by less are equal [unit rows].
constexpr double kSameSide = 1e-12;

/// Distance up to which the exploration takes two inequalities for one [unit rows].
constexpr double kRepeatedRow = 1e-10;

/// Distance from the span of other equalities up to which one depends on them. Proofs let such rows fail by twice as
/// much [unit rows].
constexpr double kDependentEquality = 0x1p-41;

/// Rounding of the right-hand side of an equality [relative].
constexpr double kSideRounding = 0x1p-49;

/// Distance from the span of others from which doubles know what the row fixes to nine digits [unit rows].
constexpr double kClearEquality = 1e-6;

/// A smaller margin is none [unit rows].
constexpr double kLeastMargin = 1e-9;

/// A margin of zero may be this far below zero by rounding [unit rows].
constexpr double kMarginRounding = 1e-7;

/// Weight of |(z, t)|^2 that makes the search for a Slater point strictly convex [1].
constexpr double kSlaterWeight = 1e-7;

/// A row with a greater multiplier blocks the margin [margin's multiplier].
constexpr double kBlockingShare = 1e-4;

/// Two rows are opposite if their entries cancel up to this [unit rows].
constexpr double kOppositeRows = 1e-14;

/// A shorter row has no normal [greatest entry].
constexpr double kNoNormal = 1e-13;

/// A smaller slope is level [greatest entry of the cost].
constexpr double kLevelCost = 1e-9;

/// Greatest product with a direction of length 1 at which a row leaves it open [unit rows].
constexpr double kOpenDirection = 1e-9;

/// Steps across a facet, behind which the cost may have no end [scaled].
constexpr double kStepsAcross[] = {1e-2, 1e-4};

/// Planes nearer to a plane of the domain are its edge [scaled].
constexpr double kDomainEdge = 1e-9;

/// Half width of the box around z in which slacks are searched [rows' distances].
constexpr double kSearchBox = 1e4;

}  // namespace polyfly::tolerance
