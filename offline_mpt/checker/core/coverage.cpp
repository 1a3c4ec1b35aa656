// Statement 4: the regions cover all parameters with a solution. Each facet has a proof of what lies behind it.
#include <functional>

#include "core/certificate.hpp"
#include "core/tags.hpp"

namespace checker {

/// Behind a facet lies what has no solution or is outside of the domain, or one region, or several.
FacetBehind Certificate::checkFacet(std::size_t index, const Region& region, std::size_t facet) const {
  FacetBehind behind;
  Line line(claims_[index].facet_proofs[facet]);
  const Row& plane = region.listed[facet];
  const std::string kind = line.word();
  if (kind == "domain") {
    const std::string origin = line.word();
    const auto at = region.rows.find(origin);
    require(at != region.rows.end() && (origin[0] == tag::kDomain || origin[0] == tag::kSideOfBox) &&
                sameHalfSpace(at->second, plane),
            "a facet is not at the edge of the domain");
    behind.is_boundary = true;
  } else if (kind == "edge") {
    checkBoundary(line, plane);
    behind.is_boundary = true;
  } else if (kind == "next") {
    behind.regions.push_back(nextRegion(line, region, plane));
  } else {
    require(kind == "cover", kind + " closes no facet");
    std::vector<const Row*> cell;
    for (const Row& row : region.listed) {
      if (!proportional(row, plane)) cell.push_back(&row);
    }
    checkCover(line, plane, cell, behind.regions);
  }
  line.end();
  return behind;
}

/// The active set of the region behind has the facet's row less, or more.
std::size_t Certificate::nextRegion(Line& line, const Region& region, const Row& plane) const {
  const std::string origin = line.word();
  const auto at = region.rows.find(origin);
  require(at != region.rows.end() && sameHalfSpace(at->second, plane), "a facet is not that of " + origin);
  require(origin[0] == tag::kMultiplier || origin[0] == tag::kSlack,
          "a facet of this kind has no single neighbour");
  const std::size_t other = line.count(claims_.size() - 1);
  std::set<std::size_t> changed = region.active;
  const std::size_t row = std::stoull(origin.substr(1));
  if (origin[0] == tag::kMultiplier) {
    changed.erase(row);
  } else {
    changed.insert(row);
  }
  require(activeSet(other) == changed, "the region behind a facet is another one");
  return other;
}

/// Rows add up to 0 z <= g(t): beyond g = 0 there is no solution.
void Certificate::checkBoundary(Line& line, const Row& plane) const {
  Vector sum(n_), sum_of_bounds(p_ + 1);
  for (const auto& [row, weight] : readWeights(line)) {
    require(row < m_ && !isLeftOut(row), "an edge names a row that is not there");
    require(equalities_.count(row) > 0 || isInBasis(row) || weight >= 0, "an edge has a negative weight");
    for (std::size_t j = 0; j < n_; ++j) sum[j] += weight * data("A").at(row, j);
    const Vector own = bound(row);
    for (std::size_t j = 0; j <= p_; ++j) sum_of_bounds[j] += weight * own[j];
  }
  for (const Fraction& value : sum) require(value == 0, "an edge's rows do not cancel");
  require(sameHalfSpace(primitive(sum_of_bounds), plane), "an edge is not the facet's plane");
}

/// The cell, a part of a facet, is empty, or is cut by the rows of a region behind: what lies outside of each is covered
/// by others, what remains lies in that region.
void Certificate::checkCover(Line& line, const Row& plane, std::vector<const Row*> cell,
                             std::vector<std::size_t>& used) const {
  const std::string kind = line.word();
  if (kind == tag::kEmpty) return requireEmpty(line, cell, &plane);
  require(kind == tag::kCutByRegion, kind + " covers nothing");
  const std::size_t other = line.count(claims_.size() - 1);
  used.push_back(other);
  const std::vector<Row> rows = checkedRegion(other).listed;
  const bool is_behind = valueAt(plane, claims_[other].point) < 0;
  const auto cover = [&](const std::vector<const Row*>& part) { checkCover(line, plane, part, used); };
  for (const Row& row : rows) {
    const bool is_along = line.next(tag::kAlongPlane);
    require(proportional(row, plane) == is_along, "a cut along the facet");
    require(is_behind || !is_along, "a region does not lie behind the facet that it covers");
    if (!is_along) readCut(line, row, &plane, cell, cover);
  }
}

void readCut(Line& line, const Row& row, const Row* plane, std::vector<const Row*>& cell,
             const std::function<void(const std::vector<const Row*>&)>& cover) {
  require(cell.size() < kMostCellRows, "a cover is nested too deeply");
  const std::string what = line.word();
  const Row other_side = negated(row);
  std::vector<const Row*> outside = cell;
  outside.push_back(&other_side);
  if (what == tag::kEmpty) return requireEmpty(line, outside, plane);
  require(what == tag::kOutsideCovered, what + " covers nothing");
  cover(outside);
  cell.push_back(&row);
}

bool Certificate::isLeftOut(std::size_t) const { return false; }

bool Certificate::isInBasis(std::size_t row) const { return contains(basis_, row); }

}  // namespace checker
