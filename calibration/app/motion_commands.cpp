#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <iostream>
#include <memory>

#include "calibrate_commands.hpp"
#include "identification/motion_output.hpp"
#include "identification/several_motions.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/visible.hpp"
#include "polyfly_base/write_file.hpp"
#include "read_log.hpp"
#include "validation/motion_report.hpp"

namespace polyfly {
namespace {

struct MotionArguments : LogArguments {
  MotionOptions motion;
  BoundOptions limits;
  std::vector<double> drag;
  std::string report;
};

// The flights: all together on one clock, and each on its own with its windows.
struct MotionFlights {
  FlightSignals joint;
  std::vector<TimeWindow> windows;
  std::vector<FlightSignals> each;
  std::vector<std::vector<TimeWindow>> each_windows;

  bool several() const { return each.size() > 1; }
};

using Find = std::function<void(const MotionFlights&, const MotionArguments&, MotionCalibration*)>;

// The windows of all flights on their common clock. A flight without one is used as a whole if another has one.
std::vector<TimeWindow> jointWindows(const MotionFlights& flights, const JoinedFlights& joined) {
  const auto& each = flights.each_windows;
  if (std::all_of(each.begin(), each.end(), [](const auto& windows) { return windows.empty(); })) return {};
  std::vector<TimeWindow> all;
  for (std::size_t i = 0; i < each.size(); ++i) {
    for (const TimeWindow& window : each[i])
      all.push_back({window.from + joined.shifts[i], window.to + joined.shifts[i]});
    if (!each[i].empty()) continue;
    const std::vector<TimeWindow> flown = windowsWithout({joined.spans[i]}, joined.signals.not_flight);
    all.insert(all.end(), flown.begin(), flown.end());
  }
  return all;
}

MotionFlights readMotion(const MotionArguments& arguments, MotionCalibration* calibration) {
  MotionFlights flights;
  std::vector<ReadFlight> read = readFlights(arguments, &calibration->remarks);
  calibration->vehicle = vehicleOf(read);
  for (ReadFlight& flight : read) {
    calibration->lossy = calibration->lossy || flight.signals.lossy;
    flights.each.push_back(std::move(flight.signals));
    calibration->data.push_back(flight.provenance);
  }
  flights.each_windows = flightWindows(arguments.windows, flights.each.size());
  calibration->windows = flights.each_windows;
  if (!flights.several()) {
    flights.joint = flights.each.front();
    flights.windows = flights.each_windows.front();
    return flights;
  }
  JoinedFlights joined = joinFlights(flights.each);
  flights.windows = jointWindows(flights, joined);
  flights.joint = std::move(joined.signals);
  return flights;
}

Motion jointMotion(const MotionFlights& flights, MotionOptions options) {
  options.windows = flights.windows;
  return motionOf(flights.joint, options);
}

std::vector<Motion> motions(const MotionFlights& flights, MotionOptions options) {
  std::vector<Motion> all;
  for (std::size_t i = 0; i < flights.each.size(); ++i) {
    options.windows = flights.each_windows[i];
    all.push_back(motionOf(flights.each[i], options));
  }
  return all;
}

int run(const std::string& kind, MotionArguments arguments, const Find& find) {
  checkResults(arguments, arguments.report);
  MotionCalibration calibration;
  calibration.kind = kind;
  calibration.limits = arguments.limits;
  for (std::size_t i = 0; i < arguments.drag.size(); ++i) {
    arguments.motion.drag[static_cast<Eigen::Index>(i)] = arguments.drag[i];
  }
  const MotionFlights flights = readMotion(arguments, &calibration);
  for (const char* name : {"vx", "vy", "vz"}) {
    if (flights.joint.has(name)) calibration.record.emplace_back(name, cleaned(flights.joint.at(name)));
  }
  find(flights, arguments, &calibration);
  if (!arguments.quiet) std::cout << visibleLines(toText(calibration));
  if (!arguments.output.empty()) writeFileAtomically(arguments.output, toYaml(calibration));
  if (!arguments.report.empty()) writeReport(calibration, arguments.report);
  const bool warned = calibration.lossy || !calibration.warnings.empty() ||
                      std::any_of(calibration.bounds.begin(), calibration.bounds.end(),
                                  [](const DisturbanceBound& one) { return !one.warnings.empty(); });
  return warned && arguments.strict ? kWarned : kCalibrated;
}

// What the fit found, into the calibration.
void keep(MotionFit&& fit, MotionCalibration* calibration) {
  calibration->parameters = std::move(fit.parameters);
  calibration->traces = std::move(fit.traces);
  calibration->warnings = std::move(fit.warnings);
}

// With the values of each flight.
void keep(SeveralFit&& fit, MotionCalibration* calibration) {
  calibration->flights = std::move(fit.flights);
  keep(static_cast<MotionFit&&>(fit), calibration);
}

void bound(const MotionFlights& flights, const MotionArguments& arguments, MotionCalibration* calibration) {
  const Motion motion = jointMotion(flights, arguments.motion);
  calibration->bounds = boundDisturbance(motion, arguments.motion, arguments.limits);
  calibration->traces = disturbanceTraces(motion, arguments.motion);
  calibration->warnings = checkMotion(motion);
}

void findDrag(const MotionFlights& flights, const MotionArguments& arguments,
              MotionCalibration* calibration) {
  const Motion joint = jointMotion(flights, arguments.motion);
  if (flights.several()) {
    keep(fitDragOf(joint, motions(flights, arguments.motion)), calibration);
  } else {
    keep(fitDrag(joint), calibration);
  }
}

void findMass(const MotionFlights& flights, const MotionArguments& arguments,
              MotionCalibration* calibration) {
  const Motion joint = jointMotion(flights, arguments.motion);
  if (flights.several()) {
    keep(fitMassOf(joint, motions(flights, arguments.motion), arguments.motion), calibration);
  } else {
    keep(fitMass(joint, arguments.motion), calibration);
  }
}

void declareMotion(CLI::App& command, MotionArguments& arguments) {
  command.add_option("--gravity", arguments.motion.gravity, "Gravitational acceleration [m/s^2].")
      ->check(numberFrom(1.0, 30.0))
      ->capture_default_str();
  command
      .add_option("--smoothing", arguments.motion.smoothing,
                  "Half width of the moving average of the velocity [s].")
      ->check(numberFrom(0.0, 5.0))
      ->capture_default_str();
}

void declareNewtons(CLI::App& command, MotionArguments& arguments) {
  command.add_flag("--newtons", arguments.motion.newtons,
                   "The thrust command is in newtons, although it never exceeds 1.");
}

void declareMass(CLI::App& command, MotionArguments& arguments) {
  command.add_option("--mass", arguments.motion.mass, "Mass, if the thrust command is in newtons [kg].")
      ->check(numberAbove(0.0));
  declareNewtons(command, arguments);
}

void declareDrag(CLI::App& command, MotionArguments& arguments) {
  command
      .add_option("--drag", arguments.drag, "Drag coefficients along x, y, z of the world, per mass [1/s].")
      ->check(finiteNumber())
      ->expected(3);
}

CLI::App* add(CLI::App& app, const std::string& kind, const std::string& description, int* result,
              const Find& find, const std::shared_ptr<MotionArguments>& arguments) {
  CLI::App* command = app.add_subcommand(kind, description);
  declareLog(*command, *arguments);
  command
      ->add_option("--report", arguments->report, "Write index.html and calibration.yaml into this folder.")
      ->type_name("DIR");
  command->callback([kind, arguments, result, find] { *result = run(kind, *arguments, find); });
  return command;
}

}  // namespace

void addMotionCommands(CLI::App& app, int* result) {
  const auto limits = std::make_shared<MotionArguments>();
  CLI::App* command =
      add(app, "disturbance", "Bound the acceleration that thrust, attitude and drag do not explain.", result,
          bound, limits);
  declareMotion(*command, *limits);
  declareMass(*command, *limits);
  declareDrag(*command, *limits);
  command->add_option("--share", limits->limits.share, "Share of the time in which the bounds hold.")
      ->check(numberFrom(0.5, 0.9999))
      ->capture_default_str();
  command->add_option("--confidence", limits->limits.confidence, "Confidence that they hold.")
      ->check(numberFrom(0.5, 0.9999))
      ->capture_default_str();

  const auto drag = std::make_shared<MotionArguments>();
  command = add(app, "drag", "Identify the drag coefficients of the multirotor.", result, findDrag, drag);
  declareMotion(*command, *drag);
  declareMass(*command, *drag);

  const auto mass = std::make_shared<MotionArguments>();
  command = add(app, "mass", "Identify mass and hover thrust of the multirotor.", result, findMass, mass);
  declareMotion(*command, *mass);
  declareNewtons(*command, *mass);
  declareDrag(*command, *mass);

}

}  // namespace polyfly
