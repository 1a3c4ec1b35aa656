#include "solve.hpp"

#include <utility>

#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "polyfly_base/error.hpp"
#include "robust_mpc/online_lp.hpp"
#include "robust_mpc/robust_law.hpp"
#include "support/vector_text.hpp"
#include "verify/self_check.hpp"
#include "watch.hpp"

namespace polyfly::python {
namespace {

namespace py = pybind11;

// Of a partition of which nothing can be kept.
void checkRegions(const ParametricProgram& program, const Partition& partition) {
  if (partition.status == ExploreStatus::kInfeasible)
    throw Error(program.name + ": infeasible: no parameter in its box admits a solution");
  if (!partition.regions.empty()) return;
  if (partition.status == ExploreStatus::kUnbounded) {
    throw Error(program.name + ": the cost is unbounded below at theta = " +
                vectorText(partition.unbounded_at) + ", and no set of parameters has a finite optimum");
  }
  throw Error(program.name + ": " + toString(partition.status) +
              " before the first region, nothing was kept");
}

TreeOptions treeOptions(const SolveOptions& options, Watch& watch) {
  TreeOptions tree;
  tree.mode = treeMode(options.tree, {TreeMode::kFast, TreeMode::kAuto, TreeMode::kSmall});
  tree.threads = threadCount(options.threads);
  tree.stop = &watch.stop();
  tree.progress = [&watch](auto done, auto total) {
    watch.look("search tree: " + shareText(done, total, "nodes"));
  };
  return tree;
}

// A map with a wrong answer is no result.
void requireRight(const std::string& name, const AnswerCheck& check) {
  if (!check.fault.empty()) throw Error(name + ": " + check.fault);
}

}  // namespace

TreeMode treeMode(const std::string& name, const std::vector<TreeMode>& modes) {
  std::string names;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    if (name == toString(modes[i])) return modes[i];
    names += (i == 0 ? "" : i + 1 == modes.size() ? " or " : ", ") + std::string(toString(modes[i]));
  }
  throw Error("tree: must be " + names + ", got '" + name + "'");
}

std::unique_ptr<LoadedMap> solveProgram(const ParametricProgram& program, const SolveOptions& options,
                                        py::object progress) {
  if (options.region_limit < 1) throw Error("region_limit: must be at least 1, got 0");
  if (!(options.time_limit >= 0.0))
    throw Error("time_limit: must be at least 0, got " + std::to_string(options.time_limit));
  MapImage image = watched(std::move(progress), [&](Watch& watch) {
    ExploreOptions explore_options;
    explore_options.threads = threadCount(options.threads);
    explore_options.region_limit = options.region_limit;
    explore_options.time_limit = options.time_limit;
    explore_options.memory_limit = options.memory_limit;
    explore_options.stop = &watch.stop();
    explore_options.progress = [&](const ExploreProgress& state) {
      watch.look(std::to_string(state.regions) + " regions, " + std::to_string(state.open) + " open");
    };
    const TreeOptions tree = treeOptions(options, watch);
    const Partition partition = explore(program, explore_options);
    checkRegions(program, partition);
    MapImage solved(encode(program, partition, tree));
    AnswerCheckOptions check;
    check.threads = explore_options.threads;
    check.stop = &watch.stop();
    check.progress = [&](auto done, auto total) {
      watch.look("check: " + shareText(done, total, "samples"));
    };
    requireRight(program.name, checkAnswers(solved.view(program.name), program, check));
    return solved;
  });
  return std::make_unique<LoadedMap>(std::move(image), program.name);
}

std::unique_ptr<LoadedMap> solveRobust(const RobustProblem& problem, const SolveOptions& options,
                                       py::object progress) {
  MapImage image = watched(std::move(progress), [&](Watch& watch) {
    ProjectOptions project;
    project.threads = threadCount(options.threads);
    project.stop = &watch.stop();
    project.progress = [&](auto facets, auto vertices, auto) {
      watch.look("feasible set: " + std::to_string(facets) + " facets, " + std::to_string(vertices) +
                 " vertices");
    };
    const TreeOptions tree = treeOptions(options, watch);
    const FeasibleSet set = projectFeasibleSet(buildRobustProgram(problem), project);
    if (set.interrupted) throw Error(problem.name + ": interrupted, nothing was kept");
    const RoundedLaw rounded = roundLaw(problem, explicitLaw(problem, set), ExploreStatus::kComplete);
    const MapContent content = encode(rounded.program, rounded.partition, tree);
    OnlineLp online(problem);
    requireRight(problem.name,
                 checkAnswers(content, [&](const double* theta) { return online.input(theta); }));
    return MapImage(content);
  });
  return std::make_unique<LoadedMap>(std::move(image), problem.name);
}

}  // namespace polyfly::python
