#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "explore/region/compute_region.hpp"
#include "explore/state/region_store.hpp"
#include "program/normalised_program.hpp"
#include "support/arena.hpp"

namespace polyfly {

/// How far an exploration has come: all that a checkpoint holds.
struct ExplorationState {
  explicit ExplorationState(const NormalisedProgram& program);
  ExplorationState(const ExplorationState&) = delete;
  ExplorationState& operator=(const ExplorationState&) = delete;

  std::uint64_t open() const { return found.size() - described; }

  /// Merges the result of the set number `described`.
  void merge(const RegionResult& result);

  // Of all containers below.
  CountedMemory memory;
  // Active sets in the order in which they were found.
  ActiveSetPool found;
  // Sets of `found` that were merged.
  std::uint64_t described = 0;
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
