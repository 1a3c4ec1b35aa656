#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "polytope_sets/exact_polytope.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

/// value / by, rounded without exact division: for guesses.
double ratio(const Integer& value, const Integer& by);

/// The regions of a map as exact polytopes and, for guesses, by rounded vertices.
class MapRegions {
 public:
  /// `tolerance` moves half-spaces outwards in `widened`.
  MapRegions(const RegionMap& map, double tolerance);

  std::size_t count() const { return shapes_.size(); }
  int parameters() const { return p_; }

  /// a . theta <= b of row `row` of a region, as the map has it.
  ExactHalfSpace row(std::size_t region, std::uint32_t row) const;

  /// Region and box.
  ExactPolytope polytope(std::size_t region) const;

  /// Its exact vertices (x_0, x): theta = x / x_0. `flat` tells whether it has no interior.
  std::vector<std::vector<Integer>> vertices(std::size_t region, bool& flat) const;

  /// Rounded vertices for the functions below, one region at a time; different regions may be set at once.
  void setShape(std::size_t region, const std::vector<std::vector<Integer>>& vertices);

  /// Numbers of one vertex after the other.
  const std::vector<double>& shape(std::size_t region) const { return shapes_[region]; }

  const RegionMap& map() const { return map_; }
  double tolerance() const { return tolerance_; }

 private:
  const RegionMap& map_;
  double tolerance_;
  int p_;
  std::vector<std::vector<double>> shapes_;
};

struct CoverOptions {
  int threads = 1;  ///< the answer does not depend on it
  const std::atomic<bool>* stop = nullptr;
  /// Called now and then from the calling thread with the share that is done: of each polytope that is cut,
  /// the parts count half.
  std::function<void(double)> progress;
};

/// Proves that a polytope, mapped into the space of parameters, is covered by the regions of a map.
class RegionCover {
 public:
  /// y = M x + m takes the polytope to the parameters.
  RegionCover(const MapRegions& regions, RationalMatrix M, RationalVector m);

  /// True: every point of the set is mapped into a region whose half-spaces are moved outwards by the
  /// tolerance. False: gap() is a point of the set, well inside, whose image is in none; or it was stopped.
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
  struct Plane;
  struct Cell;
  struct Task;
  struct RowOf {
    std::uint32_t region;
    std::uint32_t row;
  };

  enum class Step { kCovered, kGap, kCut };
  Step step(const Cell& cell, const std::vector<std::uint32_t>& candidates, Task* parts);
  bool coverCell(const Cell& cell, const std::vector<std::uint32_t>& candidates, int depth);
  void settle(Task& task);
  std::vector<Task> firstCuts(const ExactPolytope& set);
  bool merge(std::vector<Task>& tasks);
  bool isCovered(const Cell& cell, const std::vector<std::uint32_t>& candidates);
  bool liesIn(const Cell& cell, std::uint32_t region, bool moved);
  const std::vector<IntegerRow>& insidesOf(std::uint32_t region, bool moved);
  static bool cuts(const Cell& cell, const Plane& plane);
  std::vector<RowOf> cuttingRows(const Cell& cell, const std::vector<std::uint32_t>& candidates) const;
  bool choosePlane(const Cell& cell, const std::vector<std::uint32_t>& candidates, Plane& plane) const;
  bool anyPlane(const Cell& cell, Plane& plane) const;
  void storeGap(const Cell& cell);
  Plane planeOf(std::uint32_t region, std::uint32_t row, double move) const;
  Cell cellOf(DoubleDescription cone) const;
  std::vector<std::uint32_t> all() const;
  std::vector<std::uint32_t> near(const Cell& cell) const;

  const MapRegions& regions_;
  RationalMatrix M_;
  RationalVector m_;
  std::vector<double> rounded_M_;
  std::vector<double> rounded_m_;
  std::vector<std::vector<IntegerRow>> insides_[2];  // by region: >= 0 inside
  std::uint64_t cells_ = 0;
  std::vector<Sliver> slivers_;
  RationalVector gap_;
  const std::atomic<bool>* stop_ = nullptr;
  std::atomic<std::uint64_t>* share_ = nullptr;  // done, of kWhole
  bool stopped_ = false;
};

}  // namespace polyfly
