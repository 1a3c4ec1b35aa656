#pragma once

#include <cstdint>
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
  /// Whether the input is saturated at its upper bound.
  bool upper = false;
};

struct Separation {
  /// Disjoint fallback regions. Nothing else of the domain is saturated.
  std::vector<Fallback> fallbacks;
  /// Number of planes that were added.
  std::size_t planes = 0;
  /// False: no planes were found, and the fallbacks are meaningless.
  bool done = false;
  /// The search stopped at kMostSeparationSteps.
  bool limited = false;
};

/// Linear programs that the search for planes may solve. Counted, so that the same map gives the same bytes.
constexpr std::uint64_t kMostSeparationSteps = 12'000'000;

/// Divides the domain by planes, which are added to `planes` (those of the geometry), so that each part meets
/// the interior of upper or of lower pieces only. At most `limit` parts, and `most_steps` linear programs.
Separation separate(CellGeometry& geometry, ScaledPlanes& planes, const ConvexCell& domain,
                    const std::vector<ConvexCell>& upper, const std::vector<ConvexCell>& lower,
                    std::size_t limit, std::uint64_t most_steps = kMostSeparationSteps);

}  // namespace polyfly
