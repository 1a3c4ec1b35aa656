#include <algorithm>

#include "certificate.hpp"

namespace checker {

std::set<std::size_t> Certificate::activeSet(std::size_t index) const {
  std::vector<std::int64_t> rows(claims_[index].active.begin(), claims_[index].active.end());
  if (!claims_[index].is_sliver) {
    const auto first = map_.active.begin() + map_.regions[index].first_active;
    rows.assign(first, first + map_.regions[index].active_count);
  }
  std::set<std::size_t> active;
  for (const std::int64_t row : rows) {
    require(row >= 0 && static_cast<std::size_t>(row) < m_, "an active set names a row that is not there");
    const auto i = static_cast<std::size_t>(row);
    if (equalities_.count(i) > 0 || std::find(basis_.begin(), basis_.end(), i) != basis_.end()) continue;
    require(dropped_.count(i) == 0, "an active set names a dropped row");
    require(active.insert(i).second, "an active set repeats a row");
  }
  return active;
}

/// The map's numbers for a row (p + 1 of them) in t: sign * (entries . theta) + constant.
void Certificate::checkLaw(std::size_t index, const Region& region) const {
  for (std::size_t i = 0; i < q_; ++i) {
    const double* row = map_.laws.data() + (map_.regions[index].law * q_ + i) * (p_ + 1);
    const Vector mapped = scaling_.inBox(row, 1, Fraction(row[p_]));
    Fraction difference, size(1), sum;
    for (std::size_t j = 0; j <= p_; ++j) {
      difference += abs(mapped[j] - region.law[i * (p_ + 1) + j]);
      sum += abs(mapped[j]);
    }
    if (sum > size) size = sum;
    require(difference <= law_tolerance_ * size, "the map's law is not the exact one");
  }
}

/// `row` moved outwards by at most the plane tolerance.
Row Certificate::relaxed(const Row& row) const {
  Integer greatest(0);
  for (std::size_t j = 0; j < p_; ++j) greatest = std::max(greatest, Integer(abs(row[j])));
  Vector result(row.begin(), row.end());
  result.back() += plane_tolerance_ * greatest;
  return primitive(result);
}

/// The map's rows stand for conditions of optimality.
void Certificate::checkMapRows(std::size_t index, Region& region) const {
  const Map::Region& mapped_region = map_.regions[index];
  const Claim& claim = claims_[index];
  require(claim.listed.size() >= mapped_region.row_count, "facets are missing");
  for (std::size_t f = 0; f < mapped_region.row_count; ++f) {
    const auto at = region.rows.find(claim.listed[f]);
    require(at != region.rows.end(), "facet " + claim.listed[f] + " is no condition of optimality");
    const Row& exact = at->second;
    const std::int32_t reference = map_.rows[mapped_region.first_row + f];
    const double* plane = map_.planes.data() + (static_cast<std::size_t>(std::abs(reference)) - 1) * (p_ + 1);
    const int sign = reference > 0 ? -1 : 1;
    const Vector mapped = scaling_.inBox(plane, sign, -sign * Fraction(plane[p_]));
    std::size_t k = 0;
    Fraction squared;
    for (std::size_t j = 0; j < p_; ++j) {
      if (abs(mapped[j]) > abs(mapped[k])) k = j;
      squared += mapped[j] * mapped[j];
    }
    require(sgn(mapped[k]) * sgn(exact[k]) > 0, "a plane of the map is not the exact one");
    Fraction difference = abs(squared - 1) / 2;
    const Fraction factor = mapped[k] / exact[k];
    for (std::size_t j = 0; j <= p_; ++j) difference += abs(mapped[j] - factor * exact[j]);
    require(difference <= plane_tolerance_, "a plane of the map is not the exact one");
    region.plane_error = std::max(region.plane_error, difference);
    region.listed.push_back(exact);
  }
  region.own = region.listed.size();
}

/// The map's rows are right, those that it leaves out follow but for the plane tolerance, all others follow.
void Certificate::checkRows(std::size_t index, Region& region) const {
  const Claim& claim = claims_[index];
  if (!claim.is_sliver) checkMapRows(index, region);
  for (std::size_t f = region.own; f < claim.listed.size(); ++f) {
    const auto at = region.rows.find(claim.listed[f]);
    require(at != region.rows.end(), "facet " + claim.listed[f] + " is no condition of optimality");
    region.listed.push_back(at->second);
  }
  std::vector<const Row*> listed;
  for (const Row& row : region.listed) {
    for (const Row* other : listed) require(!sameHalfSpace(row, *other), "a half-space is listed twice");
    listed.push_back(&row);
  }
  const std::vector<const Row*> own(listed.begin(), listed.begin() + static_cast<std::ptrdiff_t>(region.own));
  const auto follows = [&](const std::string& key, const Row& row, const std::vector<const Row*>& from) {
    if (leastInBox(row) >= 0) return;
    const auto proof = claim.proofs.find(key);
    require(proof != claim.proofs.end(), "row " + key + " is not proven to follow");
    const auto& [scale, weights] = proof->second;
    require(scale > 0, "a proof has a scale that is not positive");
    for (const auto& [place, weight] : weights) require(weight >= 0, "a proof has a negative weight");
    require(leastInBox(remainder(&row, scale, weights, from)) >= 0, "row " + key + " does not follow");
  };
  for (const auto& [origin, row] : region.rows) {
    const bool is_listed = std::find(claim.listed.begin(), claim.listed.end(), origin) != claim.listed.end();
    if (claim.forgiven.count(origin) > 0) {
      const auto at = region.forgiven.find(origin);
      require(at != region.forgiven.end() && !is_listed, origin + " cannot be forgiven");
      follows("W" + origin, at->second, own);
    } else if (!is_listed && origin[0] != 'b') {
      follows("I" + origin, row, listed);
    }
  }
  for (const auto& [origin, row] : region.dropped) follows("D" + origin, row, listed);
  for (std::size_t f = region.own; f < listed.size() && !claim.is_sliver; ++f)
    follows("X" + claim.listed[f], relaxed(*listed[f]), own);
}

void Certificate::checkPoint(const Claim& claim, const Region& region) const {
  require(claim.point.size() == p_, "the inner point is missing");
  for (const Fraction& value : claim.point)
    require(abs(value) < 1, "the inner point lies outside of the box");
  for (const Row& row : region.listed)
    require(valueAt(row, claim.point) > 0, "the inner point does not lie inside");
}

/// A region whose conditions and inner point are checked.
const Region& Certificate::checkedRegion(std::size_t index) const {
  constexpr std::size_t kMostKept = 30000;  // some kB each
  const auto known = checked_.find(index);
  if (known != checked_.end()) return known->second;
  if (checked_.size() >= kMostKept) checked_.clear();
  Region region = describe(index);
  checkRows(index, region);
  checkPoint(claims_[index], region);
  return checked_.emplace(index, std::move(region)).first->second;
}

/// What lies behind a facet: the domain's edge, the edge of the feasible set, one region, or several.
FacetBehind Certificate::checkFacetCover(std::size_t index, const Region& region, std::size_t facet) const {
  FacetBehind behind;
  Line line(claims_[index].closings[facet]);
  const Row& plane = region.listed[facet];
  const std::string kind = line.word();
  if (kind == "domain" || kind == "next") {
    const std::string origin = line.word();
    const auto at = region.rows.find(origin);
    require(at != region.rows.end() && sameHalfSpace(at->second, plane), "a facet is not that of " + origin);
    if (kind == "domain") {
      require(origin[0] == 'd' || origin[0] == 'b', "a facet is not at the edge of the domain");
      behind.is_boundary = true;
    } else {
      require(!singular_ && !widened_ && (origin[0] == 'm' || origin[0] == 's'),
              "a facet of this kind has no single neighbour");
      const std::size_t other = line.count(claims_.size() - 1);
      std::set<std::size_t> changed = region.active;
      const std::size_t row = std::stoull(origin.substr(1));
      if (origin[0] == 'm') {
        changed.erase(row);
      } else {
        changed.insert(row);
      }
      require(activeSet(other) == changed, "the region behind a facet is another one");
      behind.regions.push_back(other);
    }
  } else if (kind == "edge") {
    checkEdge(line, plane);
    behind.is_boundary = true;
  } else if (kind == "out") {
    require(widened_ && facet >= region.own, "a facet of the map is left open");
  } else if (widened_) {
    require(kind == "cover" && facet < region.own, kind + " closes no facet that is moved outwards");
    const std::vector<Row> rows = coveringRows(region, false);
    std::vector<const Row*> cell;
    for (const Row& row : rows) {
      if (!proportional(row, rows[facet])) cell.push_back(&row);
    }
    checkCover(line, &rows[facet], cell, behind.regions);
  } else {
    require(kind == "cover", kind + " closes no facet");
    std::vector<const Row*> cell;
    for (const Row& row : region.listed) {
      if (!proportional(row, plane)) cell.push_back(&row);
    }
    checkCover(line, &plane, cell, behind.regions);
  }
  line.end();
  return behind;
}

/// Rows add up to 0 z <= g(t): beyond g = 0 there is no solution.
void Certificate::checkEdge(Line& line, const Row& plane) const {
  Vector sum(n_), bound(p_ + 1);
  for (const auto& [row, weight] : readWeights(line)) {
    require(row < m_ && dropped_.count(row) == 0, "an edge names a row that is not there");
    const bool any_sign =
        equalities_.count(row) > 0 || std::find(basis_.begin(), basis_.end(), row) != basis_.end();
    require(any_sign || weight >= 0, "an edge has a negative weight");
    for (std::size_t j = 0; j < n_; ++j) sum[j] += weight * data("A").at(row, j);
    const Vector own = this->bound(row);
    for (std::size_t j = 0; j <= p_; ++j) bound[j] += weight * own[j];
  }
  for (const Fraction& value : sum) require(value == 0, "an edge's rows do not cancel");
  require(sameHalfSpace(primitive(bound), plane), "an edge is not the facet's plane");
}

/// What of a region counts in covers: all that is listed, or, moved outwards, what the map lists.
std::vector<Row> Certificate::coveringRows(const Region& region, bool of_sliver) const {
  std::vector<Row> rows = region.listed;
  if (!of_sliver && !widened_) return rows;
  rows.resize(region.own);
  for (Row& row : rows) row = relaxed(row);
  return rows;
}

/// The cell, a part of a facet, is empty, or is cut by the rows of a region behind: what lies outside of each
/// is covered by others, what remains lies in that region. Without a plane it is a part of a sliver, and the
/// rows are those of the map, relaxed.
void Certificate::checkCover(Line& line, const Row* plane, std::vector<const Row*> cell,
                             std::vector<std::size_t>& used) const {
  const std::string kind = line.word();
  if (kind == "e") return requireEmpty(line, cell, plane);
  require(kind == "N", kind + " covers nothing");
  const std::size_t other = line.count((plane != nullptr ? claims_.size() : map_.regions.size()) - 1);
  used.push_back(other);
  const Region& behind = checkedRegion(other);
  require(plane == nullptr || widened_ || valueAt(*plane, claims_[other].point) < 0,
          "a region does not lie behind the facet that it covers");
  const std::vector<Row> rows = coveringRows(behind, plane == nullptr);
  for (const Row& row : rows) {
    const std::string what = line.word();
    require((plane != nullptr && proportional(row, *plane)) == (what == "z"), "a cut along the facet");
    require(!widened_ || what != "z", "a region that ends at the facet covers it");
    if (what == "z") continue;
    Row negated = row;
    for (Integer& value : negated) value = -value;
    std::vector<const Row*> outside = cell;
    outside.push_back(&negated);
    if (what == "e") {
      requireEmpty(line, outside, plane);
    } else {
      require(what == "s", what + " covers nothing");
      checkCover(line, plane, outside, used);
      cell.push_back(&row);
    }
  }
}

/// The map's regions cover the sliver but for the plane tolerance.
std::set<std::size_t> Certificate::checkSliver(std::size_t index, const Region& region) const {
  Line line(claims_[index].cover);
  std::vector<const Row*> cell;
  for (const Row& row : region.listed) cell.push_back(&row);
  std::vector<std::size_t> used;
  checkCover(line, nullptr, cell, used);
  line.end();
  return {used.begin(), used.end()};
}

void Certificate::check() const {
  checkProgram();
  std::set<std::set<std::size_t>> seen;
  std::vector<ProvenRegion> proven(claims_.size());
  for (std::size_t index = 0; index < claims_.size(); ++index) {
    try {
      const Region region = checkedRegion(index);
      require(seen.insert(region.active).second, "another region has the same active set");
      for (std::size_t facet = 0; facet < region.listed.size(); ++facet)
        proven[index].facets.push_back(checkFacetCover(index, region, facet));
      if (widened_) proven[index].facets.resize(region.own);
      proven[index].plane_error = region.plane_error;
      proven[index].is_exact = claims_[index].forgiven.empty();
      if (claims_[index].is_sliver) {
        proven[index].covered_by = checkSliver(index, region);
      } else {
        checkLaw(index, region);
      }
    } catch (const Refused& error) {
      throw Refused("region " + std::to_string(index) + ": " + error.what());
    }
  }
  checkLookups(proven);
}

void Certificate::checkLookups(const std::vector<ProvenRegion>& regions) const {
  const auto rows = [this](std::size_t region) { return coveringRows(checkedRegion(region), false); };
  const auto moved_rows = [this](std::size_t region) { return coveringRows(checkedRegion(region), true); };
  const auto conditions = [this](std::size_t region) { return checkedRegion(region).listed; };
  Lookups(map_, plane_tolerance_, regions, rows, moved_rows, conditions, widened_).check(lookups_);
}

}  // namespace checker
