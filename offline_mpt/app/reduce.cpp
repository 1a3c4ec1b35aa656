#include <cstdio>
#include <map>
#include <memory>
#include <utility>

#include "command.hpp"
#include "offline_mpt/reduce_proven.hpp"
#include "polyfly_base/write_file.hpp"
#include "progress.hpp"
#include "region_maps/map_image.hpp"
#include "region_maps/region_map.hpp"
#include "signals.hpp"

namespace polyfly {
namespace {

const char kReduceFooter[] =
    R"(Pairs of regions with the same law are joined where their union is convex.

Before it writes the new map, the command proves that it answers as MAP does, like `verify
--reduced-from`. So a proof of MAP holds for the new map too. If the proof fails, nothing is written (exit
code 1).

Examples:
  offline_mpt reduce lateral.map -o small.map --stats saved.json --certificate small.cert
  check_certificate small.cert --map small.map --reduced-from lateral.map
  offline_mpt reduce lateral.map -o small.map --tree small
  offline_mpt verify small.map --reduced-from lateral.map)";

struct ReduceArguments {
  std::string map;
  std::string output;
  std::string stats;
  std::string certificate;
  ReduceOptions reduce;
  double time_limit = 0.0;
  bool no_proof = false;
  bool quiet = false;
};

struct Result {
  ReduceStats stats;
  std::unique_ptr<MapImage> image;
  ReductionReport report;  // not filled in without a proof
};

Result reduceWithProgress(const RegionMap& map, const ReduceArguments& options) {
  Progress progress(options.quiet);
  ReduceOptions reduce_options = options.reduce;
  reduce_options.progress = progress.counter("joined regions of ", " laws");
  reduce_options.tree_progress = [&progress](std::uint64_t done, std::uint64_t) {
    progress.show("search tree, " + std::to_string(done) + " nodes");
  };
  if (options.no_proof) {
    const ReduceResult result = reduce(map, reduce_options);
    return {result.stats, std::make_unique<MapImage>(result.content), {}};
  }
  ReductionOptions proof;
  proof.threads = options.reduce.threads;
  proof.certificate = !options.certificate.empty();
  proof.progress = progress.counter("proof: ", " regions");
  ProvenReduction proven = reduceProven(map, options.output, reduce_options, proof);
  return {proven.stats, std::make_unique<MapImage>(std::move(proven.image)), std::move(proven.report)};
}

ExitCode reduceMap(const ReduceArguments& options) {
  checkOutputs({{options.output, Output::Kind::kFile}, {options.stats}, {options.certificate}},
               {options.map});
  // Of no phase anything can be kept.
  endOnSignal(options.output + ": interrupted: nothing was written", options.time_limit);
  const RegionMap map = RegionMap::open(options.map);
  const Result result = reduceWithProgress(map, options);
  if (!options.no_proof && !result.report.passed()) {
    if (!options.quiet) std::fputs(reductionText(result.report).c_str(), stdout);
    std::fprintf(stderr, "offline_mpt: %s: the reduced map could not be proven: nothing was written\n",
                 options.output.c_str());
    return ExitCode::kFailed;
  }
  const RegionMap reduced = result.image->view(options.output);
  ignoreSignals();
  writeFileAtomically(options.output, result.image->bytes());
  if (!options.certificate.empty()) writeCertificate(result.report, options.certificate);
  if (!options.stats.empty())
    writeText(options.stats, reduceJson(result.stats, sizeOf(map), sizeOf(reduced), !options.no_proof));
  if (!options.quiet) {
    std::fputs(reduceText(result.stats, sizeOf(map), sizeOf(reduced)).c_str(), stdout);
    std::printf("%s: %s\n", options.output.c_str(),
                options.no_proof ? "written, not proven" : "proven to answer as the original, written");
  }
  return ExitCode::kDone;
}

}  // namespace

void addReduce(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<ReduceArguments>();
  CLI::App* command = app.add_subcommand("reduce", "Write a smaller map with the same answers.");
  command->footer(kReduceFooter);
  command->add_option("MAP", options->map, "Map file.")->required();
  command->add_option("-o,--output", options->output, "Map file to write.")->required();
  const std::map<std::string, TreeMode> trees = {{"auto", TreeMode::kAuto}, {"small", TreeMode::kSmall}};
  command
      ->add_option("--tree", options->reduce.tree,
                   "small: the tree grows as far as it shortens look-ups, and these leave out rows that it "
                   "implies. Default: auto.")
      ->transform(oneOf(trees));
  command
      ->add_option("--law-tolerance", options->reduce.law_tolerance,
                   "Laws that differ by less anywhere in the box count as equal, relative to the greatest "
                   "|bound| of u.")
      ->check(numberFrom(0.0, 1e-8))
      ->capture_default_str();
  command->add_option("--stats", options->stats, "Write sizes before and after to this file as JSON.");
  addThreads(*command, options->reduce.threads);
  addTimeLimit(*command, options->time_limit);
  command->add_flag("--no-proof", options->no_proof, "Write the map without a proof.");
  command
      ->add_option("--certificate", options->certificate,
                   "Write the proof to this file, for check_certificate.")
      ->excludes(command->get_option("--no-proof"));
  command->add_flag("--quiet", options->quiet, "Print nothing but errors.");
  command->callback([options, &exit_code] { exit_code = reduceMap(*options); });
}

}  // namespace polyfly
