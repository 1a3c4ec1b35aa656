#pragma once

#include <string>
#include <vector>

#include "fixedwing_plant/flight_loop.hpp"

namespace polyfly {

/// What an aircraft's log says of one moment.
struct RecordedSample {
  AircraftState state;
  double airspeed = 0.0;  ///< [m/s]
};

/// A log as CSV with a header: t_s, roll_rad, rollrate_radps, heading_rad, north_m, east_m, vn_mps, ve_mps,
/// tas_mps or ias_mps; other columns are skipped. Samples between `begin` and `end`
/// [s]. Throws polyfly::Error naming file, line and column.
std::vector<RecordedSample> readRecording(const std::string& path, double begin, double end);

/// The path that was flown, as splines one after another through points `spacing` [s] apart.
Mission missionAlong(const std::vector<RecordedSample>& samples, double spacing);

/// For replays at about that airspeed [m/s]: limits that flights reached, no learning.
GuidanceOptions replayOptions(double airspeed);

/// What the guidance would have done at each period, had it been asked: the state stays the recorded one.
/// Neither wind nor faults; the wind is what ground and air velocity differ by.
std::vector<FlightSample> replayOpenLoop(LateralGuidance& guidance,
                                         const std::vector<RecordedSample>& samples);

/// The constant wind with which the speeds fit, by the airspeed alone: no heading is used [m/s].
Eigen::Vector2d windBySpeeds(const std::vector<RecordedSample>& samples);

}  // namespace polyfly
