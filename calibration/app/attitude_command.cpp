#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>

#include "calibrate_commands.hpp"
#include "calibration/identification_report.hpp"
#include "identification/bag_signals.hpp"
#include "identification/flight_signals.hpp"
#include "region_maps/error.hpp"

namespace polyfly {
namespace {

struct Arguments {
  std::string log;
  std::string validation;
  std::vector<std::string> axes;
  std::vector<std::string> windows;
  std::vector<std::string> validation_windows;
  std::vector<std::string> signals;
  std::vector<std::string> topics;
  std::string recorded;
  std::string output;
  std::string report;
  bool second_order = false;
  bool strict = false;
  bool quiet = false;
  IdentifyOptions options;
};

std::vector<TimeWindow> parseWindows(const std::vector<std::string>& texts) {
  std::vector<TimeWindow> windows;
  for (const std::string& text : texts) {
    TimeWindow window;
    const std::size_t colon = text.find(':');
    bool good = colon != std::string::npos;
    if (good) {
      good = CLI::detail::lexical_cast(text.substr(0, colon), window.from) &&
             CLI::detail::lexical_cast(text.substr(colon + 1), window.to) && window.from < window.to;
    }
    if (!good) throw Error("--window " + text + ": must be FROM:TO in seconds, FROM before TO");
    windows.push_back(window);
  }
  return windows;
}

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

// The share that was read, on one line of a terminal.
void showProgress(double share) {
  constexpr double kStep = 0.01;
  static double shown = 0.0;
  if (share < shown + kStep && share < 1.0) return;
  shown = share;
  std::cerr << "\rreading " << static_cast<int>(100.0 * share) << " %"
            << (share < 1.0 ? "" : "\r            \r") << std::flush;
}

FlightSignals readSignals(const std::string& path, const Arguments& arguments, Provenance* provenance,
                          std::vector<std::string>* remarks) {
  const auto choice = parseSignals(arguments.signals);
  if (!isBag(path)) {
    FlightSignals signals = signalsFromCsv(readCsv(path), choice);
    *provenance = provenanceOf(path);
    provenance->recorded = arguments.recorded;
    return signals;
  }
  BagSignalOptions options;
  options.choice = choice;
  options.topics = arguments.topics;
  if (!arguments.quiet && isatty(STDERR_FILENO) != 0) options.progress = showProgress;
  BagSignals bag = signalsFromBag(path, options);
  *provenance = provenanceOf(path);
  provenance->recorded = arguments.recorded.empty() ? isoTime(bag.health.first) : arguments.recorded;
  for (const std::string& remark : bag.health.remarks) remarks->push_back(path + ": " + remark);
  return bag.signals;
}

AttitudeCalibration calibrate(const Arguments& arguments) {
  IdentifyOptions options = arguments.options;
  options.windows = parseWindows(arguments.windows);
  options.validation_windows = parseWindows(arguments.validation_windows);
  AttitudeCalibration calibration;
  const FlightSignals training =
      readSignals(arguments.log, arguments, &calibration.training, &calibration.remarks);
  std::optional<FlightSignals> validation;
  if (!arguments.validation.empty()) {
    calibration.validation.emplace();
    validation = readSignals(arguments.validation, arguments, &*calibration.validation, &calibration.remarks);
  }
  const std::vector<std::string> axes = arguments.axes.empty() ? recordedAxes(training) : arguments.axes;
  if (axes.empty()) {
    throw Error(arguments.log + ": holds no command together with its response; choose them with --signal");
  }
  for (const std::string& axis : axes) {
    try {
      AxisRecords records = axisRecords(training, axis);
      if (validation) records.validation = axisRecords(*validation, axis).training;
      options.second_order = arguments.second_order || axis == "roll";
      calibration.axes.push_back(identifyAxis(records, options));
    } catch (const Error& error) {
      calibration.failed.emplace_back(error.what());
    }
  }
  if (calibration.axes.empty()) throw Error(calibration.failed.front());
  return calibration;
}

void writeText(const std::string& text, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw Error(path + ": cannot be written");
}

int run(const Arguments& arguments) {
  const AttitudeCalibration calibration = calibrate(arguments);
  if (!arguments.quiet) std::cout << toText(calibration);
  if (!arguments.output.empty()) writeText(toYaml(calibration), arguments.output);
  if (!arguments.report.empty()) writeReport(calibration, arguments.report);
  const bool warned = !calibration.failed.empty() ||
                      std::any_of(calibration.axes.begin(), calibration.axes.end(),
                                  [](const AxisModel& axis) { return !axis.warnings.empty(); });
  return warned && arguments.strict ? kWarned : kCalibrated;
}

}  // namespace

void addAttitudeCommand(CLI::App& app, int* result) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("attitude", "Gain, lag and delay of roll, pitch, yaw rate and thrust");
  command->add_option("log", arguments->log, "Flight to identify from (.bag, or CSV)")
      ->required()
      ->type_name("FILE");
  command
      ->add_option(
          "--validation", arguments->validation,
          "Another flight to validate on; without it, the first half of the data is tried on the second")
      ->type_name("FILE");
  command->add_option("--axis", arguments->axes, "Only these axes; all that the log holds if not given")
      ->check(CLI::IsMember({"roll", "pitch", "yaw_rate", "thrust"}));
  command
      ->add_option(
          "--window", arguments->windows,
          "FROM:TO in the log's own seconds, repeatable; found by the command's activity if not given")
      ->type_name("FROM:TO");
  command->add_option("--validation-window", arguments->validation_windows, "The same in the other flight")
      ->type_name("FROM:TO");
  command
      ->add_option("--signal", arguments->signals,
                   "Where a signal is, repeatable: a column, or TOPIC:FIELD of a bag; guessed if not given")
      ->type_name("SIGNAL=PLACE");
  command
      ->add_option("--topic", arguments->topics, "Of a bag, guess from topics that end so only; repeatable")
      ->type_name("ENDING");
  command->add_flag("--second-order", arguments->second_order,
                    "Fit a0, a1, b0 (Eq. 45) to every axis, not to roll alone");
  command
      ->add_option("--delay-max", arguments->options.fit.delay_greatest,
                   "Greatest delay that is looked for [s]")
      ->check(CLI::Range(0.01, 3.0))
      ->capture_default_str();
  command->add_option("--recorded", arguments->recorded, "Date of the flight, for the result's provenance");
  command->add_option("-o,--output", arguments->output, "Write the numbers as YAML")->type_name("FILE");
  command->add_option("--report", arguments->report, "Write index.html and calibration.yaml into this folder")
      ->type_name("DIR");
  command->add_flag("--strict", arguments->strict, "Exit with 1 if there is a warning");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  command->callback([arguments, result] { *result = run(*arguments); });
}

}  // namespace polyfly
