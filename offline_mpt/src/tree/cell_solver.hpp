#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lp/float_lp.hpp"
#include "lp/polytope.hpp"
#include "offline_mpt/search_tree.hpp"
#include "tree/cell.hpp"

namespace polyfly {

/// Answers questions about what a plane leaves of a cell, by linear programming. One object serves one thread.
class CellSolver {
 public:
  /// `regions` must outlive the object.
  explicit CellSolver(const TreeRegions& regions);

  /// Depth of the deepest point of a cell on a side of the plane, kBelow or kAbove, within the box. If it is not decided it
  /// is -inf.
  double depthOf(const Cell& cell, std::size_t plane, unsigned side);

  /// Whether there rounding may take parameters far beyond a corner, along an axis: further than
  /// tolerance::kMostCornerShift times the distance by which they miss planes.
  bool hasSharpCorner(const Cell& cell, std::size_t plane, unsigned side);

  /// Simplex pivots since construction.
  std::uint64_t pivots() const { return (deeper_solver_ ? deeper_solver_->pivots() : 0) + corners_.pivots(); }

 private:
  std::size_t parameters() const { return static_cast<std::size_t>(regions_.p); }
  void gatherRows(const Cell& cell, std::size_t plane, unsigned side);
  void gatherRow(std::int32_t row);
  double leastSlack(const std::vector<double>& point) const;
  double depth(std::vector<double> start);

  const TreeRegions& regions_;
  // In one dimension more, for depths. None where PolytopeSolver does not know so many.
  std::optional<PolytopeSolver> deeper_solver_;
  FloatLp corners_;
  // p + 1 numbers each: the cell's path and the plane.
  std::vector<double> rows_;
};

}  // namespace polyfly
