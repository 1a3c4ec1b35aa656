#pragma once

#include <string>
#include <vector>

#include "reduce/cell_geometry.hpp"

namespace polyfly {

/// Rows of the pieces that hold on all of them, without redundant ones: the set that a complete map answers,
/// which is convex.
ConvexCell domainOf(CellGeometry& geometry, std::vector<ConvexCell>& pieces, const RowList& box,
                    double slack);

struct Fallback {
  ConvexCell piece;
  bool upper = false;  ///< which kind of saturation
};

struct Separation {
  std::vector<Fallback> fallbacks;  ///< disjoint; what they leave of the domain is not saturated
  std::size_t planes = 0;           ///< that were added
  bool done = false;                ///< otherwise no planes were found; the fallbacks are meaningless
};

/// Divides the domain by planes, which are added to `planes` (those of the geometry), so that each part meets
/// the interior of upper or of lower pieces only. At most `limit` parts.
Separation separate(CellGeometry& geometry, ScaledPlanes& planes, const ConvexCell& domain,
                    const std::vector<ConvexCell>& upper, const std::vector<ConvexCell>& lower,
                    std::size_t limit);

}  // namespace polyfly
