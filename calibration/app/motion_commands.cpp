#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <memory>

#include "calibrate_commands.hpp"
#include "identification/motion_output.hpp"
#include "polyfly_base/error.hpp"
#include "read_log.hpp"

namespace polyfly {
namespace {

struct MotionArguments : LogArguments {
  MotionOptions motion;
  BoundOptions limits;
  std::vector<double> drag;
};

using Find = std::function<void(const std::vector<Motion>&, const MotionArguments&, MotionCalibration*)>;

// The motion of each flight, and what the page draws of a single one.
std::vector<Motion> readMotions(const MotionArguments& arguments, MotionCalibration* calibration) {
  const std::vector<ReadFlight> flights = readFlights(arguments, &calibration->remarks);
  calibration->vehicle = vehicleOf(flights);
  calibration->windows = flightWindows(arguments.windows, flights.size());
  std::vector<Motion> motions;
  for (const ReadFlight& flight : flights) {
    MotionOptions options = arguments.motion;
    options.windows = calibration->windows[motions.size()];
    motions.push_back(motionOf(flight.signals, options));
    calibration->lossy = calibration->lossy || flight.signals.lossy;
    calibration->data.push_back(flight.provenance);
    for (const char* name : {"vx", "vy", "vz"}) {
      if (flights.size() == 1) calibration->record.emplace_back(name, cleaned(flight.signals.at(name)));
    }
  }
  return motions;
}

int run(const std::string& kind, MotionArguments arguments, const Find& find) {
  checkResults(arguments);
  MotionCalibration calibration;
  calibration.kind = kind;
  calibration.limits = arguments.limits;
  for (std::size_t i = 0; i < arguments.drag.size(); ++i) {
    arguments.motion.drag[static_cast<Eigen::Index>(i)] = arguments.drag[i];
  }
  find(readMotions(arguments, &calibration), arguments, &calibration);
  const bool is_warned = calibration.lossy || !calibration.fit.warnings.empty() ||
                         std::any_of(calibration.bounds.begin(), calibration.bounds.end(),
                                     [](const DisturbanceBound& one) { return !one.warnings.empty(); });
  const Report page = arguments.report.empty() ? Report() : reportOn(calibration);
  return writeResults(arguments, toText(calibration), jsonOf(calibration), page, is_warned);
}

void bound(const std::vector<Motion>& flights, const MotionArguments& arguments,
           MotionCalibration* calibration) {
  const Motion motion = joined(flights);
  calibration->bounds = boundDisturbance(motion, arguments.motion, arguments.limits);
  calibration->fit.traces = disturbanceTraces(motion, arguments.motion);
  calibration->fit.warnings = checkMotion(motion);
}

void findDrag(const std::vector<Motion>& flights, const MotionArguments&, MotionCalibration* calibration) {
  calibration->fit = fitDrag(flights);
}

void findMass(const std::vector<Motion>& flights, const MotionArguments& arguments,
              MotionCalibration* calibration) {
  calibration->fit = fitMass(flights, arguments.motion);
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
