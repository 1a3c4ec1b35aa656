#include "certify/facet_cover_proof.hpp"

#include <algorithm>
#include <cmath>

#include "arithmetic/exact_numbers.hpp"
#include "certify/facet_cover.hpp"
#include "certify/slivers.hpp"
#include "certify/tolerances.hpp"
#include "exact_kkt/exact_active_set.hpp"
#include "offline_mpt/exact_lp.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

constexpr int kWitnessBits = 24;  // a witness is searched 2^-24 behind a facet, then nearer
constexpr int kWitnessTries = 30;

bool onePlane(const std::vector<double>& a, const std::vector<double>& b, int sign) {
  for (std::size_t j = 0; j < a.size(); ++j) {
    if (std::abs(a[j] - sign * b[j]) > tolerance::kTouchingPlanes) return false;
  }
  return true;
}

}  // namespace

std::vector<int> changedSet(std::vector<int> active, const ExactOrigin& origin) {
  if (origin.kind != ExactOrigin::Kind::kSlack) {
    active.erase(std::remove(active.begin(), active.end(), origin.index), active.end());
  } else {
    active.insert(std::upper_bound(active.begin(), active.end(), origin.index), origin.index);
  }
  return active;
}

FacetCoverProof::FacetCoverProof(const CheckContext& context, const std::vector<RegionCheck>& checks,
                                 bool widened)
    : context_(context), checks_(checks), users_(context.map.planeCount()) {
  for (std::uint32_t r = 0; r < checks.size(); ++r) {
    if (checks[r].described) by_active_set_.emplace(checks[r].active, r);
    if (checks[r].is_sliver) continue;
    const RegionView view = context.map.region(r);
    for (std::uint32_t f = 0; f < view.row_count; ++f) {
      const int number = static_cast<int>(r) + 1;
      users_[static_cast<std::size_t>(std::abs(view.rows[f])) - 1].push_back(view.rows[f] > 0 ? number
                                                                                              : -number);
    }
  }
  const int p = context.program.p;
  for (std::size_t k = 0; k < context.map.planeCount(); ++k) {
    const double* plane = context.map.plane(k);
    std::vector<double> unit;
    double constant = plane[p];
    for (int j = 0; j < p; ++j) {
      unit.push_back(plane[j] * context.program.half[j].get_d());
      constant -= plane[j] * context.program.centre[j].get_d();
    }
    unit.push_back(constant);
    planes_.push_back(std::move(unit));
  }
  const Rational distance(context.options.plane_tolerance);
  for (std::uint32_t r = 0; widened && r < context.map.regionCount(); ++r) {
    wide_.push_back(checks[r].described ? mapRows(context, checks, r) : std::vector<ExactRow>());
    for (ExactRow& row : wide_.back()) row = relaxedRow(row, distance);
  }
}

int FacetCoverProof::find(const std::vector<int>& active) const {
  const auto at = by_active_set_.find(active);
  return at == by_active_set_.end() ? -1 : static_cast<int>(at->second);
}

const std::vector<ExactRow>& FacetCoverProof::rowsOf(std::uint32_t region,
                                                     std::deque<std::vector<ExactRow>>& storage) const {
  if (!checks_[region].listed.empty()) return checks_[region].listed;
  storage.push_back(listedRows(context_, checks_, region));
  return storage.back();
}

// Beyond the facet no z exists: rows that are tight on it add up to 0 z <= something that is negative there.
bool FacetCoverProof::proveEdge(const RegionCheck& check, const std::vector<ExactOrigin>& origins,
                                std::string& text) const {
  const ExactProgram& program = context_.program;
  std::vector<int> rows = program.basis;
  const std::size_t free_count = rows.size();
  rows.insert(rows.end(), check.active.begin(), check.active.end());
  rows.insert(rows.end(), check.idle.begin(), check.idle.end());
  const std::size_t first = rows.size();
  for (const ExactOrigin& origin : origins) {
    if (origin.kind == ExactOrigin::Kind::kSlack) rows.push_back(origin.index);
  }
  if (rows.size() == first) return false;
  ExactLp lp;
  lp.addColumns(static_cast<int>(rows.size()));
  lp.addRows(program.n + 1);
  for (int i = 0; i <= program.n; ++i) lp.setRowBounds(i, ExactLp::Bound::kFixed, i == program.n ? 1 : 0, 0);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const int column = static_cast<int>(k);
    if (k < free_count) lp.setColumnBounds(column, ExactLp::Bound::kFree, 0, 0);
    for (int i = 0; i < program.n; ++i) {
      if (program.A(rows[k], i) != 0) lp.setCoefficient(i, column, Rational(program.A(rows[k], i)));
    }
    if (k >= first) lp.setCoefficient(program.n, column, 1);
  }
  if (lp.solve() != ExactLp::Status::kOptimal) return false;
  // In terms of the program's own rows, without fractions.
  std::vector<Rational> weights;
  for (std::size_t k = 0; k < rows.size(); ++k)
    weights.push_back(timesPowerOfTwo(lp.primal(static_cast<int>(k)), program.row_exponent[rows[k]]));
  const Integer denominator = commonDenominator(weights);
  Integer divisor(0);
  for (Rational& weight : weights) {
    weight *= denominator;
    divisor = gcd(divisor, weight.get_num());
  }
  std::size_t count = 0;
  std::string entries;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (weights[k] == 0) continue;
    ++count;
    entries += " " + std::to_string(rows[k]) + " " + Integer(weights[k].get_num() / divisor).get_str(16);
  }
  text += " edge " + std::to_string(count) + entries;
  return true;
}

std::vector<CoverCandidate> FacetCoverProof::behind(std::uint32_t region, const ExactRow& plane,
                                                    std::deque<std::vector<ExactRow>>& storage) const {
  std::vector<std::uint32_t> found;
  for (std::size_t k = 0; k < planes_.size(); ++k) {
    for (const int sign : {1, -1}) {
      if (!onePlane(planes_[k], plane.unit, sign)) continue;
      // Only regions on the other side of the plane count.
      for (const std::int32_t user : users_[k]) {
        const auto other = static_cast<std::uint32_t>(std::abs(user) - 1);
        if (other != region && (user > 0) != (sign > 0)) found.push_back(other);
      }
    }
  }
  for (std::uint32_t r = static_cast<std::uint32_t>(context_.map.regionCount()); r < checks_.size(); ++r) {
    for (const ExactRow& row : checks_[r].listed) {
      if (r != region && onePlane(row.unit, plane.unit, -1)) found.push_back(r);
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::vector<CoverCandidate> candidates;
  for (const std::uint32_t other : found) {
    const std::vector<ExactRow>& rows = rowsOf(other, storage);
    if (reachesBehind(other, rows, plane)) candidates.push_back({other, &rows});
  }
  return candidates;
}

// By its interior point, or, where it reaches the plane, because none of its rows stops it there.
bool FacetCoverProof::reachesBehind(std::uint32_t region, const std::vector<ExactRow>& rows,
                                    const ExactRow& plane) const {
  const RegionCheck& check = checks_[region];
  if (!check.described || check.point.empty()) return false;
  return valueAt(plane, check.point) < 0 ||
         std::none_of(rows.begin(), rows.end(), [&](const ExactRow& row) { return vanishesOn(row, plane); });
}

FacetBehind FacetCoverProof::addGap(std::uint32_t region, std::uint32_t row, const ExactRow& plane,
                                    const std::vector<Rational>& uncovered,
                                    std::vector<Defect>& defects) const {
  Defect defect = regionDefect(Defect::Kind::kGap, region, static_cast<int>(row),
                               "no region of the map lies behind a part of this facet");
  const ExactProgram& program = context_.program;
  for (int k = 0; k < kWitnessTries && defect.witness.size() == 0; ++k) {
    std::vector<Rational> t = uncovered;
    for (int j = 0; j < program.p; ++j)
      t[j] += Rational(std::ldexp(plane.unit[static_cast<std::size_t>(j)], -kWitnessBits - k));
    if (strictlyInside(t, {}, nullptr)) defect.witness = program.theta(t);
  }
  defects.push_back(std::move(defect));
  return {};
}

FacetBehind FacetCoverProof::closeByCover(std::uint32_t region, std::uint32_t row,
                                          const std::vector<ExactRow>& listed, std::string& text,
                                          std::vector<Defect>& defects,
                                          std::vector<Rational>& uncovered) const {
  const ExactRow& plane = listed[row];
  std::deque<std::vector<ExactRow>> storage;
  std::vector<CoverCandidate> candidates = behind(region, plane, storage);
  for (;;) {
    FacetCover cover(&plane, context_.program.p, candidates, context_.options.stop);
    std::string proof;
    if (cover.cover(listed, proof)) {
      text += " cover" + proof;
      return {FacetCoverKind::kCovered, cover.used()};
    }
    if (cover.uncovered().empty()) return {};  // stopped
    uncovered = cover.uncovered();
    // Behind may be regions that do not list the plane, if the map leaves out what they have in common.
    const std::size_t before = candidates.size();
    for (std::uint32_t r = 0; r < checks_.size(); ++r) {
      const auto is_r = [r](const CoverCandidate& candidate) { return candidate.region == r; };
      if (r == region || std::any_of(candidates.begin(), candidates.end(), is_r) ||
          !nearlyHolds(context_, checks_, r, uncovered))
        continue;
      const std::vector<ExactRow>& rows = rowsOf(r, storage);
      if (reachesBehind(r, rows, plane)) candidates.push_back({r, &rows});
    }
    if (candidates.size() == before) return addGap(region, row, plane, uncovered, defects);
  }
}

// The facet of the region moved outwards: all other regions that have no row along it, moved outwards too,
// may cover it, first those with the facet's plane.
FacetBehind FacetCoverProof::closeWidened(std::uint32_t region, std::uint32_t row, std::string& text,
                                          std::vector<Defect>& defects) const {
  const ExactRow& plane = wide_[region][row];
  std::deque<std::vector<ExactRow>> storage;
  std::vector<std::uint32_t> order;
  for (const CoverCandidate& near : behind(region, plane, storage)) order.push_back(near.region);
  for (std::uint32_t r = 0; r < wide_.size(); ++r) {
    if (r != region && std::find(order.begin(), order.end(), r) == order.end()) order.push_back(r);
  }
  std::vector<CoverCandidate> candidates;
  for (const std::uint32_t r : order) {
    const auto along = [&](const ExactRow& other) { return vanishesOn(other, plane); };
    if (!wide_[r].empty() && std::none_of(wide_[r].begin(), wide_[r].end(), along))
      candidates.push_back({r, &wide_[r]});
  }
  FacetCover cover(&plane, context_.program.p, candidates, context_.options.stop);
  std::string proof;
  if (cover.cover(wide_[region], proof)) {
    text += " cover" + proof;
    return {FacetCoverKind::kCovered, cover.used()};
  }
  if (cover.uncovered().empty()) return {};  // stopped
  return addGap(region, row, plane, cover.uncovered(), defects);
}

// Whether the set describes a region with an interior that holds `uncovered`, a point of a facet.
bool FacetCoverProof::liesBehind(const std::vector<int>& active, const std::vector<Rational>& uncovered,
                                 std::vector<Rational>& point) const {
  const auto is_dropped = [&](int row) { return context_.program.is_dropped[static_cast<std::size_t>(row)]; };
  ExactRegion beyond;
  if (std::any_of(active.begin(), active.end(), is_dropped) || find(active) >= 0 ||
      describeExactly(context_.program, active, beyond) != ExactStatus::kRegion)
    return false;
  for (const ExactRow& row : beyond.rows) {
    if (valueAt(row, uncovered) < 0) return false;
  }
  Interior interior = findInterior(nontrivialRows(beyond), nullptr, context_.program.p);
  if (interior.exists) point = std::move(interior.point);
  return interior.exists;
}

// An active set that should be in the map: that of a point nearer to the facet than any region is wide.
void FacetCoverProof::findMissing(const RegionCheck& check, const ExactRow& plane,
                                  const std::vector<Rational>& uncovered, Defect& defect) const {
  constexpr unsigned long kNearBits = 400;
  const Rational near(Integer(1), Integer(1) << kNearBits);
  std::vector<Rational> t = uncovered;
  for (std::size_t j = 0; j < t.size(); ++j) t[j] += near * Rational(plane.unit[j]);
  const auto active = activeSetAt(context_.program, t, check.active);
  std::vector<Rational> point;
  if (!active || !liesBehind(*active, uncovered, point)) return;
  defect.missing = *active;
  defect.witness = context_.program.theta(point);
}

FacetBehind FacetCoverProof::close(std::uint32_t region, std::uint32_t row, std::string& text,
                                   std::vector<Defect>& defects) const {
  const RegionCheck& check = checks_[region];
  const CheckedFacet& facet = check.facets[row];
  std::vector<ExactOrigin> origins{facet.origin};
  origins.insert(origins.end(), facet.same.begin(), facet.same.end());
  std::string line = "facet " + std::to_string(row) + " " + originText(facet.origin);
  for (const ExactOrigin& origin : origins) {
    if (origin.kind != ExactOrigin::Kind::kDomain && origin.kind != ExactOrigin::Kind::kBox) continue;
    text += line + " domain " + originText(origin) + "\n";
    return {FacetCoverKind::kDomain, {}};
  }
  if (!wide_.empty()) {
    if (row >= wide_[region].size()) {
      text += line + " out\n";
      return {FacetCoverKind::kMatched, {}};
    }
    FacetBehind wide{FacetCoverKind::kEdge, {}};
    if (!proveEdge(check, origins, line)) wide = closeWidened(region, row, line, defects);
    if (wide.kind != FacetCoverKind::kOpen) text += line + "\n";
    return wide;
  }
  for (const ExactOrigin& origin : origins) {
    if (origin.kind == ExactOrigin::Kind::kCostMultiplier) continue;
    const int other = find(changedSet(check.active, origin));
    if (other < 0 || checks_[static_cast<std::size_t>(other)].point.empty()) continue;
    text += line + " next " + originText(origin) + " " + std::to_string(other) + "\n";
    return {FacetCoverKind::kMatched, {static_cast<std::uint32_t>(other)}};
  }
  FacetBehind behind{FacetCoverKind::kEdge, {}};
  std::vector<Rational> uncovered;
  std::deque<std::vector<ExactRow>> storage;
  const std::size_t known = defects.size();
  if (!proveEdge(check, origins, line))
    behind = closeByCover(region, row, rowsOf(region, storage), line, defects, uncovered);
  if (behind.kind != FacetCoverKind::kOpen) {
    text += line + "\n";
    return behind;
  }
  if (defects.size() == known) return behind;  // stopped
  findMissing(check, rowsOf(region, storage)[row], uncovered, defects.back());
  return behind;
}

}  // namespace polyfly
