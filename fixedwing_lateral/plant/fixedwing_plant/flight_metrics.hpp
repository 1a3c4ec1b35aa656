#pragma once

#include <vector>

#include "fixedwing_plant/flight_loop.hpp"

namespace polyfly {

/// Distance from the mission's path near the segment of the sample, over the true segments with their ends
/// [m].
double pathDistance(const std::vector<PathSegment>& segments, const FlightSample& sample);

/// What a flight did on one segment.
struct SegmentMetrics {
  int segment = 0;
  double duration = 0.0;   ///< [s]
  double overshoot = 0.0;  ///< of a line: farthest past it, after it was first reached [m]
  /// Largest distance once converged and before the next corner is in the horizon [m].
  double converged = 0.0;
  bool has_converged = false;
  double convergence = 0.0;  ///< time until the distance fell below `kConverged` for good [s]
};

constexpr double kConverged = 1.0;  // [m]
constexpr double kJoinedFor = 3.0;  // [s]

/// One entry for each segment that was flown. `window` [s] of flight before a segment's end is not counted as
/// converged: there the next segment is in the horizon. The share `settle` of its time is left for
/// joining it.
std::vector<SegmentMetrics> segmentMetrics(const std::vector<PathSegment>& segments,
                                           const std::vector<FlightSample>& samples, double settle,
                                           double window);

/// Over the whole flight.
struct FlightMetrics {
  double rms = 0.0;           ///< of the distance to the path [m]
  double largest = 0.0;       ///< [m]
  double roll_largest = 0.0;  ///< [rad]
  double rate_largest = 0.0;  ///< [rad/s]
  double roll_effort = 0.0;   ///< root mean square of the roll rate [rad/s]
  double converged = 0.0;     ///< largest of the segments' [m]
  double loiter = 0.0;        ///< largest distance on the last loiter once converged [m]
  double overshoot = 0.0;     ///< largest of the segments' [m]
  /// The path is joined when the distance stays below kConverged for kJoinedFor for the first time.
  bool has_joined = false;
  double joined = 0.0;         ///< when that begins [s]
  double after_joining = 0.0;  ///< largest distance from then on, junctions of segments included [m]
};

FlightMetrics flightMetrics(const std::vector<PathSegment>& segments,
                            const std::vector<FlightSample>& samples, double settle, double window);

}  // namespace polyfly
