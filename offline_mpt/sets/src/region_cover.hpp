#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "cover_cells.hpp"
#include "map_regions.hpp"
#include "polytope_sets/exact_polytope.hpp"

namespace polyfly {

struct CoverOptions {
  /// Number of threads. The answer does not depend on it.
  int threads = 1;
  const std::atomic<bool>* stop = nullptr;
  /// Called now and then from the calling thread with the share that is done: of each polytope that is cut,
  /// the parts count half.
  std::function<void(double)> progress;
};

/// Proves that a polytope of parameters is covered by the regions of a map.
class RegionCover {
 public:
  explicit RegionCover(const MapRegions& regions);

  /// True: every point of the set lies in a region whose half-spaces are moved outwards by the tolerance.
  /// False: gap() is a point of the set, well inside, that is in none; or it was stopped.
  bool covers(const ExactPolytope& set, const CoverOptions& options = {});

  std::uint64_t cells() const { return cells_; }

  /// A cell that lies in no region as it is, but in `region` with its half-spaces moved outwards.
  struct Sliver {
    std::uint32_t region;
    std::vector<std::vector<Integer>> vertices;
  };
  const std::vector<Sliver>& slivers() const { return slivers_; }

  const RationalVector& gap() const { return gap_; }
  bool stopped() const { return stopped_; }

 private:
  using IntegerRow = std::vector<Integer>;
  struct Task;

  enum class Step { kCovered, kGap, kCut };
  Step step(const CoverCell& cell, const std::vector<std::uint32_t>& candidates, Task* parts);
  bool coverCell(const CoverCell& cell, const std::vector<std::uint32_t>& candidates, int depth);
  void settle(Task& task);
  std::vector<Task> firstCuts(const ExactPolytope& set);
  bool merge(std::vector<Task>& tasks);
  bool isCovered(const CoverCell& cell, const std::vector<std::uint32_t>& candidates);
  bool liesIn(const CoverCell& cell, std::uint32_t region, bool moved);
  const std::vector<IntegerRow>& insidesOf(std::uint32_t region, bool moved);
  void storeGap(const CoverCell& cell);

  const MapRegions& regions_;
  CoverCells parts_;
  // Rows of each region, >= 0 inside: as they are, and moved outwards.
  std::vector<std::vector<IntegerRow>> insides_[2];
  std::uint64_t cells_ = 0;
  std::vector<Sliver> slivers_;
  RationalVector gap_;
  const std::atomic<bool>* stop_ = nullptr;
  // Share that is done, in units of 1 / kWhole.
  std::atomic<std::uint64_t>* share_ = nullptr;
  bool stopped_ = false;
};

}  // namespace polyfly
