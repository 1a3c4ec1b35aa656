#include "offline_mpt/explore.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <optional>

#include "explore/parallel/region_round.hpp"
#include "explore/region/compute_region.hpp"
#include "explore/region/tolerances.hpp"
#include "explore/state/checkpoint.hpp"
#include "explore/state/exploration_state.hpp"
#include "polyfly_base/error.hpp"
#include "program/equality_check.hpp"
#include "program/normalised_program.hpp"
#include "program/slater_point.hpp"
#include "program/unbounded_cost.hpp"

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
void checkDescribed(const ExploreOptions& options, const ExplorationState& state, RegionThreads& threads) {
  std::vector<const RegionStore::Region*> stored(state.described, nullptr);
  for (std::size_t k = 0; k < state.regions.size(); ++k) stored[state.regions[k].set] = &state.regions[k];
  std::atomic<std::uint64_t> first{state.described};  // that differs
  const auto report = [&](std::uint64_t done, std::uint64_t) {
    if (options.progress) options.progress({state.regions.size(), state.open(), done, 0, false});
  };
  threads.forEach(state.described, report, [&](RegionWorkspace& workspace, std::uint64_t i) {
    if (isDescribedAlike(state, static_cast<std::uint32_t>(i), stored[i], workspace)) return;
    for (std::uint64_t least = first; i < least && !first.compare_exchange_weak(least, i);) continue;
  });
  if (first == state.described) return;
  throw Error(options.checkpoint + ": active set " + std::to_string(first) +
              " gives another region: the file was edited, or written by another build of the solver");
}

void resume(const NormalisedProgram& program, const ExploreOptions& options, std::uint64_t key,
            const ActiveSet& first, RegionThreads& threads, ExplorationState& state) {
  loadCheckpoint(options.checkpoint, key, program, state);
  const RowSpan start = state.found[0];
  if (!std::equal(start.begin(), start.end(), first.begin(), first.end()))
    throw Error(options.checkpoint + ": was written by another build of the solver");
  checkDescribed(options, state, threads);
}

using Clock = std::chrono::steady_clock;

/// What ends an exploration before all sets are described.
class ExploreLimits {
 public:
  ExploreLimits(const ExploreOptions& options, const ExplorationState& state)
      : options_(options), state_(state) {}

  /// Whether it was interrupted, or its time is over.
  bool isOver() const {
    return stopped(options_) || (options_.time_limit > 0.0 &&
                                 Clock::now() - begin_ > std::chrono::duration<double>(options_.time_limit));
  }

  /// How the exploration ends now, if it does.
  std::optional<ExploreStatus> reached() const {
    if (stopped(options_)) return ExploreStatus::kInterrupted;
    const bool is_full = state_.regions.size() >= options_.region_limit ||
                         (options_.memory_limit > 0 && state_.memory.bytes() >= options_.memory_limit);
    if (is_full || isOver()) return ExploreStatus::kLimited;
    return std::nullopt;
  }

 private:
  const ExploreOptions& options_;
  const ExplorationState& state_;
  const Clock::time_point begin_ = Clock::now();
};

/// Writes the checkpoint now and then, and at the end.
class CheckpointWriter {
 public:
  CheckpointWriter(const ExploreOptions& options, std::uint64_t key, const ExplorationState& state)
      : options_(options),
        key_(key),
        state_(state),
        next_(Clock::now() + secondsOf(options.checkpoint_period)) {}

  /// Whether the disk had no room when it was last due.
  bool unsaved() const { return unsaved_; }

  void saveIfDue() {
    const Clock::time_point before = Clock::now();
    if (options_.checkpoint.empty() || options_.checkpoint_period <= 0.0 || before < next_) return;
    // A full disk must not cost the work: the next attempt, or the last, may succeed.
    unsaved_ = !isSaved();
    const std::chrono::duration<double> taken = Clock::now() - before;
    next_ = Clock::now() + secondsOf(std::max(options_.checkpoint_period, taken.count() / kSavingShare));
  }

  /// What is made of the regions may take longer than they did, and be stopped: a complete exploration is saved, too. A disk
  /// that has no room for that may still have it for the map. False if it was not saved. Throws Error of another exploration.
  bool saveAtEnd(ExploreStatus status) {
    if (options_.checkpoint.empty() || state_.regions.size() == 0) return true;
    if (status == ExploreStatus::kComplete) return isSaved();
    saveCheckpoint(options_.checkpoint, key_, state_);
    return true;
  }

 private:
  // Greatest share of the time that saving may take.
  static constexpr double kSavingShare = 0.05;

  static Clock::duration secondsOf(double seconds) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }

  bool isSaved() const {
    try {
      saveCheckpoint(options_.checkpoint, key_, state_);
    } catch (const Error&) {
      return false;
    }
    return true;
  }

  const ExploreOptions& options_;
  std::uint64_t key_;
  const ExplorationState& state_;
  Clock::time_point next_;
  bool unsaved_ = false;
};

// The method: while active sets are open, the oldest ones are taken, their regions are computed, and the neighbours of
// these are put behind the others. Results are merged in the order of their sets, whoever computed them.
ExploreStatus describeOpenSets(const ExploreOptions& options, RegionRound& round,
                               CheckpointWriter& checkpoint, ExplorationState& state) {
  const ExploreLimits limits(options, state);
  std::vector<RegionResult> results;
  while (state.open() > 0) {
    if (const std::optional<ExploreStatus> end = limits.reached()) return *end;
    const std::uint64_t count = std::min(state.open(), round.size());
    const std::uint64_t computed = round.compute(
        state.found, static_cast<std::uint32_t>(state.described), count, [&] { return limits.isOver(); },
        results);
    for (std::uint64_t k = 0; k < computed; ++k) {
      if (const std::optional<ExploreStatus> end = limits.reached()) return *end;
      state.merge(results[k]);
    }
    checkpoint.saveIfDue();
    if (options.progress) {
      options.progress(
          {state.regions.size(), state.open(), state.described, state.memory.bytes(), checkpoint.unsaved()});
    }
  }
  return ExploreStatus::kComplete;
}

ExploreStatus computeAll(const NormalisedProgram& program, const ExploreOptions& options, std::uint64_t key,
                         RegionThreads& threads, ExplorationState& state, ExploreStats& stats) {
  CheckpointWriter checkpoint(options, key, state);
  ExploreStatus status = ExploreStatus::kInterrupted;
  try {
    RegionRound round(program, options, key, threads);
    status = describeOpenSets(options, round, checkpoint, state);
  } catch (const LostProcess& lost) {
    stats.lost_process = lost.rank();
  }
  stats.unsaved = !checkpoint.saveAtEnd(status);
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
  RegionThreads threads(program, options);
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
    resume(program, options, key, first, threads, state);
  } else {
    state.found.insert({first.data(), first.size()});
  }
  partition.stats.resumed_regions = state.regions.size();
  partition.status = computeAll(program, options, key, threads, state, partition.stats);
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
