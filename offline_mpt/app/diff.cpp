#include "offline_mpt/diff.hpp"

#include <cstdio>
#include <memory>

#include "command.hpp"
#include "progress.hpp"
#include "region_maps/region_map.hpp"
#include "signals.hpp"

namespace polyfly {
namespace {

const char kDiffFooter[] =
    R"(For each pair of regions that meet, the command computes where and by how much at most the two laws
differ. It also tells whether each map answers wherever the other one does, within its tolerance. It
computes with rational numbers, so nothing is missed between samples. The maps need the same parameters and
inputs; ranges may differ.

Exit code 0: the same answers within the tolerance, everywhere. 1: different answers.

Examples:
  offline_mpt diff old.map new.map
  offline_mpt diff lateral.map small.map --tolerance 1e-6 --json differences.json)";

struct DiffArguments {
  std::string first;
  std::string second;
  std::string json;
  DiffOptions diff;
  bool quiet = false;
};

ExitCode diffTwoMaps(const DiffArguments& arguments) {
  checkOutputs({{arguments.json}}, {arguments.first, arguments.second});
  endOnSignal(arguments.second + ": interrupted: nothing was compared");
  const RegionMap first = RegionMap::open(arguments.first);
  const RegionMap second = RegionMap::open(arguments.second);
  Progress progress(arguments.quiet);
  DiffOptions options = arguments.diff;
  options.progress = progress.counter("compared ", " regions");
  const DiffReport report = diffMaps(first, second, options);
  progress.finish();
  ignoreSignals();
  std::vector<std::string> inputs;
  for (const Signal& input : first.inputs()) inputs.push_back(input.name);
  if (!arguments.json.empty()) writeText(arguments.json, diffJson(report, inputs));
  if (!arguments.quiet) std::fputs(diffText(report, inputs).c_str(), stdout);
  return report.same() ? ExitCode::kDone : ExitCode::kFailed;
}

}  // namespace

void addDiff(CLI::App& app, ExitCode& exit_code) {
  auto arguments = std::make_shared<DiffArguments>();
  CLI::App* command = app.add_subcommand("diff", "Tell where and by how much at most two maps differ.");
  command->footer(kDiffFooter);
  command->add_option("A", arguments->first, "Map file.")->required();
  command->add_option("B", arguments->second, "Map file.")->required();
  command
      ->add_option("--tolerance", arguments->diff.tolerance,
                   "Differences of u up to this one count as none, in the unit of u.")
      ->check(numberFrom(0.0))
      ->capture_default_str();
  command->add_option("--json", arguments->json,
                      "Write the report with all differences to this file as JSON.");
  addThreads(*command, arguments->diff.threads);
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors.");
  command->callback([arguments, &exit_code] { exit_code = diffTwoMaps(*arguments); });
}

}  // namespace polyfly
