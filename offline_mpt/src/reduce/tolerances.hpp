#pragma once

/// Tolerances of the reduction of maps.
namespace polyfly::tolerance {

/// Slack that regions may use when they are joined.
constexpr double kMergingShare = 0.125;

/// Regions with a smaller inscribed ball are left as they are [scaled].
constexpr double kEmptyInterior = 1e-11;

/// Greatest change of a constant input over the box.
constexpr double kConstantInput = 1e-6;

/// Least reach that makes a half-space needed [scaled].
constexpr double kNeededReach = 1e-9;

/// Planes that differ by less are one [scaled].
constexpr double kSameCellPlane = 1e-11;

/// A rest whose largest ball is smaller is no rest [scaled].
constexpr double kNoRest = 1e-12;

/// Least distance of the pieces from the plane between them [scaled].
constexpr double kPlaneMargin = 1e-6;

/// Share of the margin that every piece must keep.
constexpr double kKeptMargin = 0.5;

/// A part of a piece with a smaller largest ball is left out [scaled].
constexpr double kNoPiece = 1e-10;

/// Fallback regions may reach this far beyond the domain [scaled].
constexpr double kSharpFallback = kNoRest;

/// Thickness of the slab about a plane in which neighbours are looked for [scaled].
constexpr double kNearPlane = 1e-4;

/// A sliver that the tree leaves to a neighbour must not be left to a fallback region, whose law may be another.
constexpr double kSharpSide = 0.03;

/// Least angle of planes on one path where cells become regions. Exported code moves the corner of a cell by its rounding
/// over this angle.
constexpr double kCellAngle = 1e-2;

}  // namespace polyfly::tolerance
