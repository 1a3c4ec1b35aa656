#pragma once

#include <cstdint>
#include <deque>
#include <memory_resource>

#include "explore/sets/active_set_pool.hpp"
#include "offline_mpt/partition.hpp"
#include "program/normalised_program.hpp"
#include "support/arena.hpp"

namespace polyfly {

/// Regions while they are found: flat arrays in scaled parameters, a third of what a CriticalRegion takes.
///
/// A region's numbers are its radius, its centre (p), its law (q rows of p + 1) and its half-spaces (a, b)
/// (p + 1 each).
class RegionStore {
 public:
  struct Region {
    const double* numbers;  ///< keep their address
    std::uint32_t set;      ///< index of its active set
    std::uint32_t facets;
  };

  RegionStore(int p, int q, CountedMemory& memory);

  std::size_t numberCount(std::uint32_t facets) const {
    return 1 + static_cast<std::size_t>(p_) + static_cast<std::size_t>(p_ + 1) * (q_ + facets);
  }
  /// Room for the numbers of a region that is added.
  double* add(std::uint32_t set, std::uint32_t facets);

  std::size_t size() const { return regions_.size(); }
  const Region& operator[](std::size_t index) const { return regions_[index]; }

  /// The region in the program's own parameters.
  CriticalRegion region(std::size_t index, const NormalisedProgram& program, RowSpan active) const;

  /// The numbers of the regions before `index` are not used any more.
  void releaseBefore(std::size_t index) { arena_.releaseBefore(regions_[index].numbers); }

 private:
  int p_;
  int q_;
  Arena<double> arena_;
  std::pmr::deque<Region> regions_;
};

}  // namespace polyfly
