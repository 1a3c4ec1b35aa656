#include "read_log.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>

#include "autopilot/autopilot_signals.hpp"
#include "command_line/prompt.hpp"
#include "command_line/read_progress.hpp"
#include "identification/bag_signals.hpp"
#include "identification/flight_phases.hpp"
#include "identification/signal_units.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"

namespace polyfly {
namespace {

std::map<std::string, std::string> parseSignals(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> choice;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw Error("--signal " + text + ": must be SIGNAL=COLUMN");
    }
    choice[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return choice;
}

bool isBag(const std::string& path) {
  constexpr std::size_t kEnding = 4;
  return path.size() > kEnding && path.compare(path.size() - kEnding, kEnding, ".bag") == 0;
}

}  // namespace

void declareLog(CLI::App& command, LogArguments& arguments) {
  command
      .add_option("log", arguments.log,
                  "Recorded flight: a bag, a PX4 log (ULog), an ArduPilot dataflash log, or a CSV file.")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--window", arguments.windows,
                  "Interval to use, in seconds of the log. May be repeated. The tool chooses intervals if "
                  "none is given.")
      ->type_name("FROM:TO");
  command
      .add_option("--signal", arguments.signals,
                  "Place of a signal: a column, TOPIC:FIELD of a bag, or TABLE:FIELD of an autopilot log. "
                  "May be repeated. The tool finds signals by name and type if not given.")
      ->type_name("SIGNAL=PLACE");
  command
      .add_option("--topic", arguments.topics,
                  "Use only topics of the bag whose names end like this. May be repeated.")
      ->type_name("ENDING");
  command.add_option("--recorded", arguments.recorded,
                     "Date of the flight, for the provenance of the result.");
  command.add_option("-o,--output", arguments.output, "Write the results to this file as YAML.")
      ->type_name("FILE");
  command
      .add_option(
          "--vehicle", arguments.vehicle,
          "Kind of the vehicle. The tool recognises it by log, airspeed or ground speed if not given.")
      ->check(oneOf(std::vector<std::string>{"multirotor", "fixed_wing"}));
  command.add_flag("--on-ground", arguments.on_ground,
                   "Also use data that an autopilot recorded on the ground.");
  command.add_flag("--strict", arguments.strict, "End with exit code 1 if there is a warning.");
  command.add_flag("--quiet", arguments.quiet, "Print nothing but errors.");
}

std::vector<TimeWindow> parseWindows(const std::vector<std::string>& texts) {
  std::vector<TimeWindow> windows;
  for (const std::string& text : texts) {
    TimeWindow window;
    const std::size_t colon = text.find(':');
    bool good = colon != std::string::npos;
    if (good) {
      good = CLI::detail::lexical_cast(text.substr(0, colon), window.from) &&
             CLI::detail::lexical_cast(text.substr(colon + 1), window.to) && std::isfinite(window.from) &&
             std::isfinite(window.to) && window.from < window.to;
    }
    if (!good) throw Error("--window " + text + ": must be FROM:TO in seconds, FROM before TO");
    windows.push_back(window);
  }
  return windows;
}

namespace {

FlightSignals readAnyLog(const std::string& path, const LogArguments& arguments, Provenance* provenance,
                         std::vector<std::string>* remarks) {
  const auto choice = parseSignals(arguments.signals);
  if (isAutopilotLog(path)) {
    AutopilotSignals log = signalsFromAutopilot(path, choice, arguments.on_ground);
    *provenance = provenanceOf(path);
    provenance->recorded = arguments.recorded;
    for (const std::string& remark : log.remarks) remarks->push_back(path + ": " + remark);
    return log.signals;
  }
  if (!isBag(path)) {
    FlightSignals signals = signalsFromCsv(readCsv(path), choice);
    *provenance = provenanceOf(path);
    provenance->recorded = arguments.recorded;
    return signals;
  }
  BagSignalOptions options;
  options.choice = choice;
  options.topics = arguments.topics;
  if (!arguments.quiet && isatty(STDERR_FILENO) != 0) options.progress = showReadProgress;
  if (!arguments.quiet) options.ask = promptIfTerminal();
  BagSignals bag = signalsFromBag(path, options);
  *provenance = provenanceOf(path);
  provenance->recorded = arguments.recorded.empty() ? isoTime(bag.health.first) : arguments.recorded;
  for (const std::string& remark : bag.health.remarks) remarks->push_back(path + ": " + remark);
  return bag.signals;
}

}  // namespace

FlightSignals readSignals(const std::string& path, const LogArguments& arguments, Provenance* provenance,
                          std::vector<std::string>* remarks) {
  FlightSignals signals = readAnyLog(path, arguments, provenance, remarks);
  if (!arguments.vehicle.empty()) signals.vehicle = {vehicleKindOf(arguments.vehicle), "As --vehicle says."};
  for (const std::string& remark : clockRemarks(signals)) remarks->push_back(path + ": " + remark);
  for (const std::string& remark : settleUnits(&signals)) remarks->push_back(path + ": " + remark);
  for (const std::string& clause : clausesOn(signals.not_flight)) remarks->push_back(path + ": " + clause);
  const std::vector<RejectedWindow> found = findNonFlight(signals, arguments.on_ground);
  for (const std::string& clause : clausesOn(found))
    remarks->push_back(path + ": " + clause + "; left out where no window asks for it");
  // Beside those that the autopilot told.
  signals.not_flight.insert(signals.not_flight.end(), found.begin(), found.end());
  std::stable_sort(signals.not_flight.begin(), signals.not_flight.end(),
                   [](const RejectedWindow& one, const RejectedWindow& other) {
                     return one.window.from < other.window.from;
                   });
  return signals;
}

void checkResults(const LogArguments& arguments, const std::string& report, const std::string& validation) {
  std::vector<Output> outputs = {{arguments.output}};
  if (!report.empty()) {
    for (const char* name : {"/index.html", "/calibration.yaml"})
      outputs.push_back({report + name, Output::Kind::kText, Output::Folder::kIsMade});
  }
  checkOutputs(outputs, {arguments.log, validation});
}

}  // namespace polyfly
