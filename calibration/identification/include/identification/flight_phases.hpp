#pragma once

#include <string>
#include <vector>

#include "identification/flight_signals.hpp"

namespace polyfly {

/// Finds the stretches in which the vehicle does not fly, in order of time, without overlap, with reasons.
///
/// - Upset: it tilts far beyond what was commanded, turns faster than commanded (by attitude or gyro), or falls
///   freely (accelerometer). An impact next to an upset belongs to it, and so does what follows until the vehicle
///   flies as commanded for some seconds, or to the end if it rests.
/// - Ground, unless `on_ground`: it stands by at least two of: throttle at its least, no speed, attitude at rest,
///   height at its least, accelerometer at rest. A throttle that is not at its least contradicts.
///
/// What a signal would tell is left out of the judgement where the signal is not there. No stretch is found where
/// neither attitude nor velocity is sampled at least twice per second. The times of the signals may jump.
std::vector<RejectedWindow> findNonFlight(const FlightSignals& signals, bool on_ground = false);

/// For each reason a clause with its times: "55.2 .. 60 s: upset, not commanded".
std::vector<std::string> clausesOn(const std::vector<RejectedWindow>& left_out);

/// The same, to end the sentence of an error with. Empty where the user gave windows, which are used as they are.
std::string whyNotFlight(const std::vector<RejectedWindow>& left_out, const std::vector<TimeWindow>& given);

}  // namespace polyfly
