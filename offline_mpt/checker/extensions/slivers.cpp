// Regions so narrow that the map leaves them to their neighbours, and coverage by regions that are moved outwards.
#include <algorithm>

#include "core/tags.hpp"
#include "extensions/extended_certificate.hpp"

namespace checker {

const ExtendedCertificate::FurtherClaim& ExtendedCertificate::further(std::size_t index) const {
  static const FurtherClaim kNone;
  return index < further_.size() ? further_[index] : kNone;
}

std::set<std::size_t> ExtendedCertificate::activeSet(std::size_t index) const {
  if (!isSliver(index)) return Certificate::activeSet(index);
  std::set<std::size_t> active;
  for (const std::size_t row : further(index).active) addActive(static_cast<std::int64_t>(row), active);
  return active;
}

/// The map's rows are right, those that it leaves out follow but for the plane tolerance, all others follow.
void ExtendedCertificate::checkHalfSpaces(std::size_t index, Region& region) const {
  const Claim& claim = claims_[index];
  if (!isSliver(index)) checkMapRows(index, region);
  for (std::size_t f = region.own; f < claim.listed.size(); ++f) {
    const auto at = region.rows.find(claim.listed[f]);
    require(at != region.rows.end(), "facet " + claim.listed[f] + " is no condition of optimality");
    region.listed.push_back(at->second);
  }
  const std::vector<const Row*> listed = distinctRows(region);
  const std::vector<const Row*> own(listed.begin(), listed.begin() + static_cast<std::ptrdiff_t>(region.own));
  const std::set<std::string>& tolerated = further(index).tolerated;
  require(tolerated.empty() || isWidened(), "a row is tolerated where nothing is moved outwards");
  for (const auto& [origin, row] : region.rows) {
    const bool is_listed = contains(claim.listed, origin);
    if (tolerated.count(origin) > 0) {
      const std::string key = "tolerated_follows " + origin;
      const auto at = region.further.find(key);
      require(at != region.further.end() && !is_listed, origin + " cannot be tolerated");
      requireFollows(claim, key, at->second, own);
    } else if (!is_listed) {
      requireFollows(claim, "follows " + origin, row, listed);
    }
  }
  for (const auto& [key, row] : region.further) {
    if (key.rfind("dropped_follows ", 0) == 0) requireFollows(claim, key, row, listed);
  }
  for (std::size_t f = region.own; f < listed.size() && !isSliver(index); ++f)
    requireFollows(claim, "left_out " + claim.listed[f], movedOutwards(*listed[f]), own);
}

/// By at most the plane tolerance.
Row ExtendedCertificate::movedOutwards(const Row& row) const {
  Integer greatest(0);
  for (std::size_t j = 0; j < p_; ++j) greatest = std::max(greatest, Integer(abs(row[j])));
  Vector result(row.begin(), row.end());
  result.back() += plane_tolerance_ * greatest;
  return primitive(result);
}

std::vector<Row> ExtendedCertificate::movedRows(const Region& region) const {
  std::vector<Row> rows;
  for (std::size_t f = 0; f < region.own; ++f) rows.push_back(movedOutwards(region.listed[f]));
  return rows;
}

/// The regions that cover the sliver, moved outwards.
std::set<std::size_t> ExtendedCertificate::checkSliver(std::size_t index, const Region& region) const {
  Line line(further(index).cover);
  std::vector<const Row*> cell;
  for (const Row& row : region.listed) cell.push_back(&row);
  std::vector<std::size_t> used;
  checkMovedCover(line, nullptr, cell, used);
  line.end();
  return {used.begin(), used.end()};
}

/// As Certificate::checkCover, by the map's rows moved outwards, of a facet or, without a plane, of a sliver.
void ExtendedCertificate::checkMovedCover(Line& line, const Row* plane, std::vector<const Row*> cell,
                                          std::vector<std::size_t>& used) const {
  const std::string kind = line.word();
  if (kind == tag::kEmpty) return requireEmpty(line, cell, plane);
  require(kind == tag::kCutByRegion, kind + " covers nothing");
  used.push_back(line.count(map().regions.size() - 1));
  const std::vector<Row> rows = movedRows(checkedRegion(used.back()));
  const auto cover = [&](const std::vector<const Row*>& part) { checkMovedCover(line, plane, part, used); };
  for (const Row& row : rows) {
    require(plane == nullptr || !proportional(row, *plane), "a region that ends at the facet covers it");
    readCut(line, row, plane, cell, cover);
  }
}

FacetBehind ExtendedCertificate::checkFacet(std::size_t index, const Region& region,
                                            std::size_t facet) const {
  Line line(claims_[index].facet_proofs[facet]);
  const std::string kind = line.word();
  if (!isWidened() || kind == "domain" || kind == "edge")
    return Certificate::checkFacet(index, region, facet);
  FacetBehind behind;
  if (kind == "out") {
    require(facet >= region.own, "a facet of the map is left open");
  } else {
    require(kind == "cover" && facet < region.own, kind + " closes no facet that is moved outwards");
    const std::vector<Row> rows = movedRows(region);
    std::vector<const Row*> cell;
    for (const Row& row : rows) {
      if (!proportional(row, rows[facet])) cell.push_back(&row);
    }
    checkMovedCover(line, &rows[facet], cell, behind.regions);
  }
  line.end();
  return behind;
}

}  // namespace checker
