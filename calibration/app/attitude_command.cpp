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
  bool second_order = false;
  IdentifyOptions options;
};

bool holds(const FlightSignals& flight, const std::string& axis) {
  const std::vector<std::string> axes = recordedAxes(flight);
  return std::find(axes.begin(), axes.end(), axis) != axes.end();
}

// One axis of all flights that hold it, with a remark on each of several that does not. Throws Error.
std::vector<AxisFlightRecords> recordsOf(const std::vector<FlightSignals>& flights,
                                         const std::vector<std::vector<TimeWindow>>& windows,
                                         const std::optional<FlightSignals>& validation,
                                         const std::string& axis, std::vector<std::string>* remarks) {
  std::vector<AxisFlightRecords> all;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    if (flights.size() > 1 && !holds(flights[i], axis)) {
      remarks->push_back(flights[i].source + ": holds no " + axis + " together with its command");
      continue;
    }
    all.push_back({axisRecords(flights[i], axis), windows[i]});
    if (validation) all.back().records.validation = axisRecords(*validation, axis).training;
  }
  if (all.empty()) throw Error("no flight holds " + axis + " together with its command");
  return all;
}

// The axes that any of the flights holds; notes on what each lacks. Throws Error where there is none.
std::vector<std::string> axesOf(const std::vector<FlightSignals>& flights,
                                std::vector<std::string>* remarks) {
  std::vector<std::string> axes;
  for (const std::string axis : {"roll", "pitch", "yaw_rate", "thrust"}) {
    if (std::any_of(flights.begin(), flights.end(),
                    [&axis](const FlightSignals& flight) { return holds(flight, axis); }))
      axes.push_back(axis);
  }
  std::string why;
  for (const FlightSignals& flight : flights) {
    why += (why.empty() ? "" : "; ") + flight.source + ": holds no command together with its response";
    for (const std::string& sentence : missingAxes(flight)) {
      remarks->push_back(flight.source + ": " + sentence);
      why += "; " + sentence;
    }
  }
  if (axes.empty()) throw Error(why);
  return axes;
}

AttitudeCalibration calibrate(const AttitudeArguments& arguments) {
  IdentifyOptions options = arguments.options;
  AttitudeCalibration calibration;
  const std::vector<FlightSignals> flights = readFlights(arguments, &calibration);
  const auto windows = flightWindows(arguments.windows, flights.size());
  std::optional<FlightSignals> validation;
  if (!arguments.validation.empty()) {
    calibration.validation.emplace();
    validation = readSignals(arguments.validation, arguments, &*calibration.validation, &calibration);
  }
  const std::vector<std::string> axes =
      arguments.axes.empty() ? axesOf(flights, &calibration.remarks) : arguments.axes;
  for (const std::string& axis : axes) {
    options.second_order =
        arguments.second_order || (axis == "roll" && calibration.vehicle.name == "fixed_wing");
    try {
      calibration.axes.push_back(
          identifyFlights(recordsOf(flights, windows, validation, axis, &calibration.remarks), options));
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
  addRemoved(*command, {"--validation-window"}, "was removed; the tool chooses the intervals itself");
  command->add_flag("--second-order", arguments->second_order,
                    "Fit a0, a1, b0 (Eq. 45) for every axis, not only for the roll of a fixed wing.");
  command->add_option("--delay-max", arguments->options.fit.delay_greatest, "Upper bound of the delay [s].")
      ->check(numberFrom(0.01, 3.0))
      ->capture_default_str();
  command->callback([arguments, result] { *result = run(*arguments); });
}

}  // namespace polyfly
