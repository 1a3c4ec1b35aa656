#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace polyfly {

/// The part of a region within a cell of the search tree. Rows refer to planes as MapContent::rows does.
struct CellMember {
  std::uint32_t region = 0;
  /// The region's rows that the cell does not imply: those that a look-up tests.
  std::vector<std::int32_t> rows;
  /// The bounds of the cell, planes of nodes and sides of the box, that bound the part as well.
  std::vector<std::int32_t> walls;
  /// p numbers, strictly inside.
  std::vector<double> inner;
  /// p numbers each, inside or on the border. They show on which sides of a plane the part reaches. The first ones
  /// lie on the rows and then the walls in turn: each shows that its row is needed.
  std::vector<double> points;
  /// Where the rows to test are violated by at most the tolerance of a look-up, and the sides of the box by what look-ups
  /// accept, the region's other rows are by at most so many tolerances. Above kUntestedReach it is no bound.
  double excess = 1.0;

  std::size_t bounds() const { return rows.size() + walls.size(); }
  /// That with index `bound` of the rows and then the walls.
  std::int32_t bound(std::size_t bound) const {
    return bound < rows.size() ? rows[bound] : walls[bound - rows.size()];
  }
};

/// A node of the search tree that is not split yet.
struct Cell {
  std::vector<CellMember> members;
  /// Rows of the planes on the way to it, as MapContent::rows refers to them. They hold inside.
  std::vector<std::int32_t> path;
};

/// The plane that a row refers to.
inline std::size_t planeOf(std::int32_t row) { return static_cast<std::size_t>(row < 0 ? -row : row) - 1; }

}  // namespace polyfly
