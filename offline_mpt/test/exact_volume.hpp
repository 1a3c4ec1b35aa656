#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "polytope_sets/exact_polytope.hpp"

namespace polyfly {

/// |det M| of a square matrix given by its rows, by elimination in fractions.
inline Rational determinantSize(std::vector<RationalVector> rows) {
  Rational product(1);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto pivot = std::find_if(rows.begin() + static_cast<std::ptrdiff_t>(k), rows.end(),
                                    [k](const RationalVector& row) { return row[k] != 0; });
    if (pivot == rows.end()) return 0;
    std::swap(rows[k], *pivot);
    product *= rows[k][k];
    for (std::size_t i = k + 1; i < rows.size(); ++i) {
      const Rational factor = rows[i][k] / rows[k][k];
      for (std::size_t j = k; j < rows.size(); ++j) rows[i][j] -= factor * rows[k][j];
    }
  }
  return abs(product);
}

/// Volume of a bounded set, 0 where it is flat: that of its simplices.
inline Rational volume(const ExactPolytope& set) {
  const ExactPolytope smallest = minimal(set);
  if (affineDimension(smallest) < set.dimension) return 0;
  const std::vector<RationalVector> corners = vertices(smallest);
  Rational sum;
  for (const std::vector<std::size_t>& simplex : triangulate(smallest, corners)) {
    std::vector<RationalVector> edges;
    for (std::size_t k = 1; k < simplex.size(); ++k) {
      RationalVector& edge = edges.emplace_back();
      for (std::size_t j = 0; j < corners[0].size(); ++j)
        edge.push_back(corners[simplex[k]][j] - corners[simplex[0]][j]);
    }
    sum += determinantSize(edges);
  }
  for (int k = 2; k <= set.dimension; ++k) sum /= k;
  return sum;
}

}  // namespace polyfly
