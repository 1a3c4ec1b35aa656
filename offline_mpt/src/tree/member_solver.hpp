#pragma once

#include <cstdint>
#include <vector>

#include "lp/polytope.hpp"
#include "offline_mpt/search_tree.hpp"
#include "tree/cell.hpp"
#include "tree/plane_sides.hpp"

namespace polyfly {

/// Answers questions about one part of a region at a time, by linear programming. One object serves one thread.
class MemberSolver {
 public:
  /// `side_tolerance` as in TreeOptions. `regions` must outlive the object. Throws Error where a region has no centre.
  MemberSolver(const TreeRegions& regions, double side_tolerance);

  /// The whole region, within the box.
  CellMember whole(std::uint32_t region);

  /// Sides of the plane on which known points of the member lie, further away than the tolerance.
  unsigned seenSides(const CellMember& member, std::size_t plane) const;

  /// How far known points of the member lie on a side of the plane, kBelow or kAbove; negative where none does.
  double reachOf(const CellMember& member, std::size_t plane, unsigned side) const;

  /// Sides of the plane to which the member reaches, further than the tolerance. A point on each such side is kept
  /// in the member.
  unsigned sides(CellMember& member, std::size_t plane);

  /// The half of a member that reaches to both sides, on one of them: kBelow or kAbove. The member's points must show
  /// that side.
  CellMember half(const CellMember& member, std::size_t plane, unsigned side);

  /// Makes a member that reaches to one side only a member of the cell on that side.
  void enter(CellMember& member, std::size_t plane, unsigned side) const;

  /// Adds to the rows to test of a member of a leaf those that a parameter may violate by more than 5 tolerances of a
  /// look-up, while it violates the others by at most one. `path` has the planes on the way to the leaf.
  void addRowsForTolerance(CellMember& member, const std::vector<std::int32_t>& path);

  /// The member's rows, which are some of its region's in their order, as MapContent::tests.
  std::uint32_t testsOf(const CellMember& member) const;

  /// The rows to test of a region where `path` leads to a leaf: half, enter and addRowsForTolerance in one. All of them
  /// where the region does not reach there.
  std::uint32_t testsAt(std::uint32_t region, const std::vector<std::int32_t>& path);

  /// Simplex pivots since construction.
  std::uint64_t pivots() const { return solver_.pivots(); }

 private:
  std::size_t parameters() const { return static_cast<std::size_t>(regions_.p); }
  const double* plane(std::size_t index) const { return regions_.planes.data() + index * (parameters() + 1); }
  bool boundsBox(std::int32_t row) const;
  double roundingOf(std::int32_t wall) const;
  void gatherRows(const CellMember& member);
  void gatherRow(std::int32_t row, double moved);
  bool reaches(CellMember& member, std::size_t plane, double side);
  void settle(CellMember& member);
  bool castRay(CellMember& member, std::size_t bound) const;
  void decide(CellMember& member);
  void drop(CellMember& member) const;
  void moveInner(CellMember& part, std::size_t plane, double side, const std::vector<double>& points) const;
  bool crossPlane(const CellMember& member, std::size_t plane, double side, double* crossing) const;
  void addRows(CellMember& member, const std::vector<std::int32_t>& path);

  const TreeRegions& regions_;
  double tolerance_;
  PlaneSides kernels_;
  PolytopeSolver solver_;
  MinimalRows minimal_;
  std::vector<double> rows_;  // p + 1 numbers each, as PolytopeSolver reads them
  std::vector<double> slacks_;
  // Per row and wall of the member in hand, whether a point shows that it is needed.
  std::vector<char> is_settled_;
  std::vector<std::size_t> order_;
  std::vector<std::int32_t> questioned_;
  std::vector<double> ordered_;  // rows in that order
  // Per such row, whether look-ups test it, and by how much they let it be violated.
  std::vector<char> is_tested_;
  std::vector<double> amounts_;
  // A half in the making: what is kept of it is a copy, without memory left over.
  CellMember part_;
  std::vector<double> direction_, point_;
};

}  // namespace polyfly
