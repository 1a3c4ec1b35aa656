#include <cstdio>
#include <memory>

#include "command.hpp"
#include "csv.hpp"
#include "mpc_core/read_problem.hpp"
#include "robust_mpc/disturbance_bounds.hpp"

namespace polyfly {
namespace {

const char kBoundsFooter[] =
    R"(FLIGHT has one row for each sampling time of the problem. The columns are its states and inputs, under
their names. A row with a NaN splits the flight.

The command computes the disturbance of each step. The range of each channel lies between order statistics
of these disturbances. It holds for any distribution, but the samples must be independent. Choose --every
for that.

Example:
  offline_mpt bounds aslquad_lateral.yaml hover.csv figure.csv --coverage 0.999 --every 5)";

struct BoundsArguments {
  std::string problem;
  std::vector<std::string> flights;
  std::string json;
  BoundsOptions bounds;
};

ExitCode bound(const BoundsArguments& options) {
  std::vector<std::string> inputs = filesOfProblem(options.problem);
  inputs.insert(inputs.end(), options.flights.begin(), options.flights.end());
  checkOutputs({{options.json}}, inputs);
  const RobustProblem problem = loadRobustProblem(options.problem);
  std::vector<std::string> names;
  for (const auto* signals : {&problem.states, &problem.inputs}) {
    for (const Signal& signal : *signals) names.push_back(signal.name);
  }
  std::vector<std::vector<std::vector<double>>> flights;
  for (const std::string& path : options.flights) flights.push_back(readCsv(path, names));
  const DisturbanceBounds bounds = boundDisturbances(problem, flights, options.bounds);
  if (!options.json.empty()) writeText(options.json, boundsJson(bounds, options.bounds));
  std::fputs(boundsText(bounds, options.bounds).c_str(), stdout);
  return ExitCode::kDone;
}

}  // namespace

void addBounds(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<BoundsArguments>();
  CLI::App* command =
      app.add_subcommand("bounds", "Compute the disturbance ranges of a robust MPC from recorded flights.");
  command->footer(kBoundsFooter);
  command->add_option("PROBLEM", options->problem, "Problem file of type robust_mpc.")->required();
  command->add_option("FLIGHT", options->flights, "CSV files of recorded flights.")->required();
  command
      ->add_option("--coverage", options->bounds.coverage, "Share of the disturbances that a range contains.")
      ->check(numberBetween(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--confidence", options->bounds.confidence, "Confidence that it contains this share.")
      ->check(numberBetween(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--every", options->bounds.every,
                   "Number of steps between samples that count as independent.")
      ->check(wholeNumber<int>(1))
      ->capture_default_str();
  command->add_option("--json", options->json, "Write the result to this file as JSON.");
  command->callback([options, &exit_code] { exit_code = bound(*options); });
}

}  // namespace polyfly
