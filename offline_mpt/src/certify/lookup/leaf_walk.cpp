#include "certify/lookup/leaf_walk.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "arithmetic/exact_numbers.hpp"
#include "certify/slivers.hpp"
#include "certify/tolerances.hpp"

namespace polyfly {
namespace {

constexpr int kPointBits = 30;                // fraction of a starting point
constexpr int kShareBits = 8;                 // of a share, from its first one on
constexpr std::size_t kMostNear = 30;         // regions of one leaf
constexpr std::size_t kMostNearCells = 5000;  // for one of them
constexpr int kMostStarts = 4;                // starting points of one leaf

// Path rows that hold by less than this at a point press on it, beside the depth of the part.
constexpr long kPressing = 64;

// A positive number rounded down to kShareBits bits.
Rational shareBelow(const Rational& number) {
  const double value = number.get_d();
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  const double bits = std::floor(std::ldexp(fraction, kShareBits) * (1.0 - 0x1p-40));
  return Rational(std::ldexp(bits, exponent - kShareBits));
}

Rational valueOf(const WholeRow& row, const std::vector<Rational>& point) {
  Rational value(row.back());
  for (std::size_t j = 0; j < point.size(); ++j) value += row[j] * point[j];
  return value;
}

bool strictlyHolds(const std::vector<ExactRow>& rows, const std::vector<Rational>& point) {
  return std::all_of(rows.begin(), rows.end(),
                     [&](const ExactRow& row) { return polyfly::valueAt(row, point) > 0; });
}

}  // namespace

LeafWalk::LeafWalk(const LookupContext& context, std::size_t visit)
    : context_(context),
      visit_(visit),
      view_(context.check.map.leaf(context.tree.leaf(visit))),
      path_(context.tree.path(visit)),
      candidates_(view_.candidates, view_.candidates + view_.count),
      near_candidates_(context, view_, context.planes.up(Rational(context.check.options.plane_tolerance)),
                       nullptr, kMostNearCells),
      presses_(path_.size(), 1) {
  std::sort(candidates_.begin(), candidates_.end());
}

Integer LeafWalk::valueAt(std::int32_t row, const std::vector<Rational>& point) const {
  const Rational value = valueOf(context_.planes.row(row), point);
  Integer result;
  mpz_fdiv_q(result.get_mpz_t(), value.get_num_mpz_t(), value.get_den_mpz_t());
  return result;
}

// The point inside the region that is deepest in the path rows.
bool LeafWalk::tryStart(std::uint32_t place, Start& start) const {
  const int p = context_.check.program.p;
  const std::vector<ExactRow> listed = listedRows(context_.check, context_.checks, view_.candidates[place]);
  FloatLp lp(p + 1);
  const auto add = [&](std::vector<double> row, double share) {
    row.insert(row.end() - 1, share);
    lp.add(row);
  };
  for (std::size_t k = 0; k < path_.size(); ++k)
    add(context_.planes.moved(path_[k], 0).unit, presses_[k] != 0 ? 1.0 : tolerance::kLightRow);
  for (const ExactRow& row : listed) add(row.unit, tolerance::kRegionShare);
  for (int side = 0; side < 2 * p; ++side) add(boxRow(p, side).unit, tolerance::kRegionShare);
  std::vector<double> direction(static_cast<std::size_t>(p) + 1, 0.0);
  direction.back() = 1.0;
  if (lp.maximise(direction) != FloatLp::Status::kOptimal || !(lp.objective() > 0.0)) return false;
  for (const bool rounded : {true, false}) {
    std::vector<Rational> point;
    for (int j = 0; j < p; ++j) {
      const double value = lp.x()[static_cast<std::size_t>(j)];
      point.emplace_back(rounded ? std::ldexp(std::nearbyint(std::ldexp(value, kPointBits)), -kPointBits)
                                 : value);
    }
    if (!strictlyInside(point, {}, nullptr) || !strictlyHolds(listed, point)) continue;
    Integer depth = context_.planes.up(1);
    for (std::size_t k = 0; k < path_.size(); ++k) {
      const Integer value = valueAt(path_[k], point);
      if (presses_[k] != 0 || value <= 0) depth = std::min(depth, value);
    }
    if (depth <= start.depth) return false;
    start = {place, std::move(point), std::move(depth)};
    return true;
  }
  return false;
}

bool LeafWalk::findStart(Start& start) const {
  const Integer deep_enough = context_.planes.up(Rational(tolerance::kDeepEnough));
  for (std::uint32_t place = 0; place < view_.count && start.depth < deep_enough; ++place) {
    const RegionCheck& check = context_.checks[view_.candidates[place]];
    if (check.forgiven == 0) tryStart(place, start);
  }
  return !start.point.empty();
}

// A parameter that arrives is moved towards the starting point by a share of its way. The share is so small that a row
// which is tested changes by less than the tolerance.
bool LeafWalk::chooseShare(const Start& start) {
  const WholePlanes& planes = context_.planes;
  Integer greatest(0);
  for (std::uint32_t place = 0; place < view_.count; ++place) {
    const RegionView region = context_.check.map.region(view_.candidates[place]);
    for (std::uint32_t i = 0; i < region.row_count; ++i) {
      if (!isTested(view_.testsOf(place), i)) continue;
      greatest = std::max(greatest, Integer(abs(valueAt(region.rows[i], start.point)) + 1));
    }
  }
  double plane_error = 0.0;
  for (std::uint32_t place = 0; place < view_.count; ++place)
    plane_error = std::max(plane_error, context_.checks[view_.candidates[place]].plane_error);
  const Integer error = planes.up(Rational(plane_error) + Rational(context_.check.options.plane_tolerance));
  const Integer room = planes.tolerance() - 2 * planes.rounding() - error;
  if (room <= 0) return false;
  share_ = shareBelow(Rational(room, greatest + planes.tolerance()));
  depths_.clear();
  for (const std::int32_t row : path_) {
    const Rational depth = valueOf(context_.planes.row(row), start.point) + planes.rounding();
    depths_.push_back(planes.coarselyDown(share_ * depth) - planes.rounding());
  }
  least_depth_ = depths_.empty() ? planes.up(1) : *std::min_element(depths_.begin(), depths_.end());
  path_inside_.clear();
  return true;
}

bool LeafWalk::isCandidate(std::uint32_t region) const {
  return std::binary_search(candidates_.begin(), candidates_.end(), region);
}

// Whether the facet of a candidate does not reach into the part of the leaf.
bool LeafWalk::isOutside(std::uint32_t place, std::uint32_t facet) const {
  const std::uint32_t index = view_.candidates[place];
  const RegionView region = context_.check.map.region(index);
  if (facet >= region.row_count) return false;
  const double error = context_.checks[index].plane_error;
  const auto on_path = std::find(path_.begin(), path_.end(), region.rows[facet]);
  if (on_path != path_.end())
    return depths_[static_cast<std::size_t>(on_path - path_.begin())] >= context_.planes.up(Rational(error));
  if (context_.widened || isTested(view_.testsOf(place), facet)) return false;
  const DroppedRow* const dropped = context_.findDropped(visit_, index, facet);
  return dropped != nullptr && least_depth_ >= 0 &&
         dropped->holdsInside(context_.planes.length(least_depth_).get_d(), error);
}

// Rows that count in the proof of coverage.
std::vector<ExactRow> LeafWalk::rowsOf(std::uint32_t region) const {
  std::vector<ExactRow> rows = listedRows(context_.check, context_.checks, region);
  if (!context_.widened) return rows;
  rows.resize(context_.check.map.region(region).row_count);
  for (ExactRow& row : rows) row = relaxedRow(row, Rational(context_.check.options.plane_tolerance));
  return rows;
}

const std::vector<ExactRow>& LeafWalk::pathInside() {
  for (std::size_t k = path_inside_.size(); k < path_.size(); ++k)
    path_inside_.push_back(context_.planes.moved(path_[k], -depths_[k]));
  return path_inside_;
}

// A point of the leaf's part where the rows hold, or the proof that there is none.
Interior LeafWalk::interiorInside(const std::vector<ExactRow>& rows) {
  ExactRows all;
  for (const auto* const list : {&pathInside(), &rows}) {
    for (const ExactRow& row : *list) all.push_back(&row);
  }
  return findInterior(all, nullptr, context_.check.program.p);
}

// Proves that of the regions about a sliver, moved outwards so that they cover it, only candidates reach into the part.
bool LeafWalk::dismissSliver(std::uint32_t sliver, std::string& text) {
  for (const std::uint32_t region : context_.checks[sliver].covered_by) {
    if (isCandidate(region) || beyond_.count(region) > 0) continue;
    std::vector<ExactRow> rows = listedRows(context_.check, context_.checks, region);
    rows.resize(context_.check.map.region(region).row_count);
    for (ExactRow& row : rows) row = relaxedRow(row, Rational(context_.check.options.plane_tolerance));
    const Interior interior = interiorInside(rows);
    if (interior.exists) return false;
    text += "beyond " + std::to_string(region);
    appendWeights(interior.proof, text);
    text += "\n";
    beyond_.insert(region);
  }
  text += "sliver " + std::to_string(sliver) + "\n";
  return true;
}

// Proves that a region which is no candidate does not matter in the part of the leaf.
bool LeafWalk::dismiss(std::uint32_t region, std::string& text) {
  if (dismissed_.count(region) > 0) return true;
  const std::vector<ExactRow> rows = rowsOf(region);
  const Interior interior = interiorInside(rows);
  if (!interior.exists) {
    text += "outside " + std::to_string(region);
    appendWeights(interior.proof, text);
    text += "\n";
  } else {
    if (!context_.checks[region].is_sliver || !dismissSliver(region, text)) {
      ExactRows cell;
      for (const auto* const list : {&pathInside(), &rows}) {
        for (const ExactRow& row : *list) cell.push_back(&row);
      }
      text += "near " + std::to_string(region);
      if (!near_candidates_.cover(std::move(cell), text)) {
        failed_at_ = interior.point;
        return false;
      }
      text += "\n";
    }
    near_.push_back(region);
  }
  dismissed_.insert(region);
  return true;
}

// `place` is that of a candidate, or not less than the number of candidates.
bool LeafWalk::closeFacets(std::uint32_t region, std::uint32_t place, std::string& text) {
  std::size_t facets = context_.behind[region].size();
  if (context_.widened) facets = context_.check.map.region(region).row_count;
  for (std::uint32_t facet = 0; facet < facets; ++facet) {
    const FacetBehind& behind = context_.behind[region][facet];
    if (behind.kind == FacetCoverKind::kDomain || behind.kind == FacetCoverKind::kEdge) continue;
    const auto is_known = [&](std::uint32_t other) { return isCandidate(other); };
    if (std::all_of(behind.regions.begin(), behind.regions.end(), is_known) ||
        (place < view_.count && isOutside(place, facet)))
      continue;
    for (const std::uint32_t other : behind.regions) {
      if (!isCandidate(other) && !dismiss(other, text)) return false;
    }
  }
  return true;
}

bool LeafWalk::prove(std::string& text) {
  for (int tried = 0; tried < kMostStarts; ++tried) {
    Start start;
    if (!findStart(start) || !chooseShare(start)) return false;
    if (proveFrom(start, text)) return true;
    if (!letPress()) return false;
  }
  return false;
}

// After a proof that failed at a point: path rows next to it are to press, and the starting point to be deeper in them.
// False if they do already.
bool LeafWalk::letPress() {
  if (failed_at_.empty()) return false;
  const std::vector<char> before = presses_;
  if (std::count(before.begin(), before.end(), 0) == 0) presses_.assign(path_.size(), 0);
  for (std::size_t k = 0; k < path_.size(); ++k) {
    if (valueAt(path_[k], failed_at_) < kPressing * abs(depths_[k])) presses_[k] = 1;
  }
  return presses_ != before;
}

bool LeafWalk::proveFrom(const Start& start, std::string& text) {
  dismissed_.clear();
  beyond_.clear();
  near_.clear();
  failed_at_.clear();
  std::string lines = "leaf walk " + std::to_string(start.place) + " " + share_.get_str(16);
  for (const Rational& value : start.point) lines += " " + value.get_str(16);
  lines += "\n";
  for (std::uint32_t place = 0; place < view_.count; ++place) {
    if (!closeFacets(view_.candidates[place], place, lines)) return false;
  }
  for (std::size_t k = 0; k < near_.size() && k < kMostNear; ++k) {
    if (!closeFacets(near_[k], view_.count, lines)) return false;
  }
  if (near_.size() > kMostNear) return false;
  text += lines;
  return true;
}

}  // namespace polyfly
