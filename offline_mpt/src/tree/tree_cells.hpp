#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "offline_mpt/polytope.hpp"
#include "offline_mpt/search_tree.hpp"
#include "tree/plane_sides.hpp"

namespace polyfly {

/// The part of a region within a node's cell.
struct CellMember {
  std::uint32_t region = 0;
  std::vector<double> inner;  ///< p numbers, strictly inside
  /// p numbers each, inside or on the border: they show on which sides of a plane the part reaches.
  std::vector<double> points;
};

using CellMembers = std::vector<CellMember>;

/// Regions of a tree with their bounding boxes. Constant, so that threads may share it.
class TreeGeometry {
 public:
  /// `side_tolerance` as in TreeOptions. Work is shared by `threads`; the result does not depend on them.
  /// `progress` may be called with the regions done and all.
  TreeGeometry(const TreeRegions& regions, double side_tolerance, int threads,
               const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

  /// The whole regions, to begin with; once only, they are moved.
  CellMembers takeMembers() { return std::move(members_); }

  const TreeRegions& regions() const { return regions_; }
  double tolerance() const { return tolerance_; }
  double distance(std::size_t plane, const double* point) const {
    return kernels_.distance(row(plane), point, parameters());
  }
  static std::size_t planeOf(std::int32_t row) { return static_cast<std::size_t>(row < 0 ? -row : row) - 1; }
  void appendRow(std::int32_t row,
                 std::vector<double>& rows) const;  ///< p + 1 numbers, as PolytopeSolver reads

  /// Sides that the region may reach: a bound, by its box.
  unsigned boxSides(std::uint32_t region, std::size_t plane) const;

  /// Sides on which the member is known to have points.
  unsigned seenSides(const CellMember& member, std::size_t plane) const;

 private:
  void sample(std::size_t region, PolytopeSolver& solver, std::vector<double>& rows);
  std::size_t parameters() const { return static_cast<std::size_t>(regions_.p); }
  const double* row(std::size_t plane) const { return regions_.planes.data() + plane * (parameters() + 1); }

  const TreeRegions& regions_;
  PlaneSides kernels_;
  double tolerance_;
  std::vector<double> low_, high_;  // bounding boxes
  CellMembers members_;
};

/// Tells by linear programming on which sides of a plane members reach. One object serves one thread.
class CellSplitter {
 public:
  explicit CellSplitter(const TreeGeometry& geometry);

  /// Sides on which the member has a point further than the tolerance from the plane, in the cell that `path`
  /// describes (rows as in TreeRegions). Points that are found are kept in the member.
  unsigned sides(CellMember& member, std::size_t plane, const std::vector<std::int32_t>& path);

  /// Divides the members of the cell that `path` describes, whose sides were found, between the cells below
  /// and above the plane.
  void divide(CellMembers& members, std::size_t plane, const std::vector<std::int32_t>& path,
              const std::vector<unsigned char>& sides, CellMembers& below, CellMembers& above);

 private:
  bool reaches(CellMember& member, double side, std::size_t plane, const std::vector<std::int32_t>& path,
               std::size_t keep);
  void recall(CellMember& member, unsigned sides, std::size_t plane, const std::vector<std::int32_t>& path);
  void enter(CellMember& part, double side, std::size_t plane, const std::vector<double>& points) const;

  const TreeGeometry& geometry_;
  PolytopeSolver solver_;
  std::vector<double> rows_;
  std::vector<double> point_;
};

}  // namespace polyfly
