#pragma once

#include <string>
#include <vector>

#include "identification/flight_signals.hpp"

namespace polyfly {

/// Finds the stretches in which the vehicle does not fly, in order of time, without overlap, with reasons.
///
/// - Upset: it tilts far beyond what was commanded.
/// - Ground, unless `on_ground`: throttle at its least, with no speed or with the attitude at rest. Without a
///   throttle: no speed and the attitude at rest.
///
/// No stretch is found where the attitude is not sampled twice per second. The times of the signals may jump.
std::vector<RejectedWindow> findNonFlight(const FlightSignals& signals, bool on_ground = false);

/// For each reason a clause with its times: "55.2 .. 60 s: upset, not commanded".
std::vector<std::string> clausesOn(const std::vector<RejectedWindow>& left_out);

/// The same, to end the sentence of an error with. Empty where the user gave windows, which are used as they are.
std::string whyNotFlight(const std::vector<RejectedWindow>& left_out, const std::vector<TimeWindow>& given);

}  // namespace polyfly
