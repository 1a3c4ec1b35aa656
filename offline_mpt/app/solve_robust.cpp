#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "offline_mpt/encode.hpp"
#include "progress.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"
#include "robust_mpc/online_lp.hpp"
#include "robust_mpc/robust_law.hpp"
#include "signals.hpp"
#include "solve_report.hpp"
#include "verify/self_check.hpp"

namespace polyfly {
namespace {

/// Stopped, it leaves the half-spaces found so far in the checkpoint.
FeasibleSet projectWithProgress(const RobustProgram& program, const SolveArguments& options) {
  Progress progress(options.quiet);
  ProjectOptions project;
  if (options.explore.resume) project.known = readCuts(checkpointOf(options), program);
  project.stop = &stopOnSignal();
  double saved = 0.0;  // when [s]
  project.save = [&](const std::vector<FeasibleSet::Facet>& cuts) {
    const double now = progress.elapsed();
    if (!stopRequested() &&
        (options.explore.checkpoint_period == 0.0 || now < saved + options.explore.checkpoint_period))
      return;
    writeCuts(checkpointOf(options), cuts);
    saved = now;
  };
  project.threads = options.explore.threads;
  project.progress = [&](std::uint64_t facets, std::uint64_t vertices, std::uint64_t open) {
    progress.show("feasible set: " + std::to_string(facets) + " facets, " + std::to_string(vertices) +
                  " vertices, " + std::to_string(open) + " to cut off");
  };
  return projectFeasibleSet(program, project);
}

std::string statsOf(const FeasibleSet& set, const RobustLaw& law, const RegionMap& map,
                    const PhaseClock& clock) {
  nlohmann::ordered_json json;
  json["name"] = std::string(map.name());
  json["status"] = std::string(map.solverStatus());
  json["facets"] = set.facets.size();
  json["vertices"] = set.vertices.size();
  json["vertices_proven"] = set.stats.vertices_proven;
  json["linear_programs"] = set.stats.linear_programs;
  json["lp_pivots"] = set.stats.pivots;
  json["exact_programs"] = set.stats.exact_programs;
  json["exact_cuts"] = set.stats.exact_cuts;
  json["regions"] = law.regions.size();
  json["laws"] = map.lawCount();
  json["depth"] = map.cost().depth;
  json["bytes"] = map.bytes();
  json["seconds"] = clock.seconds;
  return json.dump(2) + "\n";
}

}  // namespace

ExitCode solveRobust(const SolveArguments& options) {
  const std::string unwritten = options.map + ": stopped, nothing was written";
  endOnSignal(unwritten, options.time_limit);
  PhaseClock clock;
  const RobustProblem problem = loadRobustProblem(options.problem);
  const RobustProgram program = buildRobustProgram(problem);
  const FeasibleSet set = projectWithProgress(program, options);
  const std::string stopped = unwritten + "; " + checkpointOf(options) +
                              " holds half-spaces of the feasible set; " + "continue with --resume";
  if (set.interrupted) endNow(stopped);
  writeCuts(checkpointOf(options), set.facets);
  endOnSignal(stopped);
  clock.end("project");
  const RobustLaw law = explicitLaw(problem, set);
  const RoundedLaw rounded = roundLaw(problem, law, ExploreStatus::kComplete);
  clock.end("regions");
  TreeOptions tree;
  tree.threads = options.explore.threads;
  tree.mode = options.tree_mode;
  tree.node_limit = options.tree_nodes;
  const MapContent content = encode(rounded.program, rounded.partition, tree);
  clock.end("encode");
  OnlineLp online(problem);
  const AnswerCheck check = checkAnswers(content, [&](const double* theta) { return online.input(theta); });
  clock.end("check");
  ignoreSignals();
  if (!check.fault.empty()) {
    std::fprintf(stderr, "offline_mpt: %s: not written: %s\n", options.map.c_str(), check.fault.c_str());
    ::unlink(checkpointOf(options).c_str());
    return ExitCode::kFailed;
  }
  writeMap(content, options.map);
  ::unlink(checkpointOf(options).c_str());
  const RegionMap map = RegionMap::open(options.map);
  clock.end("write");
  if (!options.stats.empty()) writeText(options.stats, statsOf(set, law, map, clock));
  if (!options.quiet) {
    const auto seconds = [&](const char* phase) { return clock.seconds[phase].get<double>(); };
    std::printf(
        "%s: complete, %zu regions, %zu laws, depth %u, %zu bytes; feasible set of %zu facets and %zu "
        "vertices, each proven, in %.3g s, regions in %.3g s, tree in %.3g s\n",
        options.map.c_str(), map.regionCount(), map.lawCount(), map.cost().depth, map.bytes(),
        set.facets.size(), set.vertices.size(), seconds("project"), seconds("regions"), seconds("encode"));
  }
  return ExitCode::kDone;
}

}  // namespace polyfly
