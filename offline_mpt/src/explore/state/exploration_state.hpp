#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "explore/region/compute_region.hpp"
#include "explore/state/region_store.hpp"
#include "explore/state/set_queue.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// How far an exploration has come: all that a checkpoint holds.
struct ExplorationState : SetQueue<RegionResult> {
  explicit ExplorationState(const NormalisedProgram& program);

  std::uint64_t regionCount() const override { return regions.size(); }
  void merge(const RegionResult& result) override;

  // Active rows of regions that only slacks bound: such a region may be found from several active sets.
  ActiveSetPool tight;
  RegionStore regions;
  // Adjacency samples, p numbers each, that no region has been found for yet.
  std::pmr::vector<double> unresolved;
  std::uint64_t degenerate_facets = 0;
  std::uint64_t pivots = 0;
  // The simplex gave up on a set.
  bool failed = false;

 private:
  void mergeRegion(const RegionResult& result);
};

/// The numbers of a region as RegionStore holds them, into `out`.
void copyNumbers(const Region& region, double* out);

}  // namespace polyfly
