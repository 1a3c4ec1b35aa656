// Statement 2: the map's half-spaces are the conditions of optimality, and each region has an interior point.
#include <algorithm>

#include "core/certificate.hpp"

namespace checker {

const Region& Certificate::checkedRegion(std::size_t index) const {
  constexpr std::size_t kMostKept = 30000;  // some kB each
  const auto known = checked_.find(index);
  if (known != checked_.end()) return known->second;
  if (checked_.size() >= kMostKept) checked_.clear();
  Region region = describe(index);
  checkHalfSpaces(index, region);
  checkPoint(claims_[index], region);
  return checked_.emplace(index, std::move(region)).first->second;
}

/// Each row of the map is a condition; all other conditions follow from these and the box.
void Certificate::checkHalfSpaces(std::size_t index, Region& region) const {
  const Claim& claim = claims_[index];
  checkMapRows(index, region);
  require(claim.listed.size() == region.own, "a facet that the map does not have");
  const std::vector<const Row*> listed = distinctRows(region);
  for (const auto& [origin, row] : region.rows) {
    if (!contains(claim.listed, origin)) requireFollows(claim, "follows " + origin, row, listed);
  }
}

/// The first listed rows are the map's, in order.
void Certificate::checkMapRows(std::size_t index, Region& region) const {
  const Map::Region& mapped_region = map_.regions[index];
  const Claim& claim = claims_[index];
  require(claim.listed.size() >= mapped_region.row_count, "facets are missing");
  for (std::size_t f = 0; f < mapped_region.row_count; ++f) {
    const auto at = region.rows.find(claim.listed[f]);
    require(at != region.rows.end(), "facet " + claim.listed[f] + " is no condition of optimality");
    const Row& exact = at->second;
    const Vector mapped = scaling_.mapRow(map_, map_.rows[mapped_region.first_row + f]);
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

std::vector<const Row*> Certificate::distinctRows(const Region& region) const {
  std::vector<const Row*> listed;
  for (const Row& row : region.listed) {
    for (const Row* other : listed) require(!sameHalfSpace(row, *other), "a half-space is listed twice");
    listed.push_back(&row);
  }
  return listed;
}

/// scale * row - sum of weights * listed rows >= 0 in the whole box.
void Certificate::requireFollows(const Claim& claim, const std::string& key, const Row& row,
                                 const std::vector<const Row*>& from) const {
  if (leastInBox(row) >= 0) return;
  const auto proof = claim.proofs.find(key);
  require(proof != claim.proofs.end(), key + ": is not proven");
  const auto& [scale, weights] = proof->second;
  require(scale > 0, "a proof has a scale that is not positive");
  for (const auto& [place, weight] : weights) require(weight >= 0, "a proof has a negative weight");
  require(leastInBox(remainder(&row, scale, weights, from)) >= 0, key + ": is wrong");
}

void Certificate::checkPoint(const Claim& claim, const Region& region) const {
  require(claim.point.size() == p_, "the inner point is missing");
  for (const Fraction& value : claim.point)
    require(abs(value) < 1, "the inner point lies outside of the box");
  for (const Row& row : region.listed)
    require(valueAt(row, claim.point) > 0, "the inner point does not lie inside");
}

}  // namespace checker
