#include "offline_mpt/count.hpp"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/read_problem.hpp"
#include "polyfly_base/error.hpp"
#include "progress.hpp"
#include "safety_filter/safe_set.hpp"
#include "signals.hpp"
#include "support/vector_text.hpp"

namespace polyfly {
namespace {

const char kCountFooter[] =
    R"(The command explores as solve does, but stores only the active sets: some tens of bytes each, where solve
takes up to 2 kB. It counts the sets that are proven to be critical regions, also those that are not
explored yet. Whenever it stops, its numbers are lower bounds: of the regions, and of the bytes of the
map. H must be positive definite. offline_mpt/COUNT.md explains what is proven, and how the bytes are
bounded.

--proof writes everything that was counted, with witnesses. 'check_count PROOF --problem PROBLEM' confirms
it; it is an independent program.

Exit codes:
  0  All regions were found, and the map is not proven larger than --map-limit.
  1  The map is larger than --map-limit, or the partition has a gap.
  2  The input is invalid.
  3  Another limit or a signal stopped the command.

Examples:
  offline_mpt count big.json
  offline_mpt count big.json --map-limit 24G --proof big.count --time-limit 3600)";

struct CountArguments {
  std::string problem;
  std::string stats;
  CountOptions count;
  bool quiet = false;
};

std::string gigabytes(std::uint64_t bytes) {
  constexpr double kGibi = 1024.0 * 1024.0 * 1024.0;
  char text[40];
  std::snprintf(text, sizeof text, "%.3g GiB", static_cast<double>(bytes) / kGibi);
  return text;
}

CountResult countWithProgress(const ParametricProgram& program, const CountArguments& options) {
  CountOptions count = options.count;
  count.stop = &stopOnSignal();
  Progress progress(options.quiet);
  count.progress = [&](const ExploreProgress& state) {
    progress.show(std::to_string(state.regions) + " regions proven, " + std::to_string(state.open) +
                  " sets open");
  };
  return countRegions(program, count);
}

bool tooLarge(const CountArguments& options, const CountResult& result) {
  return options.count.map_limit > 0 && result.map_bytes > options.count.map_limit;
}

std::string statsJson(const ParametricProgram& program, const CountArguments& options,
                      const CountResult& result) {
  nlohmann::ordered_json json;
  json["name"] = program.name;
  json["status"] = toString(result.status);
  json["variables"] = program.variableCount();
  json["rows"] = program.rowCount();
  json["parameters"] = program.parameterCount();
  json["inputs"] = program.inputCount();
  json["proven"] = result.count.proven;
  json["active_rows"] = result.count.active_rows;
  json["laws"] = result.count.laws;
  json["map_bytes"] = result.map_bytes;
  json["map_limit"] = options.count.map_limit;
  json["regions"] = result.regions;
  json["unproven"] = result.unproven;
  json["contradicted"] = result.contradicted;
  json["facets"] = result.facets;
  json["described"] = result.described;
  json["open_sets"] = result.open;
  json["count_bytes"] = result.memory_bytes;
  json["cpu_seconds"] = result.cpu_seconds;
  json["threads"] = options.count.threads;
  return json.dump(2) + "\n";
}

std::string text(const ParametricProgram& program, const CountArguments& options, const CountResult& result) {
  const bool complete = result.status == ExploreStatus::kComplete;
  std::string line = program.name + ": " + toString(result.status) + ": ";
  if (complete) {
    line += std::to_string(result.regions) + " regions, ";
    line += result.unproven == 0 ? "all proven" : std::to_string(result.count.proven) + " of them proven";
    line += ", their map takes at least ";
  } else {
    line += "at least " + std::to_string(result.count.proven) + " regions, at least ";
  }
  line += std::to_string(result.map_bytes) + " bytes";
  if (tooLarge(options, result)) line += ": does not fit " + gigabytes(options.count.map_limit);
  return line;
}

ExitCode count(const CountArguments& options) {
  checkOutputs({{options.stats}, {options.count.proof, Output::Kind::kFile}},
               filesOfProblem(options.problem));
  const ParametricProgram program = loadCompleteProgram(options.problem);
  printRemarks(options.problem, program);
  const CountResult result =
      inFile(options.problem, program, [&] { return countWithProgress(program, options); });
  if (result.status == ExploreStatus::kInfeasible)
    throw Error(options.problem + ": infeasible: no parameter in its box admits a solution");
  if (!options.stats.empty()) writeText(options.stats, statsJson(program, options, result));
  if (result.status == ExploreStatus::kIncomplete)
    std::fprintf(stderr, "offline_mpt: %s: the partition has a gap at theta = %s\n", options.problem.c_str(),
                 vectorText(result.witness).c_str());
  if (!options.quiet) std::printf("%s\n", text(program, options, result).c_str());
  return tooLarge(options, result) ? ExitCode::kFailed : exitCode(result.status);
}

}  // namespace

void addCount(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<CountArguments>();
  options->count.threads = defaultThreads();
  CLI::App* command =
      app.add_subcommand("count", "Count the regions of a map without computing it: does it fit?");
  command->footer(kCountFooter);
  command->add_option("PROBLEM", options->problem, "Problem file, .yaml or .json.")->required();
  command
      ->add_option("--map-limit", options->count.map_limit,
                   "Stop when the map is proven to take more bytes; suffixes k, M, G (default: no limit).")
      ->transform(byteCount());
  command->add_option("--proof", options->count.proof,
                      "Write all counted active sets with their witnesses to this file.");
  command->add_option("--region-limit", options->count.region_limit, "Stop after this many proven regions.")
      ->check(wholeNumber<std::uint64_t>(1));
  addExploreLimits(*command, options->count.threads, options->count.time_limit, options->count.memory_limit);
  command->add_option("--stats", options->stats, "Write counts and times to this file as JSON.");
  command->add_flag("--quiet", options->quiet, "Print nothing but errors.");
  command->callback([options, &exit_code] { exit_code = count(*options); });
}

}  // namespace polyfly
