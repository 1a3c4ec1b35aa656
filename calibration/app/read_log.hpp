#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "identification/calibration_file.hpp"
#include "identification/flight_signals.hpp"
#include "report/report.hpp"

namespace polyfly {

/// Options of every command that reads flights.
struct LogArguments {
  /// Flights of one vehicle, at least one.
  std::vector<std::string> logs;
  std::vector<std::string> windows;
  std::vector<std::string> signals;
  std::vector<std::string> topics;
  std::string name_space;
  std::string recorded;
  std::string vehicle;
  std::string output;
  std::string report;
  bool on_ground = false;
  bool strict = false;
  bool quiet = false;
};

void declareLog(CLI::App& command, LogArguments& arguments);

/// The windows of each flight: FROM:TO holds for all flights, NUMBER:FROM:TO for one of them, counted from 1.
/// Throws Error.
std::vector<std::vector<TimeWindow>> flightWindows(const std::vector<std::string>& texts,
                                                   std::size_t flights);

/// Signals of a flight in any form, with units settled and the stretches that are no flight; appends what was
/// wrong with it, where its times jump, and those stretches. Throws Error.
FlightSignals readSignals(const std::string& path, const LogArguments& arguments, Provenance* provenance,
                          CalibrationFlights* calibration);

/// All flights of the arguments, in the order of their first files; the pieces of a recording that was split are one. Sets
/// what the calibration says of them. Throws Error; also where a flight is named twice, or kinds of vehicles differ.
std::vector<FlightSignals> readFlights(const LogArguments& arguments, CalibrationFlights* calibration);

/// Before the work: throws Error where the result or its report cannot be written, or would take the place of
/// one of the logs (empty names apart).
void checkResults(const LogArguments& arguments, const std::string& validation = {});

/// Prints and writes what was asked for. Returns the exit code. Throws Error.
int writeResults(const LogArguments& arguments, const std::string& text, const Json& json, const Report& page,
                 bool is_warned);

}  // namespace polyfly
