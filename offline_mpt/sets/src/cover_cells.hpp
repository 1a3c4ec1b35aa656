#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "map_regions.hpp"
#include "polytope_sets/double_description.hpp"

namespace polyfly {

/// A polytope by its generators, with its vertices, rounded.
struct CoverCell {
  DoubleDescription cone;
  std::vector<double> vertices;  ///< p numbers for each
};

/// A half-space of a region.
struct CellPlane {
  const double* row = nullptr;  ///< into the map, p + 1 numbers; none where rounded numbers did not choose it
  double sign = 1.0;
  std::vector<Integer> inside;  ///< >= 0 where the half-space holds
};

/// Polytopes of parameters, and the planes of a map that cut them. Rounded numbers weigh planes and sort out, exact
/// ones decide.
class CoverCells {
 public:
  explicit CoverCells(const MapRegions& regions) : regions_(regions) {}

  CoverCell cell(DoubleDescription cone) const;

  /// The part of a cell on one side of a plane.
  CoverCell part(const CoverCell& whole, const CellPlane& plane, bool inside) const;

  /// A region's row, moved outwards.
  CellPlane plane(std::uint32_t region, std::uint32_t row, double move) const;

  /// Regions whose bounding boxes meet that of the cell, so far as rounded numbers tell.
  std::vector<std::uint32_t> near(const CoverCell& cell) const;

  /// Of the candidates, those that reach to this side of the plane.
  std::vector<std::uint32_t> reaching(const std::vector<std::uint32_t>& candidates, const CellPlane& plane,
                                      bool inside) const;

  /// Whether rounded numbers tell that the cell has points outside the region, moved outwards.
  bool reachesOut(const CoverCell& cell, std::uint32_t region, double move) const;

  /// Of the candidates' planes that cut the cell, the one that leaves the fewest candidates on its fuller
  /// side.
  std::optional<CellPlane> bestCut(const CoverCell& cell, const std::vector<std::uint32_t>& candidates) const;

  /// The last resort, without rounded guesses: any plane of any region that cuts the cell, or one moved
  /// outwards.
  std::optional<CellPlane> anyCut(const CoverCell& cell) const;

 private:
  struct RowOf {
    std::uint32_t region;
    std::uint32_t row;
  };
  const double* numbers(std::uint32_t region, std::uint32_t row) const;
  std::vector<RowOf> cuttingRows(const CoverCell& cell, const std::vector<std::uint32_t>& candidates) const;
  std::optional<CellPlane> cutOf(const CoverCell& cell, std::uint32_t region, double move) const;

  const MapRegions& regions_;
};

}  // namespace polyfly
