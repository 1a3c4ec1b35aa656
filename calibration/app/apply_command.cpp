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
  std::string options;
  std::string output;
  bool force = false;
};

// What is written must be options with which the node starts.
void requireNodeStarts(const AppliedOptions& applied, const std::string& source) {
  if (applied.fixed_wing) {
    parseLateralParameters(applied.text, source);
  } else {
    parseMultirotorParameters(applied.text, source);
  }
}

int apply(const ApplyArguments& arguments) {
  const std::string& target = arguments.problem.empty() ? arguments.options : arguments.problem;
  if (target.empty() || (!arguments.problem.empty() && !arguments.options.empty()))
    throw Error("--problem: give either a problem file or --options");
  std::vector<std::string> inputs = arguments.calibrations;
  inputs.push_back(target);
  checkOutputs({{arguments.output}}, inputs);
  std::vector<CalibrationFile> files;
  for (const std::string& path : arguments.calibrations) {
    files.push_back({readText(path), path, provenanceOf(path), arguments.force});
  }
  AppliedOptions applied;
  if (arguments.problem.empty()) {
    applied = applyToOptions(readText(target), target, files);
    requireNodeStarts(applied, target + " with its calibration");
  } else {
    AppliedCalibration problem = applyCalibrations(readText(target), target, files);
    // What is written must be a problem; a robust one is checked for what a controller needs of it.
    parseFlightModel(problem.problem, target + " with its calibration");
    applied.text = std::move(problem.problem);
    applied.changes = std::move(problem.changes);
  }
  writeFileAtomically(arguments.output, applied.text);
  for (const std::string& change : applied.changes) std::cout << visible(change) << "\n";
  if (applied.changes.empty()) std::cout << "all numbers were as identified already\n";
  return kCalibrated;
}

}  // namespace

void addApplyCommand(CLI::App& app, int* result) {
  const auto arguments = std::make_shared<ApplyArguments>();
  CLI::App* command = app.add_subcommand(
      "apply", "Write calibrations into a problem file or a node's options, with their provenance.");
  command
      ->add_option("calibrations", arguments->calibrations,
                   "Output files (-o) of attitude, drag, disturbance, mass, thrust and heading.")
      ->required()
      ->type_name("FILE...");
  command->add_option("--problem", arguments->problem, "Problem file to calibrate.")->type_name("FILE");
  command
      ->add_option("--options", arguments->options,
                   "Options file of a node to calibrate, as launch/config/firefly.yaml or techpod.yaml.")
      ->type_name("FILE");
  command->add_option("-o,--output", arguments->output, "File to write.")->required()->type_name("FILE");
  command->add_flag("--force", arguments->force, "Use numbers also if the data do not support them.");
  command->callback([arguments, result] { *result = apply(*arguments); });
}

}  // namespace polyfly
