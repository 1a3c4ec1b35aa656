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
  double duration = 0.0;  ///< [s]
  /// Overshoot of a line: greatest distance beyond it after it was first reached [m].
  double overshoot = 0.0;
  /// Largest distance once converged and before the next corner is in the horizon [m].
  double converged = 0.0;
  bool has_converged = false;
  /// Time after which the distance stays below `kConverged` [s].
  double convergence = 0.0;
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
  /// Root mean square of the distance to the path [m].
  double rms = 0.0;
  double largest = 0.0;       ///< [m]
  double roll_largest = 0.0;  ///< [rad]
  double rate_largest = 0.0;  ///< [rad/s]
  /// Root mean square of the roll rate [rad/s].
  double roll_effort = 0.0;
  /// Largest `converged` of the segments [m].
  double converged = 0.0;
  /// Largest distance on the last loiter once converged [m].
  double loiter = 0.0;
  /// Largest overshoot of the segments [m].
  double overshoot = 0.0;
  /// The path is joined when the distance stays below kConverged for kJoinedFor for the first time.
  bool has_joined = false;
  /// Time from which the path is joined [s].
  double joined = 0.0;
  /// Largest distance after joining, junctions of segments included [m].
  double after_joining = 0.0;
};

FlightMetrics flightMetrics(const std::vector<PathSegment>& segments,
                            const std::vector<FlightSample>& samples, double settle, double window);

}  // namespace polyfly
