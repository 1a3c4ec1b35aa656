#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "calibrate_commands.hpp"
#include "identification/attitude_output.hpp"
#include "identification/flight_signals.hpp"
#include "identification/several_flights.hpp"
#include "polyfly_base/error.hpp"
#include "read_log.hpp"

namespace polyfly {
namespace {

struct AttitudeArguments : LogArguments {
  std::string validation;
  std::vector<std::string> axes;
  std::vector<std::string> validation_windows;
  bool second_order = false;
  IdentifyOptions options;
};

bool holds(const ReadFlight& flight, const std::string& axis) {
  const std::vector<std::string> axes = recordedAxes(flight.signals);
  return std::find(axes.begin(), axes.end(), axis) != axes.end();
}

// The axes that any of the flights holds, in the order of recordedAxes.
std::vector<std::string> axesOf(const std::vector<ReadFlight>& flights) {
  std::vector<std::string> axes;
  for (const std::string axis : {"roll", "pitch", "yaw_rate", "thrust"}) {
    if (std::any_of(flights.begin(), flights.end(),
                    [&axis](const auto& flight) { return holds(flight, axis); }))
      axes.push_back(axis);
  }
  return axes;
}

// One axis of all flights that hold it. Throws Error.
std::vector<AxisFlightRecords> recordsOf(const std::vector<ReadFlight>& flights,
                                         const std::vector<std::vector<TimeWindow>>& windows,
                                         const std::optional<FlightSignals>& validation,
                                         const std::string& axis) {
  std::vector<AxisFlightRecords> all;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    if (flights.size() > 1 && !holds(flights[i], axis)) continue;
    all.push_back({axisRecords(flights[i].signals, axis), windows[i]});
    if (validation) all.back().records.validation = axisRecords(*validation, axis).training;
  }
  if (all.empty()) throw Error("no flight holds " + axis + " together with its command");
  return all;
}

// Sentences on what each flight lacks, with its file. Of axes that are asked for: on each of several flights that
// does not hold one.
std::vector<std::string> missingIn(const std::vector<ReadFlight>& flights,
                                   const std::vector<std::string>& asked) {
  std::vector<std::string> sentences;
  for (const ReadFlight& flight : flights) {
    const std::string file = flight.signals.source + ": ";
    if (asked.empty()) {
      for (const std::string& sentence : missingAxes(flight.signals)) sentences.push_back(file + sentence);
    }
    for (const std::string& axis : asked) {
      if (flights.size() > 1 && !holds(flight, axis))
        sentences.push_back(file + "holds no " + axis + " together with its command");
    }
  }
  return sentences;
}

std::string whyNoAxis(const std::vector<ReadFlight>& flights) {
  std::string text;
  for (const ReadFlight& flight : flights) {
    text +=
        (text.empty() ? "" : "; ") + flight.signals.source + ": holds no command together with its response";
    for (const std::string& sentence : missingAxes(flight.signals)) text += "; " + sentence;
  }
  return text;
}

AttitudeCalibration calibrate(const AttitudeArguments& arguments) {
  IdentifyOptions options = arguments.options;
  options.validation_windows = parseWindows(arguments.validation_windows);
  AttitudeCalibration calibration;
  const std::vector<ReadFlight> flights = readFlights(arguments, &calibration.remarks);
  const auto windows = flightWindows(arguments.windows, flights.size());
  for (const ReadFlight& flight : flights) {
    calibration.training.push_back(flight.provenance);
    calibration.lossy = calibration.lossy || flight.signals.lossy;
  }
  calibration.vehicle = vehicleOf(flights);
  std::optional<FlightSignals> validation;
  if (!arguments.validation.empty()) {
    calibration.validation.emplace();
    validation = readSignals(arguments.validation, arguments, &*calibration.validation, &calibration.remarks);
    calibration.lossy = calibration.lossy || validation->lossy;
  }
  const std::vector<std::string> axes = arguments.axes.empty() ? axesOf(flights) : arguments.axes;
  const std::vector<std::string> missing = missingIn(flights, arguments.axes);
  if (axes.empty()) throw Error(whyNoAxis(flights));
  for (const std::string& sentence : missing) calibration.remarks.push_back(sentence);
  for (const std::string& axis : axes) {
    try {
      options.second_order =
          arguments.second_order || (axis == "roll" && calibration.vehicle.name == "fixed_wing");
      calibration.axes.push_back(identifyFlights(recordsOf(flights, windows, validation, axis), options));
    } catch (const Error& error) {
      calibration.failed.emplace_back(error.what());
    }
  }
  if (calibration.axes.empty()) throw Error(calibration.failed.front());
  return calibration;
}

int run(const AttitudeArguments& arguments) {
  checkResults(arguments, arguments.validation);
  const AttitudeCalibration calibration = calibrate(arguments);
  const bool is_warned =
      calibration.lossy || !calibration.failed.empty() ||
      std::any_of(calibration.axes.begin(), calibration.axes.end(),
                  [](const AxisModel& axis) { return !axis.warnings.empty() || !axis.supported; });
  const Report page = arguments.report.empty() ? Report() : reportOn(calibration);
  return writeResults(arguments, toText(calibration), jsonOf(calibration), page, is_warned);
}

}  // namespace

void addAttitudeCommand(CLI::App& app, int* result) {
  const auto arguments = std::make_shared<AttitudeArguments>();
  CLI::App* command =
      app.add_subcommand("attitude", "Identify gain, lag and delay of roll, pitch, yaw rate and thrust.");
  declareLog(*command, *arguments);
  command
      ->add_option("--validation", arguments->validation,
                   "Another flight for validation. Without it, the model of the first half of the data is "
                   "tested on the second.")
      ->type_name("FILE");
  command->add_option("--axis", arguments->axes, "Identify only these axes (default: all in the log).")
      ->check(oneOf(std::vector<std::string>{"roll", "pitch", "yaw_rate", "thrust"}));
  command
      ->add_option("--validation-window", arguments->validation_windows,
                   "Interval to use of the validation flight. May be repeated.")
      ->type_name("FROM:TO");
  command->add_flag("--second-order", arguments->second_order,
                    "Fit a0, a1, b0 (Eq. 45) for every axis, not only for the roll of a fixed wing.");
  command->add_option("--delay-max", arguments->options.fit.delay_greatest, "Upper bound of the delay [s].")
      ->check(numberFrom(0.01, 3.0))
      ->capture_default_str();
  command->callback([arguments, result] { *result = run(*arguments); });
}

}  // namespace polyfly
