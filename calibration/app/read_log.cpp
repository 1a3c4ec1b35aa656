#include "read_log.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

#include "autopilot/autopilot_signals.hpp"
#include "bags/recording_share.hpp"
#include "calibrate_commands.hpp"
#include "command_line/command_line.hpp"
#include "command_line/read_progress.hpp"
#include "identification/bag_signals.hpp"
#include "identification/flight_phases.hpp"
#include "identification/signal_units.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_base/visible.hpp"
#include "polyfly_base/write_file.hpp"
#include "report/yaml.hpp"

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

}  // namespace

void declareLog(CLI::App& command, LogArguments& arguments) {
  addOption(
      command, "log", arguments.logs, "FILE...",
      "Recorded flight: a bag, a PX4 log (ULog), an ArduPilot dataflash log, or a CSV file. Several flights "
      "of one vehicle give one model.")
      ->required();
  addOption(
      command, "--window", arguments.windows, "[NUMBER:]FROM:TO",
      "Interval to use, in seconds of the log. May be repeated. The tool chooses intervals if none is given. "
      "Of several logs it holds for all, or for the one of that NUMBER (from 1).");
  addOption(
      command, "--signal", arguments.signals, "SIGNAL=PLACE",
      "Place of a signal: a column, TOPIC:FIELD of a bag, or TABLE:FIELD of an autopilot log. time=COLUMN or "
      "time=SECONDS,NANOSECONDS names the times of a CSV. May be repeated. The tool finds signals by name "
      "and type if not given.");
  addOption(command, "--topic", arguments.topics, "ENDING",
            "Use only topics of the bag whose names end like this. May be repeated.");
  addOption(command, "--namespace", arguments.name_space, "NAME",
            "Namespace of the vehicle, where a bag holds several: only its topics are used.");
  addOption(command, "--recorded", arguments.recorded, "TEXT",
            "Date of the flight, for the provenance of the result.");
  addOption(command, "-o,--output", arguments.output, "FILE", "Write the results to this file as YAML.");
  addOption(command, "--report", arguments.report, "DIR",
            "Write index.html and calibration.yaml into this folder.");
  command
      .add_option("--vehicle", arguments.vehicle,
                  "Kind of the vehicle. Only logs of PX4 and ArduPilot tell it by themselves.")
      ->check(oneOf(std::vector<std::string>{"multirotor", "fixed_wing"}));
  command.add_flag("--on-ground", arguments.on_ground,
                   "Also use data that an autopilot recorded on the ground.");
  command.add_flag("--strict", arguments.strict,
                   "End with exit code 1 if there is a warning, or parts of a record are lost.");
  command.add_flag("--quiet", arguments.quiet, "Print nothing but errors.");
}

namespace {

// FROM:TO in seconds, of the option's text.
TimeWindow windowOf(const std::string& window, const std::string& text) {
  TimeWindow result;
  const std::size_t colon = window.find(':');
  const bool good = colon != std::string::npos &&
                    CLI::detail::lexical_cast(window.substr(0, colon), result.from) &&
                    CLI::detail::lexical_cast(window.substr(colon + 1), result.to) &&
                    std::isfinite(result.from) && std::isfinite(result.to) && result.from < result.to;
  if (!good) throw Error("--window " + text + ": must be FROM:TO in seconds, FROM before TO");
  return result;
}

}  // namespace

std::vector<std::vector<TimeWindow>> flightWindows(const std::vector<std::string>& texts,
                                                   std::size_t flights) {
  std::vector<std::vector<TimeWindow>> windows(flights);
  for (const std::string& text : texts) {
    const std::size_t colon = text.find(':');
    // Of all flights, or of the one of this number.
    std::size_t number = 0;
    const bool is_of_one = std::count(text.begin(), text.end(), ':') > 1;
    if (is_of_one &&
        (!CLI::detail::lexical_cast(text.substr(0, colon), number) || number < 1 || number > flights)) {
      throw Error("--window " + text + ": its first number must be that of a log, 1 to " +
                  std::to_string(flights));
    }
    const TimeWindow window = windowOf(is_of_one ? text.substr(colon + 1) : text, text);
    for (std::size_t i = 0; i < flights; ++i) {
      if (!is_of_one || i + 1 == number) windows[i].push_back(window);
    }
  }
  return windows;
}

namespace {

FlightSignals readAnyLog(const std::string& path, const LogArguments& arguments, Provenance* provenance,
                         std::vector<std::string>* remarks) {
  const auto choice = parseSignals(arguments.signals);
  FlightSignals signals;
  std::vector<std::string> told;
  double first = 0.0;
  if (isAutopilotLog(path)) {
    AutopilotSignals log = signalsFromAutopilot(path, choice, arguments.on_ground);
    signals = std::move(log.signals);
    told = std::move(log.remarks);
  } else if (endsWith(path, ".bag")) {
    BagSignalOptions options = {arguments.topics, arguments.name_space, choice, {}};
    if (!arguments.quiet && isatty(STDERR_FILENO) != 0) options.progress = showReadProgress;
    BagSignals bag = signalsFromBag(path, options);
    signals = std::move(bag.signals);
    told = std::move(bag.health.remarks);
    first = bag.health.first;
  } else {
    signals = signalsFromCsv(readCsv(path), choice);
    told = signals.remarks;
    first = spanOf(signals).from;
  }
  for (const std::string& remark : told) remarks->push_back(path + ": " + remark);
  *provenance = provenanceOf(path);
  // A simulated clock begins in 1970: that is no date.
  provenance->recorded =
      arguments.recorded.empty() && countsFromEpoch(first) ? isoTime(first) : arguments.recorded;
  return signals;
}

}  // namespace

FlightSignals readSignals(const std::string& path, const LogArguments& arguments, Provenance* provenance,
                          CalibrationFlights* calibration) {
  std::vector<std::string>* remarks = &calibration->remarks;
  FlightSignals signals = readAnyLog(path, arguments, provenance, remarks);
  calibration->lossy = calibration->lossy || signals.lossy;
  if (!arguments.vehicle.empty()) signals.vehicle = {arguments.vehicle, "As --vehicle says."};
  for (const std::string& remark : clockRemarks(signals)) remarks->push_back(path + ": " + remark);
  for (const std::string& remark : checkUnits(&signals, arguments.on_ground))
    remarks->push_back(path + ": " + remark);
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

namespace {

// Puts the pieces of recordings together: they are no flights of their own.
std::vector<FlightSignals> piecedTogether(std::vector<FlightSignals> files, CalibrationFlights* calibration) {
  const std::vector<Provenance> data = std::exchange(calibration->data, {});
  std::vector<TimeSpan> times;
  for (const FlightSignals& file : files) {
    const TimeWindow span = spanOf(file);
    times.push_back({span.from, span.to});
  }
  std::vector<FlightSignals> flights;
  for (const std::vector<std::size_t>& pieces : recordingsOf(times)) {
    flights.push_back(std::move(files[pieces.front()]));
    calibration->data.push_back(data[pieces.front()]);
    for (std::size_t piece = 1; piece < pieces.size(); ++piece) {
      FlightSignals& next = files[pieces[piece]];
      calibration->remarks.push_back(flights.back().source + ": the recording was split and goes on in " +
                                     next.source);
      calibration->data.back().file += ", " + data[pieces[piece]].file;
      calibration->data.back().checksum += ", " + data[pieces[piece]].checksum;
      append(std::move(next), &flights.back());
    }
  }
  return flights;
}

// Kind of the vehicle, as the flights that tell it agree.
VehicleKind vehicleOf(const std::vector<FlightSignals>& flights) {
  const FlightSignals* first = nullptr;
  for (const FlightSignals& flight : flights) {
    if (!flight.vehicle.isKnown()) continue;
    if (first == nullptr) first = &flight;
    if (flight.vehicle.name != first->vehicle.name) {
      throw Error(flight.source + ": the vehicle is a " + flight.vehicle.name + " (" + flight.vehicle.reason +
                  ") and that of " + first->source + " a " + first->vehicle.name + " (" +
                  first->vehicle.reason + "); --vehicle states the kind");
    }
  }
  return first != nullptr ? first->vehicle : VehicleKind();
}

}  // namespace

std::vector<FlightSignals> readFlights(const LogArguments& arguments, CalibrationFlights* calibration) {
  std::vector<FlightSignals> flights;
  for (const std::string& path : arguments.logs) {
    Provenance provenance;
    flights.push_back(readSignals(path, arguments, &provenance, calibration));
    for (std::size_t i = 0; i < calibration->data.size(); ++i) {
      if (calibration->data[i].checksum == provenance.checksum)
        throw Error(path + ": is the same flight as " + flights[i].source);
    }
    calibration->data.push_back(provenance);
  }
  flights = piecedTogether(std::move(flights), calibration);
  calibration->vehicle = vehicleOf(flights);
  return flights;
}

void checkResults(const LogArguments& arguments, const std::string& validation) {
  std::vector<Output> outputs = {{arguments.output}};
  for (const char* name : {"/index.html", "/calibration.yaml"}) {
    if (!arguments.report.empty())
      outputs.push_back({arguments.report + name, Output::Kind::kText, Output::Folder::kIsMade});
  }
  std::vector<std::string> inputs = arguments.logs;
  inputs.push_back(validation);
  checkOutputs(outputs, inputs);
}

int writeResults(const LogArguments& arguments, const std::string& text, const Json& json, const Report& page,
                 bool is_warned) {
  if (!arguments.quiet) std::cout << visibleLines(text);
  if (!arguments.output.empty()) writeFileAtomically(arguments.output, yamlText(json));
  if (!arguments.report.empty()) writePage(arguments.report, page, "calibration.yaml", yamlText(json));
  return is_warned && arguments.strict ? kWarned : kCalibrated;
}

}  // namespace polyfly
