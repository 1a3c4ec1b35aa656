#include <cstdio>
#include <memory>

#include "command.hpp"
#include "polyfly_base/error.hpp"
#include "polytope_sets/analyze_map.hpp"
#include "progress.hpp"
#include "region_maps/region_map.hpp"
#include "signals.hpp"

namespace polyfly {
namespace {

const char kAnalyzeFooter[] =
    R"(The closed loop is theta+ = F theta + G u(theta) + E d + c. u is the map's law, and d any value in the
model's set of disturbances. Signals are bound by name. offline_mpt/sets/README.md describes model files.

The decision uses rational arithmetic, with the map's doubles at their exact values:

  covered      The regions cover the convex polytope of their outer half-spaces.
  recursive feasibility, invariance
               From every parameter in every region, for every disturbance, the next parameter is in that
               polytope (with --within: in that set). So the map always has an answer again.

A parameter counts as inside up to --tolerance. If a property does not hold, the report shows a parameter,
input, disturbance and successor.

Exit code 0: all properties hold. Exit code 1: a property does not hold; the report says which.

Examples:
  offline_mpt analyze lateral.map --model region_maps/problems/models/multirotor_lateral.yaml
  offline_mpt analyze lateral.map --model lateral.yaml --within safe_set.json --json report.json)";

struct AnalyzeArguments {
  std::string map;
  std::string model;
  std::string within;
  std::string json;
  bool quiet = false;
  AnalyzeOptions analyze;
};

ExitCode analyzeMap(const AnalyzeArguments& options) {
  checkOutputs({{options.json}}, {options.map, options.model, options.within});
  endOnSignal(options.map + ": interrupted: nothing was decided");
  const RegionMap map = RegionMap::open(options.map);
  const SetModel model = loadModel(options.model);
  const ClosedLoopModel loop = bindModel(model, map);
  AnalyzeOptions analyze_options = options.analyze;
  if (!options.within.empty()) analyze_options.within = loadSet(options.within);
  Progress progress(options.quiet);
  analyze_options.progress = [&progress](const char* phase, std::uint64_t done, std::uint64_t total) {
    progress.show(std::string(phase) + ": " + std::to_string(100 * done / total) + " %");
  };
  const AnalyzeReport report = analyze(map, loop, analyze_options);
  progress.finish();
  ignoreSignals();
  if (!options.json.empty()) writeText(options.json, analyzeJson(report, map, model));
  if (!options.quiet) std::fputs(analyzeText(report, map, model).c_str(), stdout);
  return report.holds() ? ExitCode::kDone : ExitCode::kFailed;
}

}  // namespace

void addAnalyze(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<AnalyzeArguments>();
  CLI::App* command = app.add_subcommand(
      "analyze", "Prove that a map's closed loop never leaves the map, or show how it leaves it.");
  command->footer(kAnalyzeFooter);
  command->add_option("MAP", options->map, "Map file.")->required();
  command->add_option("--model", options->model, "Model file: the dynamics of the parameters.")->required();
  command->add_option("--within", options->within,
                      "Set file, in the map's parameters: analyse this set instead of the domain.");
  command
      ->add_option(
          "--tolerance", options->analyze.tolerance,
          "Distance outside a half-space that still counts as inside [half ranges] (default: the map's own).")
      ->check(numberFrom(0.0));
  addThreads(*command, options->analyze.threads);
  command->add_option("--json", options->json, "Write the report to this file as JSON.");
  command->add_flag("--quiet", options->quiet, "Print nothing. The exit code is the answer.");
  command->callback([options, &exit_code] { exit_code = analyzeMap(*options); });
}

}  // namespace polyfly
