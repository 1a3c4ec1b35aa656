#include "solve_robust.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "offline_mpt/encode.hpp"
#include "polyfly_base/read_text.hpp"
#include "progress.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"
#include "robust_mpc/robust_law.hpp"
#include "signals.hpp"
#include "stopwatch.hpp"

namespace polyfly {
namespace {

FeasibleSet projectWithProgress(const RobustProgram& program, const SolveRobustOptions& options) {
  Progress progress(options.quiet);
  ProjectOptions project;
  project.threads = options.threads;
  project.progress = [&](std::uint64_t facets, std::uint64_t vertices, std::uint64_t open) {
    progress.show("feasible set: " + std::to_string(facets) + " facets, " + std::to_string(vertices) +
                      " vertices, " + std::to_string(open) + " to cut off",
                  -1.0);
  };
  return projectFeasibleSet(program, project);
}

std::string statsOf(const FeasibleSet& set, const RobustLaw& law, const RegionMap& map, double project,
                    double regions, double encode) {
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
  json["seconds"] = {{"project", project}, {"regions", regions}, {"encode", encode}};
  return json.dump(2) + "\n";
}

}  // namespace

bool isRobustFile(const std::string& path) {
  if (!endsWith(path, ".yaml") && !endsWith(path, ".yml")) return false;
  return isRobustProblem(readText(path), path);
}

ExitCode solveRobust(const SolveRobustOptions& options) {
  // Of no phase anything can be kept.
  endOnSignal(options.map + ": stopped, nothing was written", options.time_limit);
  Stopwatch watch;
  const RobustProblem problem = loadRobustProblem(options.problem);
  const RobustProgram program = buildRobustProgram(problem);
  const FeasibleSet set = projectWithProgress(program, options);
  const double project_time = watch.lap();
  const RobustLaw law = explicitLaw(problem, set);
  const RoundedLaw rounded = roundLaw(problem, law, ExploreStatus::kComplete);
  const double region_time = watch.lap();
  TreeOptions tree;
  tree.threads = options.threads;
  tree.mode = options.tree_mode;
  tree.node_limit = options.tree_nodes;
  const MapContent content = encode(rounded.program, rounded.partition, tree);
  ignoreSignals();
  writeMap(content, options.map);
  const RegionMap map = RegionMap::open(options.map);
  const double encode_time = watch.lap();
  if (!options.stats.empty())
    writeText(options.stats, statsOf(set, law, map, project_time, region_time, encode_time));
  if (!options.quiet) {
    std::printf(
        "%s: complete, %zu regions, %zu laws, depth %u, %zu bytes; feasible set of %zu facets and %zu "
        "vertices, each proven, in %.3g s, regions in %.3g s, tree in %.3g s\n",
        options.map.c_str(), map.regionCount(), map.lawCount(), map.cost().depth, map.bytes(),
        set.facets.size(), set.vertices.size(), project_time, region_time, encode_time);
  }
  return ExitCode::kDone;
}

}  // namespace polyfly
