// Statement 1 of robust maps: at each parameter of a region a plan meets all rows with the region's law.
#include <algorithm>

#include "core/linear_system.hpp"
#include "robust/robust_certificate.hpp"

namespace checker {
namespace {

template <class Number>
Number product(const std::vector<Number>& a, const std::vector<Number>& b) {
  Number sum;
  for (std::size_t j = 0; j < a.size(); ++j) sum += a[j] * b[j];
  return sum;
}

void append(Vector& values, const RobustCertificate::Sparse& entries, std::size_t size) {
  const std::size_t start = values.size();
  values.resize(start + size);
  for (const auto& [place, factor] : entries) values[start + place] += factor;
}

/// The numbers of a row in whole proportions: (bound, y, plan), then (constant, plan) of each term.
Row flat(const RobustCertificate::PlanRow& row, std::size_t predictions) {
  Vector values{row.bound};
  values.insert(values.end(), row.y.begin(), row.y.end());
  append(values, row.z, predictions);
  for (const RobustCertificate::PlanRow::Term& term : row.terms) {
    values.push_back(term.constant);
    append(values, term.z, predictions);
  }
  return primitive(values);
}

}  // namespace

void RobustCertificate::checkProgram() const {
  ExtendedCertificate::checkProgram();
  std::vector<Row> rows;
  for (const PlanRow& row : rows_) rows.push_back(flat(row, predictions_));
  for (std::size_t k = 0; k < points_.size(); ++k) {
    try {
      checkPlan(points_[k], rows);
    } catch (const Refused& error) {
      throw Refused("point " + std::to_string(k) + ": " + error.what());
    }
  }
}

/// In whole numbers: sums of fractions would need a common divisor for each term.
void RobustCertificate::checkPlan(const Point& point, const std::vector<Row>& rows) const {
  Vector values{Fraction(1)};
  values.insert(values.end(), point.y.begin(), point.y.end());
  values.insert(values.end(), point.plan.begin(), point.plan.end());
  const Row whole = primitive(values);
  const std::size_t plan = 1 + point.y.size();
  for (const Row& row : rows) {
    Integer slack = row[0] * whole[0];
    std::size_t k = 1;
    for (; k < whole.size(); ++k) slack -= row[k] * whole[k];
    while (k < row.size()) {
      Integer term = row[k++] * whole[0];
      for (std::size_t j = plan; j < whole.size(); ++j) term += row[k++] * whole[j];
      slack -= abs(term);
    }
    require(slack >= 0, "the plan does not meet a row");
  }
}

ProvenRegion RobustCertificate::checkRegion(std::size_t index, const Region& region) const {
  checkVertices(index, region);
  checkSimplices(index, region);
  return ExtendedCertificate::checkRegion(index, region);
}

/// The points of a region have its law: they are the solution of its active half-spaces.
void RobustCertificate::checkVertices(std::size_t index, const Region& region) const {
  require(simplices_.count(index) > 0, "a region has no simplices");
  const Vector preferred = preferredInput();
  for (const std::size_t k : pointsOf(index)) {
    const Vector& y = points_[k].y;
    for (const std::size_t facet : region.active) {
      const Vector& half_space = half_spaces_[facet];
      require(product(y, half_space) == half_space.back(), "a point does not have the law of its region");
    }
    require(region.active.size() > 1 || product(preferred, y) == y[map().p],
            "a point does not have the law of its region");
  }
}

std::set<std::size_t> RobustCertificate::pointsOf(std::size_t index) const {
  std::set<std::size_t> points;
  for (const Simplex& simplex : simplices_.at(index)) points.insert(simplex.begin(), simplex.end());
  return points;
}

/// The simplices of a region contain it. Suppose that a parameter inside the region lies in none, and on no smaller face
/// as seen from a point in a simplex. On the way there from a simplex, each facet that is crossed belongs to another
/// simplex on its other side: a facet outside of the region is not crossed.
void RobustCertificate::checkSimplices(std::size_t index, const Region& region) const {
  const Row inner = atPoint(claims_[index].point);
  const std::vector<std::set<std::size_t>> outside = pointsOutside(index, region);
  // Inner sides of the simplices at each facet, by its points.
  std::map<Simplex, std::vector<Row>> facets;
  bool holds_point = false;
  for (const Simplex& simplex : simplices_.at(index)) {
    const std::vector<Row> planes = sidesOf(simplex);
    holds_point = holds_point || std::all_of(planes.begin(), planes.end(),
                                             [&](const Row& plane) { return product(plane, inner) >= 0; });
    for (std::size_t k = 0; k < simplex.size(); ++k) {
      Simplex facet = simplex;
      facet.erase(facet.begin() + static_cast<std::ptrdiff_t>(k));
      std::sort(facet.begin(), facet.end());
      const auto holds = [&](const std::set<std::size_t>& points) {
        return std::includes(points.begin(), points.end(), facet.begin(), facet.end());
      };
      if (std::none_of(outside.begin(), outside.end(), holds)) facets[facet].push_back(planes[k]);
    }
  }
  require(holds_point, "no simplex holds the inner point of its region");
  for (const auto& [facet, planes] : facets)
    require(planes.size() == 2 && sameHalfSpace(planes[0], negated(planes[1])),
            "behind the facet of a simplex lies no other");
}

/// For each condition of a region, which of its points do not lie on the inner side. A facet whose points are among
/// them does not reach into the interior of the region.
std::vector<std::set<std::size_t>> RobustCertificate::pointsOutside(std::size_t index,
                                                                    const Region& region) const {
  std::map<std::size_t, Row> points;
  for (const std::size_t k : pointsOf(index)) points.emplace(k, atPoint(inBox(points_[k].y)));
  std::vector<std::set<std::size_t>> result;
  for (const auto& condition : region.rows) {
    const Row& row = condition.second;
    if (std::all_of(row.begin(), row.end() - 1, [](const Integer& value) { return value == 0; })) continue;
    std::set<std::size_t> outside;
    for (const auto& [k, point] : points) {
      if (product(row, point) <= 0) outside.insert(k);
    }
    if (outside.size() >= map().p) result.push_back(std::move(outside));
  }
  return result;
}

/// For each vertex, the plane through all others with this one on its inner side. Refuses a simplex without interior.
std::vector<Row> RobustCertificate::sidesOf(const Simplex& simplex) const {
  const std::size_t size = simplex.size();
  std::vector<Row> system;
  for (std::size_t k = 0; k < size; ++k) {
    system.push_back(atPoint(inBox(points_[simplex[k]].y)));
    system.back().resize(2 * size);
    system.back()[size + k] = 1;
  }
  solveSystem(system, size);
  std::vector<Row> sides(size);
  for (const Row& unknown : system) {
    for (std::size_t k = 0; k < size; ++k) sides[k].push_back(unknown[size + k]);
  }
  return sides;
}

/// A positive multiple of (t, 1) in whole numbers.
Row RobustCertificate::atPoint(Vector t) const {
  t.emplace_back(1);
  return primitive(t);
}

Vector RobustCertificate::inBox(const Vector& theta) const {
  Vector t;
  for (std::size_t j = 0; j < map().p; ++j) t.push_back((theta[j] - scaling_.centre[j]) / scaling_.half[j]);
  return t;
}

}  // namespace checker
