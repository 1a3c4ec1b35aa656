#pragma once

#include <cstdint>
#include <functional>
#include <memory_resource>
#include <shared_mutex>
#include <vector>

#include "count/law_separation.hpp"
#include "count/strict_complementarity_check.hpp"
#include "explore/parallel/work_queue.hpp"
#include "explore/region/compute_region.hpp"
#include "explore/state/set_queue.hpp"
#include "offline_mpt/count.hpp"

namespace polyfly {

/// What is known of a set's proof.
enum class SetProof : std::uint8_t {
  kNone,
  kProven,
  /// Besides, its law is no other's.
  kProvenLawApart,
};

/// What examining one active set yields.
struct ProvenResult {
  RegionResult region;
  /// Of each neighbour, then of the set itself.
  std::vector<SetProof> proofs;
  /// p numbers for each proof, in their order.
  std::vector<std::int64_t> witnesses;
};

/// How far a count has come.
struct CountState : SetQueue<ProvenResult> {
  /// Gets the sets that are proven, with their witness, in the order in which they count. Rows are those of
  /// the reduced program.
  using Record = std::function<void(RowSpan set, const std::int64_t* witness)>;

  CountState(const ParametricProgram& program, std::uint64_t map_limit, Record record);

  std::uint64_t regionCount() const override { return count.proven; }
  bool enough() const override { return map_limit_ > 0 && leastMapBytes(program_, count) > map_limit_; }
  void merge(const ProvenResult& result) override;

  /// Which of the sets are proven by now. Any thread may ask while another merges: what is proven stays so,
  /// and a proof that comes later is not looked at.
  void findProven(const ActiveSetList& sets, std::vector<char>& proven) const;

  MapCount count;
  // Tight rows of each region that only slacks bound. They show that a region was found before.
  ActiveSetPool tight;
  // Whether each set of `found` is proven.
  std::pmr::vector<bool> is_proven;
  // Whether each described set is one of `regions`.
  std::pmr::vector<bool> is_region;
  // Probes that must lie in some region, p numbers each.
  std::pmr::vector<double> unresolved;
  std::uint64_t regions = 0;
  std::uint64_t unproven = 0;
  std::uint64_t facets = 0;
  std::uint64_t contradicted = 0;
  // The simplex gave up on a set.
  bool failed = false;

 private:
  void prove(std::uint32_t set, SetProof proof, const std::int64_t* witness);
  bool mergeRegion(const RegionResult& result);

  // Guards `found` and `is_proven`.
  mutable std::shared_mutex growing_;
  const ParametricProgram& program_;
  const std::uint64_t map_limit_;
  const Record record_;
};

/// The loop of a count, as each thread runs it: computes and proves the regions of the sets of the queue. Leaves out
/// proofs of what `state` says is proven. `names`: of each row of the reduced program, the row of `system`.
void proveRegions(const NormalisedProgram& program, const ExploreOptions& options,
                  const StrictComplementaritySystem& system, const LawSeparation& gap,
                  const std::vector<int>& names, const CountState& state, WorkQueue<ProvenResult>& queue);

}  // namespace polyfly
