#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "calibrate_commands.hpp"
#include "fixedwing_lateral/lateral_parameters.hpp"
#include "identification/apply_options.hpp"
#include "mpc_core/apply_calibration.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "online_controller/parameters/multirotor_parameters.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_base/visible.hpp"
#include "polyfly_base/write_file.hpp"

namespace polyfly {
namespace {

struct ApplyArguments {
  std::vector<std::string> calibrations;
  std::string problem;
  OptionsTarget options;
  std::string output;
  bool force = false;
};

// What is printed must be options with which the node starts.
void requireNodeStarts(const std::string& block, const std::string& vehicle) {
  const std::string source = "the options of a " + vehicle;
  if (vehicle == "fixed_wing") {
    parseLateralParameters(block, source);
  } else {
    parseMultirotorParameters(block, source);
  }
}

void printOptions(const OptionsTarget& target, const std::vector<CalibrationFile>& files) {
  const std::string block = optionsBlock(target, files);
  requireNodeStarts(block, target.vehicle);
  std::cout << visibleLines(block);
}

void applyToProblem(const ApplyArguments& arguments, const std::vector<CalibrationFile>& files) {
  const AppliedCalibration applied = applyCalibrations(readText(arguments.problem), arguments.problem, files);
  // What is written must be a problem; a robust one is checked for what a controller needs of it.
  parseFlightModel(applied.problem, arguments.problem + " with its calibration");
  writeFileAtomically(arguments.output, applied.problem);
  for (const std::string& change : applied.changes) std::cout << visible(change) << "\n";
  if (applied.changes.empty()) std::cout << "all numbers were as identified already\n";
}

int apply(const ApplyArguments& arguments) {
  const std::string& vehicle = arguments.options.vehicle;
  if (arguments.problem.empty() == vehicle.empty())
    throw Error("--problem: give either a problem file or --options");
  if (!vehicle.empty() && vehicle != "multirotor" && vehicle != "fixed_wing") {
    throw Error("--options " + vehicle + ": writes no file any more; --options multirotor or --options " +
                "fixed_wing prints the block to paste into the file");
  }
  if (arguments.problem.empty() != arguments.output.empty())
    throw Error("-o: names the problem file to write, with --problem");
  if (vehicle.empty()) {
    std::vector<std::string> inputs = arguments.calibrations;
    inputs.push_back(arguments.problem);
    checkOutputs({{arguments.output}}, inputs);
  }
  std::vector<CalibrationFile> files;
  for (const std::string& path : arguments.calibrations)
    files.push_back({readText(path), path, provenanceOf(path), arguments.force});
  if (vehicle.empty()) {
    applyToProblem(arguments, files);
  } else {
    printOptions(arguments.options, files);
  }
  return kCalibrated;
}

}  // namespace

void addApplyCommand(CLI::App& app, int* result) {
  const auto arguments = std::make_shared<ApplyArguments>();
  CLI::App* command = app.add_subcommand(
      "apply",
      "Write calibrations into a problem file, or print them as a node's options, with their provenance.");
  command
      ->add_option("calibrations", arguments->calibrations,
                   "Output files (-o) of attitude, drag, disturbance and mass.")
      ->required()
      ->type_name("FILE...");
  command->add_option("--problem", arguments->problem, "Problem file to calibrate.")->type_name("FILE");
  command
      ->add_option(
          "--options", arguments->options.vehicle,
          "Print the block to paste into the options of this vehicle's node: multirotor or fixed_wing.")
      ->type_name("VEHICLE");
  command->add_flag("--predicts-delay", arguments->options.predicts_delay,
                    "With --options: the controller predicts over the delay.");
  command->add_option("-o,--output", arguments->output, "Problem file to write.")->type_name("FILE");
  command->add_flag("--force", arguments->force, "Use numbers also if the data do not support them.");
  command->callback([arguments, result] { *result = apply(*arguments); });
}

}  // namespace polyfly
