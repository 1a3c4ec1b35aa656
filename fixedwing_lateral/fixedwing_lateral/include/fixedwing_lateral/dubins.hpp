#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fixedwing_lateral/path.hpp"

namespace polyfly {

/// Where to be and which way to go.
struct PathPose {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< (north, east) [m]
  double heading = 0.0;                                ///< along the path, clockwise from north [rad]
};

/// The six candidates for a shortest path of bounded curvature: left, straight, right.
enum class DubinsWord : std::uint8_t { kLsl, kRsr, kLsr, kRsl, kRlr, kLrl };
constexpr std::array<DubinsWord, 6> kDubinsWords = {DubinsWord::kLsl, DubinsWord::kRsr, DubinsWord::kLsr,
                                                    DubinsWord::kRsl, DubinsWord::kRlr, DubinsWord::kLrl};

/// "LSL" and so on.
const char* toString(DubinsWord word) noexcept;

/// One path between two poses. A part shorter than kShortestSegment is left out of `segments`.
struct DubinsPath {
  DubinsWord word = DubinsWord::kLsl;
  double length = 0.0;  ///< [m]
  int segment_count = 0;
  /// Segments in order of flight; only the first `segment_count` are used.
  std::array<PathSegment, 3> segments;
};

// The poses must be finite and the radius [m] positive; planDubins checks it, the others trust it. They
// neither allocate nor throw.

/// The path of one word, if the word can join the poses. LSR and RSL need the centres of the circles that they join
/// at least 2 radii apart. RLR and LRL need them at most 4 radii apart. Of the two middle arcs of RLR and LRL the one
/// of more than half a turn is taken. The other is never part of a shortest path.
std::optional<DubinsPath> dubinsPath(DubinsWord word, const PathPose& from, const PathPose& to,
                                     double radius) noexcept;

/// The shortest of the six. Of equally long ones (to rounding) the first in the order of kDubinsWords, so
/// that rounding does not decide. No segments from a pose to itself.
DubinsPath shortestDubinsPath(const PathPose& from, const PathPose& to, double radius) noexcept;

/// The shortest paths from each waypoint to the next, one after another. Throws polyfly::Error, beginning
/// with `where`, on fewer than two waypoints, a number that is not finite, a radius that is not positive.
std::vector<PathSegment> planDubins(const std::vector<PathPose>& waypoints, double radius,
                                    const std::string& where);

}  // namespace polyfly
