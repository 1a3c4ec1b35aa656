#include <CLI/CLI.hpp>
#include <algorithm>
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
};

// The motion of each flight, and what the page draws of a single one.
std::vector<Motion> readMotions(const MotionArguments& arguments, MotionCalibration* calibration) {
  const std::vector<FlightSignals> flights = readFlights(arguments, calibration);
  calibration->windows = flightWindows(arguments.windows, flights.size());
  std::vector<Motion> motions;
  for (const FlightSignals& flight : flights) {
    MotionOptions options = arguments.motion;
    options.windows = calibration->windows[motions.size()];
    motions.push_back(motionOf(flight, options));
    for (const char* name : {"vx", "vy", "vz"}) {
      if (flights.size() == 1) calibration->record.emplace_back(name, cleaned(flight.at(name)));
    }
  }
  return motions;
}

int run(const std::string& kind, const MotionArguments& arguments) {
  checkResults(arguments);
  MotionCalibration calibration;
  calibration.kind = kind;
  calibration.limits = arguments.limits;
  const MotionOptions& options = arguments.motion;
  const std::vector<Motion> flights = readMotions(arguments, &calibration);
  if (kind == "disturbance") {
    calibration.fit = traceDisturbance(flights, options);
    calibration.bounds = boundDisturbance(flights, options, arguments.limits);
  } else {
    calibration.fit = kind == "drag" ? fitDrag(flights) : fitMass(flights, options);
  }
  const bool is_warned = calibration.lossy || !calibration.fit.warnings.empty() ||
                         std::any_of(calibration.bounds.begin(), calibration.bounds.end(),
                                     [](const DisturbanceBound& one) { return !one.warnings.empty(); });
  const Report page = arguments.report.empty() ? Report() : reportOn(calibration);
  return writeResults(arguments, toText(calibration), jsonOf(calibration), page, is_warned);
}

void add(CLI::App& app, const std::string& kind, const std::string& description, int* result) {
  const auto arguments = std::make_shared<MotionArguments>();
  CLI::App* command = app.add_subcommand(kind, description);
  declareLog(*command, *arguments);
  const auto addNumber = [&](const char* name, double& value, const char* meaning,
                             const CLI::Validator& rule) {
    return command->add_option(name, value, meaning)->check(rule);
  };
  MotionOptions& motion = arguments->motion;
  addNumber("--gravity", motion.gravity, "Gravitational acceleration [m/s^2].", numberFrom(1.0, 30.0))
      ->capture_default_str();
  addNumber("--smoothing", motion.smoothing, "Half width of the moving average of the velocity [s].",
            numberFrom(0.0, 5.0))
      ->capture_default_str();
  command->add_flag("--newtons", motion.newtons,
                    "The thrust command is in newtons, although it never exceeds 1.");
  if (kind != "mass")
    addNumber("--mass", motion.mass, "Mass, if the thrust command is in newtons [kg].", numberAbove(0.0));
  if (kind != "drag")
    command
        ->add_option_function<std::vector<double>>(
            "--drag",
            [&motion](const std::vector<double>& drag) {
              motion.drag = {drag[0], drag[1], drag[2]};
            },
            "Drag coefficients along x, y, z of the world, per mass [1/s].")
        ->check(finiteNumber())
        ->expected(3);
  if (kind == "disturbance") {
    addNumber("--share", arguments->limits.share, "Share of the time in which the bounds hold.",
              numberFrom(0.5, 0.9999))
        ->capture_default_str();
    addNumber("--confidence", arguments->limits.confidence, "Confidence that they hold.",
              numberFrom(0.5, 0.9999))
        ->capture_default_str();
  }
  command->callback([kind, arguments, result] { *result = run(kind, *arguments); });
}

}  // namespace

void addMotionCommands(CLI::App& app, int* result) {
  add(app, "disturbance", "Bound the acceleration that thrust, attitude and drag do not explain.", result);
  add(app, "drag", "Identify the drag coefficients of the multirotor.", result);
  add(app, "mass", "Identify mass and hover thrust of the multirotor.", result);
}

}  // namespace polyfly
