#include "offline_mpt/explore.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <atomic>
#include <cstring>
#include <functional>
#include <memory>

#include "explore/parallel/compute_regions.hpp"
#include "explore/parallel/coordinator.hpp"
#include "explore/parallel/scheduler.hpp"
#include "explore/parallel/worker_pool.hpp"
#include "explore/region/compute_region.hpp"
#include "explore/region/tolerances.hpp"
#include "explore/state/checkpoint.hpp"
#include "explore/state/exploration_state.hpp"
#include "polyfly_base/error.hpp"
#include "program/equality_check.hpp"
#include "program/normalised_program.hpp"
#include "program/slater_point.hpp"
#include "program/unbounded_cost.hpp"
#include "support/in_parallel.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kReturnedAtOnce = 50'000;  // regions whose first form is given back to the system

Eigen::VectorXd unscaled(const NormalisedProgram& program, const Eigen::VectorXd& t) {
  return program.centre + program.half.cwiseProduct(t);
}

bool stopped(const ExploreOptions& options) { return options.stop != nullptr && options.stop->load(); }

// Whether theta satisfies the region's rows but for `tolerance`; most regions are out after a row or two.
bool contains(const CriticalRegion& region, const Eigen::VectorXd& theta, double tolerance) {
  for (Eigen::Index i = 0; i < region.g.size(); ++i) {
    if (region.G.row(i).dot(theta) > region.g(i) + tolerance) return false;
  }
  return true;
}

// A probe that none of its facet's own candidates holds must lie in some other region, or where the cost has
// no end.
void checkUnresolved(const NormalisedProgram& program, const ExploreOptions& options,
                     const std::pmr::vector<double>& unresolved, UnboundedCost& unbounded,
                     Partition& partition) {
  const auto p = static_cast<std::size_t>(program.p);
  for (std::size_t i = 0; i + p <= unresolved.size(); i += p) {
    if (stopped(options)) {
      partition.status = ExploreStatus::kInterrupted;
      return;
    }
    const Eigen::VectorXd t = Eigen::Map<const Eigen::VectorXd>(unresolved.data() + i, program.p);
    const Eigen::VectorXd theta = unscaled(program, t);
    const bool held = std::any_of(
        partition.regions.begin(), partition.regions.end(),
        [&](const CriticalRegion& region) { return contains(region, theta, tolerance::kHeldProbe); });
    if (held || unbounded.direction(t)) continue;
    if (isEdge(program, t)) continue;
    partition.status = ExploreStatus::kIncomplete;
    partition.witness = theta;
    return;
  }
}

// The heap keeps what is freed in pieces, which for large explorations would be as much as the regions take.
void returnFreedMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

// Regions sorted by active set, whatever the order in which they were found. Their numbers are freed on the
// way: both forms side by side would be the most memory that an exploration ever takes.
void convertRegions(const NormalisedProgram& program, ExplorationState& state, Partition& partition) {
  partition.regions.reserve(state.regions.size());
  for (std::size_t k = 0; k < state.regions.size(); ++k) {
    partition.regions.push_back(state.regions.region(k, program, state.found[state.regions[k].set]));
    state.regions.releaseBefore(k);
    if ((k + 1) % kReturnedAtOnce == 0) returnFreedMemory();
  }
  std::sort(partition.regions.begin(), partition.regions.end(),
            [](const CriticalRegion& a, const CriticalRegion& b) { return a.active < b.active; });
}

/// Whether a set, described anew, gives the numbers that a checkpoint holds of it; nullptr: none.
bool isDescribedAlike(const ExplorationState& state, std::uint32_t set, const RegionStore::Region* stored,
                      RegionWorkspace& worker) {
  const RowSpan rows = state.found[set];
  const ActiveSet active(rows.begin(), rows.end());
  Region region;
  const bool is_region = worker.builder.build(active, region) == BuildStatus::kRegion;
  if (stored == nullptr) return !is_region || region.isKnownByTightRows(active.size());
  if (!is_region || region.facets.size() != stored->facets) return false;
  std::vector<double> numbers(state.regions.numberCount(stored->facets));
  copyNumbers(region, numbers.data());
  return std::memcmp(numbers.data(), stored->numbers, numbers.size() * sizeof(double)) == 0;
}

// Each set of a checkpoint is described anew, without what lies beyond its facets: about half of the work that they took.
// Other bits tell of an edited file, or of another solver, whose regions would not go together with these.
void checkDescribed(const NormalisedProgram& program, const ExploreOptions& options,
                    const ExplorationState& state) {
  std::vector<const RegionStore::Region*> stored(state.described, nullptr);
  for (std::size_t k = 0; k < state.regions.size(); ++k) stored[state.regions[k].set] = &state.regions[k];
  std::vector<std::unique_ptr<RegionWorkspace>> workers;
  for (int k = 0; k < workerCount(options); ++k)
    workers.push_back(std::make_unique<RegionWorkspace>(program, options));
  std::atomic<std::uint64_t> first{state.described};  // that differs
  const auto report = [&](std::uint64_t done, std::uint64_t) {
    if (options.progress) options.progress({state.regions.size(), state.open(), done, 0, false});
  };
  inParallel(state.described, workerCount(options), nullptr, report,
             [&](std::size_t thread, std::uint64_t i) {
               if (isDescribedAlike(state, static_cast<std::uint32_t>(i), stored[i], *workers[thread]))
                 return;
               for (std::uint64_t least = first; i < least && !first.compare_exchange_weak(least, i);)
                 continue;
             });
  if (first == state.described) return;
  throw Error(options.checkpoint + ": active set " + std::to_string(first) +
              " gives another region: the file was edited, or written by another build of the solver");
}

void resume(const NormalisedProgram& program, const ExploreOptions& options, std::uint64_t key,
            const ActiveSet& first, ExplorationState& state) {
  loadCheckpoint(options.checkpoint, key, program, state);
  const RowSpan start = state.found[0];
  if (!std::equal(start.begin(), start.end(), first.begin(), first.end()))
    throw Error(options.checkpoint + ": was written by another build of the solver");
  checkDescribed(program, options, state);
}

// What is made of the regions may take longer than they did, and be stopped: a complete exploration is saved,
// too. A disk that has no room for that may still have it for the map. False if it was not saved.
bool savedAtEnd(const std::function<void()>& save, ExploreStatus status) {
  if (status != ExploreStatus::kComplete) {
    save();
    return true;
  }
  try {
    save();
  } catch (const Error&) {
    return false;
  }
  return true;
}

// The method: while active sets are open, one is popped, its region is computed, and its neighbours are pushed. Each
// thread runs this loop, computeRegions, on batches of sets; with a group, the threads of the other processes, too.
// The scheduler is the queue. It merges the results in the order of their sets, whoever computed them.
ExploreStatus computeAll(const NormalisedProgram& program, const ExploreOptions& options, std::uint64_t key,
                         ExplorationState& state, ExploreStats& stats) {
  std::function<void()> save;
  if (!options.checkpoint.empty()) save = [&] { saveCheckpoint(options.checkpoint, key, state); };
  Scheduler<RegionResult> queue(state, options, save);
  const auto loop = [&](WorkQueue<RegionResult>& open) { computeRegions(program, options, open); };
  if (options.group != nullptr && options.group->size() > 1) {
    stats.lost_process = runWithGroup(*options.group, program, key, workerCount(options), queue, loop);
  } else {
    runWorkers<RegionResult>(workerCount(options), queue, loop);
  }
  const ExploreStatus status = queue.result();
  if (save && state.regions.size() > 0) stats.unsaved = !savedAtEnd(save, status);
  return status == ExploreStatus::kComplete && state.failed ? ExploreStatus::kIncomplete : status;
}

// Where the regions leave out parameters that have solutions: the cost falls without end there. Of an
// exploration that was stopped, to look behind all facets could take as long as it was given.
void noteUnbounded(const NormalisedProgram& program, const ExploreOptions& options, UnboundedCost& unbounded,
                   Partition& partition) {
  const bool complete = partition.status == ExploreStatus::kComplete;
  const std::optional<Eigen::VectorXd> t =
      complete ? unbounded.witness(partition.regions, options.stop) : unbounded.quickWitness();
  if (unbounded.cutShort()) partition.status = ExploreStatus::kInterrupted;
  if (!t) return;
  if (complete) partition.status = ExploreStatus::kUnbounded;
  partition.unbounded_at = unscaled(program, *t);
}

Partition exploreFrom(const NormalisedProgram& program, const Eigen::VectorXd& feasible,
                      UnboundedCost& unbounded, std::uint64_t key, const ExploreOptions& options) {
  Partition partition;
  ExplorationState state(program);
  RegionWorkspace worker(program, options);
  ActiveSet first;
  const std::optional<Eigen::VectorXd> start = unbounded.start(feasible);
  if (!start) {  // without a region, all is found
    partition.status = ExploreStatus::kComplete;
    noteUnbounded(program, options, unbounded, partition);
    return partition;
  }
  if (!findStart(program, *start, worker, first)) {
    partition.status = ExploreStatus::kIncomplete;
    partition.witness = unscaled(program, *start);
    noteUnbounded(program, options, unbounded, partition);
    return partition;
  }
  if (options.resume) {
    resume(program, options, key, first, state);
  } else {
    state.found.insert({first.data(), first.size()});
  }
  partition.stats.resumed_regions = state.regions.size();
  partition.status = computeAll(program, options, key, state, partition.stats);
  convertRegions(program, state, partition);
  if (partition.status == ExploreStatus::kComplete)
    checkUnresolved(program, options, state.unresolved, unbounded, partition);
  noteUnbounded(program, options, unbounded, partition);
  for (std::size_t i = 0; i < worker.builder.nearRows().size(); ++i) {
    if (worker.builder.nearRows()[i] != 0) partition.near_rows.push_back(program.row_ids[i]);
  }
  partition.stats.regions = partition.regions.size();
  partition.stats.candidate_sets = state.found.size();
  partition.stats.open_sets = state.open();
  partition.stats.degenerate_facets = state.degenerate_facets;
  partition.stats.lp_pivots = state.pivots;
  partition.stats.memory_bytes = state.memory.peak();
  return partition;
}

}  // namespace

const char* toString(ExploreStatus status) {
  switch (status) {
    case ExploreStatus::kComplete:
      return "complete";
    case ExploreStatus::kIncomplete:
      return "incomplete";
    case ExploreStatus::kLimited:
      return "limited";
    case ExploreStatus::kInterrupted:
      return "interrupted";
    case ExploreStatus::kInfeasible:
      return "infeasible";
    case ExploreStatus::kUnbounded:
      return "unbounded";
  }
  return "unknown";
}

Partition explore(const ParametricProgram& program, const ExploreOptions& options) {
  checkProgram(program);
  checkEqualities(program);
  ParametricProgram explicit_equalities = program;
  const SlaterPoint margin = findSlaterPoint(explicit_equalities);
  if (!margin.feasible) return {};
  const NormalisedProgram scaled = normalise(explicit_equalities);
  if (scaled.domain_empty) return {};
  UnboundedCost unbounded(explicit_equalities, scaled);
  return exploreFrom(scaled, margin.t, unbounded, fingerprint(program, options), options);
}

}  // namespace polyfly
