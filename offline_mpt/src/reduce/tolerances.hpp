#pragma once

/// Tolerances of the reduction of maps.
namespace polyfly::tolerance {

/// Slack that regions may use when they are joined [map's tolerance].
constexpr double kMergingShare = 0.125;

/// Regions with a smaller inscribed ball are left as they are [scaled].
constexpr double kEmptyInterior = 1e-11;

/// Least reach that makes a half-space needed [scaled].
constexpr double kNeededReach = 1e-9;

/// Planes that differ by less are one [scaled].
constexpr double kSameCellPlane = 1e-11;

/// A rest whose largest ball is smaller is no rest [scaled].
constexpr double kNoRest = 1e-12;

/// Least angle of planes on one path where cells become regions. Exported code moves the corner of a cell by its
/// rounding over this angle [unit rows, sum of differences].
constexpr double kCellAngle = 1e-2;

}  // namespace polyfly::tolerance
