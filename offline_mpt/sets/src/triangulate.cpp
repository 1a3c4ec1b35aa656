#include <algorithm>
#include <map>
#include <utility>

#include "cone.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

using Indices = std::vector<std::size_t>;

/// Cuts a polytope into simplices: a face is the pyramids from its first vertex over those of its facets that
/// do not hold it.
class Triangulation {
 public:
  /// `rows`: the vertices on each row, of `count` vertices.
  Triangulation(std::size_t dimension, std::size_t count, std::vector<TightSet> rows)
      : dimension_(dimension), rows_(std::move(rows)) {
    TightSet all;
    for (std::size_t k = 0; k < count; ++k) all.set(k);
    Indices chosen;
    add(all, chosen);
  }

  /// Vertices of each simplex.
  const std::vector<Indices>& simplices() const { return simplices_; }

 private:
  // Greatest intersections of the face with a row's face.
  const std::vector<TightSet>& facetsOf(const TightSet& face) {
    const auto known = facets_.find(face);
    if (known != facets_.end()) return known->second;
    std::vector<TightSet> found;
    for (const TightSet& row : rows_) {
      TightSet part = row & face;
      if (part == face || part.count() == 0) continue;
      const auto within = [&](const TightSet& other) { return other.contains(part); };
      if (std::any_of(found.begin(), found.end(), within)) continue;
      found.erase(std::remove_if(found.begin(), found.end(),
                                 [&](const TightSet& other) { return part.contains(other); }),
                  found.end());
      found.push_back(std::move(part));
    }
    return facets_.emplace(face, std::move(found)).first->second;
  }

  void add(const TightSet& face, Indices& chosen) {
    std::size_t apex = 0;
    while (!face.test(apex)) ++apex;
    chosen.push_back(apex);
    if (chosen.size() == dimension_ + 1) {
      simplices_.push_back(chosen);
    } else {
      for (const TightSet& facet : facetsOf(face)) {
        if (!facet.test(apex)) add(facet, chosen);
      }
    }
    chosen.pop_back();
  }

  std::size_t dimension_;
  std::vector<TightSet> rows_;
  std::map<TightSet, std::vector<TightSet>> facets_;
  std::vector<Indices> simplices_;
};

}  // namespace

std::vector<std::vector<std::size_t>> triangulate(const ExactPolytope& set,
                                                  const std::vector<RationalVector>& vertices) {
  // In whole numbers: sums of fractions would need a common divisor for each term.
  const auto whole = [](const Rational& head, const RationalVector& tail) {
    RationalVector values{head};
    values.insert(values.end(), tail.begin(), tail.end());
    return wholeNumbers(values);
  };
  std::vector<std::vector<Integer>> points;
  for (const RationalVector& vertex : vertices) points.push_back(whole(-1, vertex));
  std::vector<TightSet> rows;
  for (const ExactHalfSpace& row : set.rows) {
    const std::vector<Integer> plane = whole(row.b, row.a);
    TightSet on;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (dot(plane, points[k]) == 0) on.set(k);
    }
    rows.push_back(std::move(on));
  }
  return Triangulation(static_cast<std::size_t>(set.dimension), vertices.size(), std::move(rows)).simplices();
}

}  // namespace polyfly
