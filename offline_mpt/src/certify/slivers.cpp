#include "certify/slivers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <numeric>

#include "certify/facet_cover.hpp"
#include "certify/tolerances.hpp"
#include "support/region_distance.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMostChanges =
    4;  // rows by which the active sets of a sliver and of regions about it differ

std::size_t changes(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> difference;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(difference));
  return difference.size();
}

/// The map's regions about a sliver, the nearest active sets first.
std::vector<std::uint32_t> regionsAbout(const std::vector<RegionCheck>& checks,
                                        const std::vector<int>& active) {
  std::vector<std::uint32_t> result;
  for (std::size_t most = 1; most <= kMostChanges; ++most) {
    for (std::uint32_t r = 0; r < checks.size(); ++r) {
      const RegionCheck& check = checks[r];
      if (check.described && !check.is_sliver && changes(check.active, active) == most) result.push_back(r);
    }
  }
  return result;
}

/// Proves that the map's regions cover the sliver but for the plane tolerance: those about it, and any that
/// hold a point which the others leave.
bool coverSliver(const CheckContext& context, const std::vector<RegionCheck>& checks, RegionCheck& sliver) {
  const Rational distance(context.options.plane_tolerance);
  std::deque<std::vector<ExactRow>> storage;
  std::vector<CoverCandidate> candidates;
  const auto add = [&](std::uint32_t r) {
    std::vector<ExactRow> rows = mapRows(context, checks, r);
    for (ExactRow& row : rows) row = relaxedRow(row, distance);
    storage.push_back(std::move(rows));
    candidates.push_back({r, &storage.back()});
  };
  for (const std::uint32_t r : regionsAbout(checks, sliver.active)) add(r);
  for (;;) {
    FacetCover cover(nullptr, context.program.p, candidates, context.options.stop);
    std::string proof;
    if (cover.cover(sliver.listed, proof)) {
      sliver.text += "sliver_cover" + proof + "\n";
      sliver.covered_by.insert(cover.used().begin(), cover.used().end());
      return true;
    }
    const std::size_t before = candidates.size();
    for (std::uint32_t r = 0; r < context.map.regionCount() && !cover.uncovered().empty(); ++r) {
      const auto is_r = [r](const CoverCandidate& candidate) { return candidate.region == r; };
      if (checks[r].described && std::none_of(candidates.begin(), candidates.end(), is_r) &&
          nearlyHolds(context, checks, r, cover.uncovered()))
        add(r);
    }
    if (candidates.size() == before) return false;
  }
}

}  // namespace

ExactRow relaxedRow(const ExactRow& row, const Rational& distance) {
  Integer greatest(0);
  for (std::size_t j = 0; j + 1 < row.value.size(); ++j)
    greatest = std::max(greatest, Integer(abs(row.value[j])));
  ExactRow result = row;
  for (Integer& value : result.value) value *= distance.get_den();
  result.value.back() += distance.get_num() * greatest;
  finishRow(result);
  return result;
}

bool nearlyHolds(const CheckContext& context, const std::vector<RegionCheck>& checks, std::uint32_t region,
                 const std::vector<Rational>& t) {
  const double most = 2.0 * context.options.plane_tolerance;
  if (checks[region].is_sliver) {
    std::vector<double> point;
    for (const Rational& value : t) point.push_back(value.get_d());
    const std::vector<ExactRow>& rows = checks[region].listed;
    return std::all_of(rows.begin(), rows.end(), [&](const ExactRow& row) {
      return std::inner_product(point.begin(), point.end(), row.unit.begin(), -row.unit.back()) <= most;
    });
  }
  return isWithin(context.map, region, context.program.theta(t), most);
}

std::vector<ExactRow> boundingRows(const ExactRegion& exact, int p) {
  std::vector<const ExactRow*> left;
  for (const ExactRow* row : nontrivialRows(exact)) {
    const auto repeats = [&](const ExactRow* other) { return sameHalfSpace(*row, *other); };
    if (std::none_of(left.begin(), left.end(), repeats)) left.push_back(row);
  }
  FloatLp solver(p);
  for (std::size_t k = left.size(); k-- > 0;) {
    std::vector<const ExactRow*> others = left;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    if (implies(others, *left[k], solver).holds) left = std::move(others);
  }
  std::vector<ExactRow> rows;
  for (const ExactRow* row : left) rows.push_back(*row);
  return rows;
}

bool checkSliver(const CheckContext& context, const std::vector<RegionCheck>& checks,
                 const std::vector<int>& active, RegionCheck& sliver) {
  sliver = {};
  sliver.is_sliver = true;
  ExactRegion exact;
  const auto is_dropped = [&](int row) { return context.program.is_dropped[row] != 0; };
  if (std::any_of(active.begin(), active.end(), is_dropped)) return false;
  if (describeExactly(context.program, active, exact) != ExactStatus::kRegion) return false;
  if (!findInterior(nontrivialRows(exact), nullptr, context.program.p).exists) return false;
  sliver.active = exact.active;
  sliver.described = true;
  sliver.rows = exact.rows.size();
  sliver.listed = boundingRows(exact, context.program.p);
  sliver.text = "sliver_region " + std::to_string(sliver.active.size());
  for (const int row : sliver.active) sliver.text += " " + std::to_string(row);
  sliver.text += "\n";
  finishCheck(context, static_cast<std::uint32_t>(checks.size()), exact, sliver);
  return sliver.defects.empty() && coverSliver(context, checks, sliver);
}

}  // namespace polyfly
