#include "certify/facet_cover.hpp"

#include "polyfly_base/error.hpp"

namespace polyfly {
void appendWeights(const FarkasProof& proof, std::string& text) {
  text += " " + std::to_string(proof.weights.size());
  for (const auto& [row, weight] : proof.weights)
    text += " " + std::to_string(row) + " " + weight.get_str(16);
}

bool vanishesOn(const ExactRow& row, const ExactRow& plane) {
  std::size_t k = 0;
  while (plane.value[k] == 0) ++k;
  for (std::size_t j = 0; j < plane.value.size(); ++j) {
    if (row.value[j] * plane.value[k] != plane.value[j] * row.value[k]) return false;
  }
  return true;
}

FacetCover::FacetCover(const ExactRow* plane, int p, const std::vector<CoverCandidate>& candidates,
                       const std::atomic<bool>* stop)
    : plane_(plane), candidates_(candidates), stop_(stop), p_(p) {}

bool FacetCover::cover(const std::vector<ExactRow>& rows, std::string& text) {
  Cell cell;
  for (const ExactRow& row : rows) {
    if (!vanishes(row)) cell.push_back(&row);
  }
  return coverCell(std::move(cell), 0, text);
}

bool FacetCover::overlaps(const Cell& cell, const CoverCandidate& candidate) const {
  Cell common = cell;
  for (const ExactRow& row : *candidate.rows) {
    if (!vanishes(row)) common.push_back(&row);
  }
  return findInterior(common, plane_, p_).exists;
}

bool FacetCover::coverCell(Cell cell, std::size_t first, std::string& text) {
  if (stop_ != nullptr && stop_->load()) return false;
  const Interior interior = findInterior(cell, plane_, p_);
  if (!interior.exists) {
    text += " e";
    appendWeights(interior.proof, text);
    return true;
  }
  while (first < candidates_.size() && !overlaps(cell, candidates_[first])) ++first;
  if (first == candidates_.size()) {
    uncovered_ = interior.point;
    return false;
  }
  const CoverCandidate& candidate = candidates_[first];
  text += " N " + std::to_string(candidate.region);
  used_.push_back(candidate.region);
  for (const ExactRow& row : *candidate.rows) {
    if (vanishes(row)) {
      text += " z";
      continue;
    }
    if (cell.size() >= kMostCellRows) {
      throw Error("region " + std::to_string(candidate.region) + ": to cover a facet needs cells of " +
                  std::to_string(kMostCellRows) + " rows or more, which no certificate may have");
    }
    negated_.push_back(opposite(row));
    Cell outside = cell;
    outside.push_back(&negated_.back());
    const Interior beyond = findInterior(outside, plane_, p_);
    if (!beyond.exists) {
      text += " e";
      appendWeights(beyond.proof, text);
      continue;
    }
    text += " s";
    if (!coverCell(std::move(outside), first + 1, text)) return false;
    cell.push_back(&row);
  }
  return true;
}

}  // namespace polyfly
