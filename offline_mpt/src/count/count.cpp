#include "offline_mpt/count.hpp"

#include <algorithm>
#include <ctime>
#include <optional>

#include "count/count_proof.hpp"
#include "count/count_state.hpp"
#include "explore/parallel/scheduler.hpp"
#include "explore/parallel/worker_pool.hpp"
#include "explore/region/compute_region.hpp"
#include "explore/region/tolerances.hpp"
#include "polyfly_base/error.hpp"
#include "program/equality_check.hpp"
#include "program/feasible_slack.hpp"
#include "program/slater_point.hpp"
#include "region_maps/format.hpp"

namespace polyfly {
namespace {

/// What a scheduler and its pool go by.
ExploreOptions exploreOptions(const CountOptions& options) {
  ExploreOptions explore;
  explore.threads = options.threads;
  explore.region_limit = options.region_limit > 0 ? options.region_limit : ~std::uint64_t{0};
  explore.time_limit = options.time_limit;
  explore.memory_limit = options.memory_limit;
  explore.stop = options.stop;
  explore.checkpoint_period = 0.0;
  explore.progress = options.progress;
  return explore;
}

/// Of each row of the reduced program, the first row of the program that says the same.
std::vector<int> rowNames(const NormalisedProgram& reduced, const StrictComplementaritySystem& system) {
  std::vector<int> names;
  for (const int row : reduced.row_ids) names.push_back(system.first_of[static_cast<std::size_t>(row)]);
  std::vector<int> sorted = names;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    throw Error(reduced.source.name + ": rows that are equal cannot be told apart from their neighbours");
  return names;
}

// Whether all probes that no candidate of their facet holds lie in some region, or where nothing is feasible.
bool settled(const NormalisedProgram& program, RegionWorkspace& worker, const CountState& state,
             Eigen::VectorXd& witness) {
  const auto p = static_cast<std::size_t>(program.p);
  Region region;
  for (std::size_t i = 0; i + p <= state.unresolved.size(); i += p) {
    const double* const t = state.unresolved.data() + i;
    bool held = false;
    for (std::uint32_t k = 0; k < state.found.size() && !held; ++k) {
      const ActiveSet set(state.found[k].begin(), state.found[k].end());
      held = worker.builder.holds(set, t, tolerance::kHeldProbe) &&
             worker.builder.build(set, region) == BuildStatus::kRegion;
    }
    if (held || isEdge(program, Eigen::Map<const Eigen::VectorXd>(t, program.p))) continue;
    witness = program.centre + program.half.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(t, program.p));
    return false;
  }
  return true;
}

/// Counts the regions of one program.
class Counting {
 public:
  Counting(const ParametricProgram& program, const NormalisedProgram& reduced,
           const StrictComplementaritySystem& system, const CountOptions& options)
      : program_(program),
        reduced_(reduced),
        system_(system),
        options_(options),
        names_(rowNames(reduced, system)),
        gap_(findLawSeparation(program)) {
    if (!options.proof.empty()) proof_.emplace(options.proof, program, gap_.weights);
  }

  CountResult from(const Eigen::VectorXd& feasible) {
    ExploreOptions plain;
    RegionWorkspace worker(reduced_, plain);
    ActiveSet first;
    if (!findStart(reduced_, feasible, worker, first)) {
      result_.status = ExploreStatus::kIncomplete;
      result_.witness = reduced_.centre + reduced_.half.cwiseProduct(feasible);
      return result_;
    }
    count(first, worker);
    if (proof_) proof_->commit();
    return result_;
  }

 private:
  CountState::Record record() {
    if (!proof_) return {};
    return [this](RowSpan set, const std::int64_t* witness) {
      rows_.clear();
      for (const std::uint16_t row : set) rows_.push_back(names_[row]);
      proof_->add(rows_, witness);
    };
  }

  void count(const ActiveSet& first, RegionWorkspace& worker) {
    CountState state(program_, options_.map_limit, record());
    state.found.insert({first.data(), first.size()});
    const ExploreOptions explore = exploreOptions(options_);
    Scheduler<ProvenResult> scheduler(state, explore, {});
    runWorkers<ProvenResult>(workerCount(explore), scheduler, [&](WorkQueue<ProvenResult>& queue) {
      proveRegions(reduced_, explore, system_, gap_, names_, state, queue);
    });
    result_.status = scheduler.result();
    if (result_.status == ExploreStatus::kComplete &&
        (state.failed || !settled(reduced_, worker, state, result_.witness)))
      result_.status = ExploreStatus::kIncomplete;
    result_.count = state.count;
    result_.regions = state.regions;
    result_.unproven = state.unproven;
    result_.facets = state.facets;
    result_.contradicted = state.contradicted;
    result_.described = state.described;
    result_.open = state.open();
    result_.map_bytes = leastMapBytes(program_, state.count);
    result_.memory_bytes = state.memory.peak();
  }

  const ParametricProgram& program_;
  const NormalisedProgram& reduced_;
  const StrictComplementaritySystem& system_;
  const CountOptions& options_;
  const std::vector<int> names_;
  const LawSeparation gap_;
  std::vector<int> rows_;
  std::optional<CountProof> proof_;
  CountResult result_;
};

}  // namespace

std::uint64_t leastMapBytes(const ParametricProgram& program, const MapCount& count) {
  if (count.proven == 0) return 0;
  const auto p = static_cast<std::uint64_t>(program.parameterCount());
  const auto q = static_cast<std::uint64_t>(program.inputCount());
  const std::uint64_t region =
      sizeof(MapContent::Region) + sizeof(std::int32_t) * (p + 1) + sizeof(std::uint32_t);
  return sizeof(format::Header) + sizeof(format::Bounds) * (p + q) + region * count.proven +
         sizeof(std::int32_t) * count.active_rows +
         sizeof(double) * q * (p + 1) * std::max<std::uint64_t>(1, count.laws);
}

CountResult countRegions(const ParametricProgram& program, const CountOptions& options) {
  const std::clock_t cpu_start = std::clock();
  checkProgram(program);
  checkEqualities(program);
  const StrictComplementaritySystem system(program);
  ParametricProgram explicit_equalities = program;
  const SlaterPoint margin = findSlaterPoint(explicit_equalities);
  if (!margin.feasible) return {};
  const NormalisedProgram reduced = normalise(explicit_equalities);
  if (reduced.domain_empty) return {};
  if (reduced.linear || reduced.semidefinite)
    throw Error(program.name + ": H: must be positive definite to count");
  CountResult result = Counting(program, reduced, system, options).from(margin.t);
  result.cpu_seconds = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  return result;
}

}  // namespace polyfly
