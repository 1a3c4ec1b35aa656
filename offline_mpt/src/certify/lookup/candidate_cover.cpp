#include "certify/lookup/candidate_cover.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "certify/facet_cover.hpp"
#include "certify/tolerances.hpp"

namespace polyfly {
namespace {

std::vector<double> toDoubles(const std::vector<Rational>& point) {
  std::vector<double> result;
  for (const Rational& value : point) result.push_back(value.get_d());
  return result;
}

double product(const std::vector<double>& row, const std::vector<double>& point) {
  return std::inner_product(point.begin(), point.end(), row.begin(), 0.0);
}

bool allHold(const std::vector<ExactRow>& rows, const std::vector<Rational>& point,
             const std::vector<double>& rounded) {
  return std::all_of(rows.begin(), rows.end(), [&](const ExactRow& row) {
    const double value = row.unit.back() - product(row.unit, rounded);
    return value > tolerance::kSurely || (value > -tolerance::kSurely && polyfly::valueAt(row, point) >= 0);
  });
}

}  // namespace

std::vector<BoundaryRow> boundaryRows(const LookupContext& context) {
  std::vector<BoundaryRow> result;
  std::set<std::int32_t> known;
  for (std::uint32_t r = 0; r < context.check.map.regionCount(); ++r) {
    const RegionView region = context.check.map.region(r);
    for (std::uint32_t i = 0; i < region.row_count && i < context.behind[r].size(); ++i) {
      const FacetCoverKind kind = context.behind[r][i].kind;
      const bool is_boundary = kind == FacetCoverKind::kDomain || kind == FacetCoverKind::kEdge;
      if (!is_boundary || !known.insert(region.rows[i]).second) continue;
      result.push_back({r, i, region.rows[i], {}});
      for (const Integer& value : context.planes.row(region.rows[i]))
        result.back().rounded.push_back(context.planes.length(value).get_d());
    }
  }
  return result;
}

CandidateCover::CandidateCover(const LookupContext& context, const LeafView& leaf, const Integer& reach,
                               const std::vector<BoundaryRow>* boundary, std::size_t most_cells)
    : context_(context), boundary_(boundary), most_cells_(most_cells) {
  for (std::uint32_t place = 0; place < leaf.count; ++place) {
    const RegionView region = context.check.map.region(leaf.candidates[place]);
    tested_.emplace_back();
    outside_.emplace_back();
    for (std::uint32_t i = 0; i < region.row_count; ++i) {
      if (!isTested(leaf.testsOf(place), i)) continue;
      tested_.back().push_back(context.planes.moved(region.rows[i], reach));
      outside_.back().push_back(opposite(tested_.back().back()));
    }
  }
}

bool CandidateCover::cover(Cell cell, std::string& text) {
  std::vector<std::uint32_t> all(tested_.size());
  std::iota(all.begin(), all.end(), 0u);
  cells_ = 0;
  return coverBy(std::move(cell), std::move(all), text);
}

bool CandidateCover::coverBy(Cell cell, std::vector<std::uint32_t> left, std::string& text) {
  if (context_.check.stopped() || ++cells_ > most_cells_ || cell.size() >= kMostCellRows) return false;
  const Interior interior = findInterior(cell, nullptr, context_.check.program.p);
  if (!interior.exists) {
    text += " e";
    appendWeights(interior.proof, text);
    return true;
  }
  const std::vector<double> rounded = toDoubles(interior.point);
  for (std::size_t k = 0; k < left.size(); ++k) {
    if (allHold(tested_[left[k]], interior.point, rounded))
      return cutByCandidate(std::move(cell), std::move(left), k, text);
  }
  return cutByBoundary(std::move(cell), std::move(left), interior.point, text);
}

bool CandidateCover::cutByCandidate(Cell cell, std::vector<std::uint32_t> left, std::size_t chosen,
                                    std::string& text) {
  const std::uint32_t place = left[chosen];
  left.erase(left.begin() + static_cast<std::ptrdiff_t>(chosen));
  text += " N " + std::to_string(place);
  for (std::size_t i = 0; i < tested_[place].size(); ++i) {
    Cell beyond = cell;
    beyond.push_back(&outside_[place][i]);
    if (!coverBy(std::move(beyond), left, text)) return false;
    cell.push_back(&tested_[place][i]);
  }
  return true;
}

// The plane of the boundary that leaves the point furthest outside.
bool CandidateCover::cutByBoundary(Cell cell, std::vector<std::uint32_t> left,
                                   const std::vector<Rational>& point, std::string& text) {
  const BoundaryRow* furthest = nullptr;
  const std::vector<double> rounded = toDoubles(point);
  double least = context_.check.map.tolerance() - tolerance::kSurely;
  uncovered_ = point;
  if (boundary_ == nullptr) return false;
  for (const BoundaryRow& boundary : *boundary_) {
    const double value = product(boundary.rounded, rounded) + boundary.rounded.back();
    if (value >= least) continue;
    least = value;
    furthest = &boundary;
  }
  if (furthest == nullptr) return false;
  uncovered_.clear();
  text += " b " + std::to_string(furthest->region) + " " + std::to_string(furthest->row);
  moved_boundary_.push_back(context_.planes.moved(furthest->signed_row, -context_.planes.tolerance()));
  cell.push_back(&moved_boundary_.back());
  return coverBy(std::move(cell), std::move(left), text);
}

}  // namespace polyfly
