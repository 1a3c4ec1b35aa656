#include <sys/stat.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "progress.hpp"
#include "region_maps/error.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {
namespace {

const char kFooter[] =
    "The problem is a tracking problem of one axis (.yaml, .yml) or a parametric program in the generic form "
    "(.json).\n"
    "The map does not depend on the number of threads: the same problem gives the same bytes.\n"
    "\n"
    "Stopped by Ctrl-C or by a limit, the regions found so far are written and marked in the map, unless "
    "MAP\n"
    "exists already: it is replaced by a partial result with --force only.\n"
    "\n"
    "Examples:\n"
    "  offline_mpt solve multirotor_lateral.yaml -o lateral.map --stats lateral_stats.json\n"
    "  offline_mpt solve big.json -o big.map --threads 8 --time-limit 600 --quiet";

constexpr std::size_t kLongTree = 1000;  // regions; more take a while

struct Options {
  std::string problem;
  std::string map;
  std::string stats;
  ExploreOptions explore;
  bool quiet = false;
  bool force = false;
};

struct Seconds {
  double load = 0.0;
  double explore = 0.0;
  double encode = 0.0;
  double write = 0.0;
};

class Stopwatch {
 public:
  /// Seconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

Partition exploreWithProgress(const ParametricProgram& program, const Options& options) {
  ExploreOptions explore_options = options.explore;
  explore_options.stop = &stopOnSignal();
  Progress progress(options.quiet);
  explore_options.progress = [&](const ExploreProgress& state) {
    // Each region found so far takes as long as those before; more turn up until the last facets are crossed.
    const double rate = static_cast<double>(state.regions) / progress.elapsed();
    const double remaining = rate > 0.0 ? static_cast<double>(state.open) / rate : -1.0;
    progress.show(std::to_string(state.regions) + " regions, " + std::to_string(state.open) + " open",
                  remaining, true);
  };
  return explore(program, explore_options);
}

ExitCode exitCode(ExploreStatus status) {
  switch (status) {
    case ExploreStatus::kComplete:
      return ExitCode::kDone;
    case ExploreStatus::kIncomplete:
      return ExitCode::kFailed;
    case ExploreStatus::kLimited:
    case ExploreStatus::kInterrupted:
      return ExitCode::kStopped;
    case ExploreStatus::kInfeasible:
      return ExitCode::kBadInput;
  }
  return ExitCode::kBadInput;
}

std::string statsJson(const ParametricProgram& program, const Partition& partition, const RegionMap& map,
                      const Seconds& seconds, int threads) {
  nlohmann::ordered_json json;
  json["name"] = program.name;
  json["status"] = toString(partition.status);
  json["variables"] = program.variableCount();
  json["rows"] = program.rowCount();
  json["parameters"] = program.parameterCount();
  json["inputs"] = program.inputCount();
  json["regions"] = partition.regions.size();
  json["candidate_sets"] = partition.stats.candidate_sets;
  json["degenerate_facets"] = partition.stats.degenerate_facets;
  json["lp_pivots"] = partition.stats.lp_pivots;
  json["cpu_seconds"] = partition.stats.cpu_seconds;
  json["threads"] = threads;
  json["seconds"] = {{"load", seconds.load},
                     {"explore", seconds.explore},
                     {"encode", seconds.encode},
                     {"write", seconds.write}};
  json["laws"] = map.lawCount();
  json["planes"] = map.planeCount();
  json["nodes"] = map.nodeCount();
  json["leaves"] = map.leafCount();
  json["depth"] = map.cost().depth;
  json["region_checks"] = map.cost().region_checks;
  json["multiply_adds"] = map.cost().multiply_adds;
  json["bytes"] = map.bytes();
  if (partition.witness.size() > 0) {
    json["witness"] =
        std::vector<double>(partition.witness.data(), partition.witness.data() + partition.witness.size());
  }
  return json.dump(2) + "\n";
}

std::string vectorText(const Eigen::VectorXd& vector) {
  std::string text = "(";
  char number[32];
  for (Eigen::Index i = 0; i < vector.size(); ++i) {
    std::snprintf(number, sizeof number, "%s%.17g", i > 0 ? ", " : "", vector[i]);
    text += number;
  }
  return text + ")";
}

// True when the result may be written; says why not otherwise.
bool mayWrite(const Options& options, const Partition& partition) {
  if (partition.status == ExploreStatus::kComplete || options.force) return true;
  struct stat status = {};
  const bool exists = ::stat(options.map.c_str(), &status) == 0;
  if (partition.regions.empty()) {
    std::fprintf(stderr, "offline_mpt: %s: %s before the first region, nothing was kept\n",
                 options.map.c_str(), toString(partition.status));
    return false;
  }
  if (exists) {
    std::fprintf(
        stderr,
        "offline_mpt: %s: %s after %zu regions; nothing was kept, the existing file stands (--force)\n",
        options.map.c_str(), toString(partition.status), partition.regions.size());
    return false;
  }
  return true;
}

void reportEnd(const Options& options, const Partition& partition, const RegionMap& map,
               const Seconds& seconds) {
  switch (partition.status) {
    case ExploreStatus::kComplete:
    case ExploreStatus::kInfeasible:
      break;
    case ExploreStatus::kIncomplete:
      std::fprintf(stderr,
                   "offline_mpt: %s: the partition has a gap at theta = %s; kept, marked incomplete\n",
                   options.map.c_str(), vectorText(partition.witness).c_str());
      break;
    case ExploreStatus::kLimited:
    case ExploreStatus::kInterrupted:
      std::fprintf(stderr, "offline_mpt: %s: %s: kept the %zu regions found so far, marked %s\n",
                   options.map.c_str(),
                   partition.status == ExploreStatus::kLimited ? "limit reached" : "interrupted",
                   partition.regions.size(), toString(partition.status));
      break;
  }
  if (options.quiet) return;
  std::printf("%s: %s, %zu regions, %zu laws, depth %u, %zu bytes, explored in %.3g s, tree in %.3g s\n",
              options.map.c_str(), toString(partition.status), map.regionCount(), map.lawCount(),
              map.cost().depth, map.bytes(), seconds.explore, seconds.encode);
}

ExitCode solve(const Options& options) {
  checkWritable(options.map);
  if (!options.stats.empty()) checkWritable(options.stats);
  Stopwatch watch;
  Seconds seconds;
  const ParametricProgram program = loadProgram(options.problem);
  seconds.load = watch.lap();
  const Partition partition = exploreWithProgress(program, options);
  seconds.explore = watch.lap();
  if (partition.status == ExploreStatus::kInfeasible) {
    throw Error(options.problem + ": infeasible: no parameter in its box admits a solution");
  }
  if (!mayWrite(options, partition)) return exitCode(partition.status);
  endOnSignal();
  if (!options.quiet && partition.regions.size() > kLongTree) {
    std::fprintf(stderr, "building the search tree of %zu regions\n", partition.regions.size());
  }
  const MapContent content = encode(program, partition);
  seconds.encode = watch.lap();
  writeMap(content, options.map);
  const RegionMap map = RegionMap::open(options.map);
  seconds.write = watch.lap();
  if (!options.stats.empty()) {
    writeText(options.stats, statsJson(program, partition, map, seconds, options.explore.threads));
  }
  reportEnd(options, partition, map, seconds);
  return exitCode(partition.status);
}

}  // namespace

void addSolve(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<Options>();
  options->explore.threads = defaultThreads();
  CLI::App* command =
      app.add_subcommand("solve", "Solve a problem for all parameters and write the region map");
  command->footer(kFooter);
  command->add_option("PROBLEM", options->problem, "problem file, .yaml or .json")->required();
  command->add_option("-o,--output", options->map, "map file to write")->required();
  command->add_option("--threads", options->explore.threads, "worker threads (default: all processors)")
      ->check(CLI::Range(1, 256));
  command->add_option("--stats", options->stats, "write counts and times as JSON");
  command->add_option("--region-limit", options->explore.region_limit, "stop after so many regions")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--time-limit", options->explore.time_limit, "stop after so many seconds (default: none)")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--quiet", options->quiet, "say nothing but errors");
  command->add_flag("--force", options->force, "let a partial result replace an existing map");
  command->callback([options, &exit_code] { exit_code = solve(*options); });
}

}  // namespace polyfly
