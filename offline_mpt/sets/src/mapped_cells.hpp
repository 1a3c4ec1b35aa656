#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "map_regions.hpp"
#include "polytope_sets/double_description.hpp"

namespace polyfly {

/// A polytope by its generators, with their images among the parameters, rounded.
struct MappedCell {
  DoubleDescription cone;
  std::vector<double> images;  ///< p numbers for each vertex
};

/// A half-space of a region: in the space of parameters rounded, in that of the cells exact.
struct CellPlane {
  const double* row = nullptr;  ///< into the map, p + 1 numbers; none where rounded numbers did not choose it
  double sign = 1.0;
  std::vector<Integer> inside;  ///< >= 0 where the half-space holds
};

/// Polytopes that y = M x + m takes to the parameters of a map, and the map's planes that cut them. Rounded
/// numbers weigh planes and sort out, exact ones decide.
class MappedCells {
 public:
  MappedCells(const MapRegions& regions, RationalMatrix M, RationalVector m);

  /// Dimension of x.
  int dimension() const { return M_.columns(); }

  MappedCell cell(DoubleDescription cone) const;

  /// The part of a cell on one side of a plane.
  MappedCell part(const MappedCell& whole, const CellPlane& plane, bool inside) const;

  /// A region's row, moved outwards.
  CellPlane plane(std::uint32_t region, std::uint32_t row, double move) const;

  /// Regions whose bounding boxes meet that of the cell, so far as rounded numbers tell.
  std::vector<std::uint32_t> near(const MappedCell& cell) const;

  /// Of the candidates, those that reach to this side of the plane.
  std::vector<std::uint32_t> reaching(const std::vector<std::uint32_t>& candidates, const CellPlane& plane,
                                      bool inside) const;

  /// Whether rounded numbers tell that the cell has points outside the region, moved outwards.
  bool reachesOut(const MappedCell& cell, std::uint32_t region, double move) const;

  /// Of the candidates' planes that cut the cell, the one that leaves the fewest candidates on its fuller
  /// side.
  std::optional<CellPlane> bestCut(const MappedCell& cell,
                                   const std::vector<std::uint32_t>& candidates) const;

  /// The last resort, without rounded guesses: any plane of any region that cuts the cell, or one moved
  /// outwards.
  std::optional<CellPlane> anyCut(const MappedCell& cell) const;

 private:
  struct RowOf {
    std::uint32_t region;
    std::uint32_t row;
  };
  const double* numbers(std::uint32_t region, std::uint32_t row) const;
  std::vector<RowOf> cuttingRows(const MappedCell& cell, const std::vector<std::uint32_t>& candidates) const;
  std::optional<CellPlane> cutOf(const MappedCell& cell, std::uint32_t region, double move) const;

  const MapRegions& regions_;
  RationalMatrix M_;
  RationalVector m_;
  std::vector<double> M_rounded_;
  std::vector<double> m_rounded_;
};

}  // namespace polyfly
