#include <algorithm>
#include <cstring>
#include <map>

#include "certify/region_check.hpp"
#include "certify/slivers.hpp"
#include "exact_kkt/exact_active_set.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {
namespace {

constexpr int kNearBits = 40;  // a side of the box counts as touched within 2^-40
constexpr int kMaxRounds = 1000;

using Found = std::map<std::vector<int>, CriticalRegion>;

/// Rows that bound the region, and the sides of the box that it touches.
std::vector<ExactRow> boundingRowsAndSides(const ExactRegion& exact, int p) {
  std::vector<ExactRow> rows = boundingRows(exact, p);
  std::vector<const ExactRow*> left;
  for (const ExactRow& row : rows) left.push_back(&row);
  std::vector<ExactRow> sides;
  for (int side = 0; side < 2 * p; ++side) {
    const ExactRow row = boxRow(p, side);
    const auto along = [&](const ExactRow* other) { return sameHalfSpace(row, *other); };
    if (std::any_of(left.begin(), left.end(), along)) continue;
    ExactRow near = row;  // a plane just inside the box, where interior points are searched
    for (Integer& value : near.value) value <<= kNearBits;
    near.value.back() -= 1;
    finishRow(near);
    if (findInterior(left, &near, p).exists) sides.push_back(row);
  }
  rows.insert(rows.end(), sides.begin(), sides.end());
  return rows;
}

/// The region of an active set in doubles; false where it has no interior.
bool describe(const ExactProgram& program, const std::vector<int>& active, CriticalRegion& region) {
  ExactRegion exact;
  if (describeExactly(program, active, exact) != ExactStatus::kRegion) return false;
  const Interior interior = findInterior(nontrivialRows(exact), nullptr, program.p);
  if (!interior.exists) return false;
  const std::vector<ExactRow> rows = boundingRowsAndSides(exact, program.p);
  region.active = exact.active;
  region.radius = interior.radius;
  region.centre = program.theta(interior.point);
  region.G.resize(static_cast<Eigen::Index>(rows.size()), program.p);
  region.g.resize(region.G.rows());
  for (Eigen::Index f = 0; f < region.G.rows(); ++f) {
    const std::vector<double>& unit = rows[static_cast<std::size_t>(f)].unit;
    region.g(f) = unit[static_cast<std::size_t>(program.p)];
    for (int j = 0; j < program.p; ++j) {
      region.G(f, j) = unit[static_cast<std::size_t>(j)] / program.half[j].get_d();
      region.g(f) += region.G(f, j) * program.centre[j].get_d();
    }
  }
  region.K.resize(program.q, program.p);
  region.k.resize(program.q);
  for (int i = 0; i < program.q; ++i) {
    const Rational* law = exact.law.data() + static_cast<std::ptrdiff_t>(i) * (program.p + 1);
    Rational constant = law[program.p];
    for (int j = 0; j < program.p; ++j) {
      const Rational gain = law[j] / program.half[j];
      region.K(i, j) = gain.get_d();
      constant -= gain * program.centre[j];
    }
    region.k(i) = constant.get_d();
  }
  return true;
}

/// A map that answers by testing all its regions, in memory: no tree, which only a map that is kept needs.
class TreelessMap {
 public:
  TreelessMap(const ParametricProgram& program, const Partition& partition) {
    TreeOptions options;
    options.mode = TreeMode::kNone;
    const std::vector<std::byte> bytes = layOut(encode(program, partition, options));
    storage_.resize(bytes.size() / sizeof(Block) + 1);
    std::memcpy(storage_.data(), bytes.data(), bytes.size());
    size_ = bytes.size();
  }

  RegionMap view(const std::string& name) const { return RegionMap::view(storage_.data(), size_, name); }

 private:
  struct alignas(64) Block {
    std::byte bytes[64];
  };
  std::vector<Block> storage_;
  std::size_t size_ = 0;
};

Partition toPartition(const Found& found, ExploreStatus status) {
  Partition partition;
  partition.status = status;
  for (const auto& [active, region] : found) partition.regions.push_back(region);
  partition.stats.regions = partition.regions.size();
  return partition;
}

}  // namespace

RepairResult repair(const RegionMap& map, const ParametricProgram& program, const CertifyOptions& options) {
  RepairResult result;
  result.report = certify(map, program, options);
  std::vector<char> may_drop(static_cast<std::size_t>(program.rowCount()), 0);
  for (const int row : result.report.dropped_rows) may_drop[row] = 1;
  ProgramPerturbation adjustment = adjust(program, may_drop);
  adjustment.dropped = result.report.dropped_equalities;
  adjustment.dropped.insert(adjustment.dropped.end(), result.report.dropped_rows.begin(),
                            result.report.dropped_rows.end());
  const ExactProgram exact(program, adjustment);
  const CheckContext context{map, program, exact, options};
  Found found;
  for (std::uint32_t r = 0; r < map.regionCount(); ++r) {
    bool valid = false;
    const std::vector<int> active = mapActiveSet(context, map.region(r), valid);
    CriticalRegion region;
    const bool known = valid && found.count(active) > 0;
    if (valid && !known && describe(exact, active, region)) {
      found.emplace(active, std::move(region));
    } else {
      ++result.removed;
    }
  }
  if (found.empty()) throw Error(map.path() + ": no region of the map can be used");
  for (int round = 0; round < kMaxRounds; ++round) {
    const TreelessMap current(program, toPartition(found, ExploreStatus::kComplete));
    result.report = certify(current.view(map.path()), program, options);
    const std::size_t before = found.size();
    for (const Defect& defect : result.report.defects) {
      std::vector<std::vector<int>> candidates;
      if (!defect.missing.empty() || defect.kind == Defect::Kind::kGap) candidates.push_back(defect.missing);
      if (defect.witness.size() > 0) {
        const auto active = activeSetAt(exact, toScaled(exact, defect.witness), {});
        if (active) candidates.push_back(*active);
      }
      for (const std::vector<int>& candidate : candidates) {
        CriticalRegion region;
        if (found.count(candidate) > 0 || !describe(exact, candidate, region)) continue;
        found.emplace(candidate, std::move(region));
        ++result.added;
      }
    }
    if (found.size() == before || result.report.interrupted) break;
  }
  result.partition =
      toPartition(found, result.report.passed() ? ExploreStatus::kComplete : ExploreStatus::kIncomplete);
  return result;
}

}  // namespace polyfly
