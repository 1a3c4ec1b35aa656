#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "identification/flight_signals.hpp"
#include "identification/provenance.hpp"

namespace polyfly {

/// Options of every command that reads flights.
struct LogArguments {
  std::string log;
  std::vector<std::string> windows;
  std::vector<std::string> signals;
  std::vector<std::string> topics;
  std::string recorded;
  std::string vehicle;
  std::string output;
  bool on_ground = false;
  bool strict = false;
  bool quiet = false;
};

void declareLog(CLI::App& command, LogArguments& arguments);

/// FROM:TO in seconds. Throws Error.
std::vector<TimeWindow> parseWindows(const std::vector<std::string>& texts);

/// Signals of a flight in any form, with units settled and the stretches that are no flight; appends what was
/// wrong with it, where its times jump, and those stretches. Throws Error.
FlightSignals readSignals(const std::string& path, const LogArguments& arguments, Provenance* provenance,
                          std::vector<std::string>* remarks);

/// Before the work: throws Error where the result or its report cannot be written, or would take the place of
/// one of the logs (empty names apart).
void checkResults(const LogArguments& arguments, const std::string& report,
                  const std::string& validation = {});

}  // namespace polyfly
