#include <algorithm>
#include <cstring>
#include <limits>
#include <map>

#include "exact_survey.hpp"
#include "mpc_core/dense_qp.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "region_maps/error.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {
namespace {

constexpr int kNearBits = 40;  // a side of the box counts as touched within 2^-40
constexpr int kMaxRounds = 1000;
constexpr double kPositive = 1e-10;  // multipliers above this are active at a witness

using Found = std::map<std::vector<int>, CriticalRegion>;

/// Rows that bound the region: no other, and not the box, implies them. Sides of the box that it touches
/// follow.
std::vector<ExactRow> boundingRows(const ExactRegion& exact, int p) {
  std::vector<const ExactRow*> left;
  for (const ExactRow* row : rowsThatCanFail(exact)) {
    const auto repeats = [&](const ExactRow* other) { return sameHalfSpace(*row, *other); };
    if (std::none_of(left.begin(), left.end(), repeats)) left.push_back(row);
  }
  ExactGuess solver(p);
  for (std::size_t k = left.size(); k-- > 0;) {
    std::vector<const ExactRow*> others = left;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    if (implies(others, *left[k], solver).holds) left = std::move(others);
  }
  std::vector<ExactRow> rows;
  for (const ExactRow* row : left) rows.push_back(*row);
  for (int side = 0; side < 2 * p; ++side) {
    const ExactRow row = boxRow(p, side);
    const auto along = [&](const ExactRow* other) { return sameHalfSpace(row, *other); };
    if (std::any_of(left.begin(), left.end(), along)) continue;
    ExactRow near = row;  // a plane just inside the box, where interior points are searched
    for (Integer& value : near.value) value <<= kNearBits;
    near.value.back() -= 1;
    finishRow(near);
    if (findInterior(left, &near, p).exists) rows.push_back(row);
  }
  return rows;
}

/// The region of an active set in doubles; false where it has no interior.
bool describe(const ExactProgram& program, const std::vector<int>& active, CriticalRegion& region) {
  ExactRegion exact;
  if (describeExactly(program, active, exact) != ExactStatus::kRegion) return false;
  const Interior interior = findInterior(rowsThatCanFail(exact), nullptr, program.p);
  if (!interior.exists) return false;
  const std::vector<ExactRow> rows = boundingRows(exact, program.p);
  region.active = exact.active;
  region.radius = interior.radius;
  region.centre = toTheta(program, interior.point);
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
    options.leaf_regions = std::numeric_limits<int>::max();
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

/// Active set at a witness by a rounded solution; false where there is none.
bool activeSetAt(const ParametricProgram& program, const ExactProgram& exact, double regularisation,
                 const Eigen::VectorXd& theta, std::vector<int>& active) {
  if (exact.linear) return false;
  try {
    const Eigen::MatrixXd H =
        program.H + regularisation * Eigen::MatrixXd::Identity(program.H.rows(), program.H.cols());
    DenseQp qp(H, program.A, exact.basis);
    const Eigen::VectorXd g = program.f + program.F * theta;
    const Eigen::VectorXd b = program.b + program.S * theta;
    if (qp.solve(g.data(), b.data()) != QpStatus::kOptimal) return false;
    active.clear();
    for (int k = 0; k < qp.activeCount(); ++k) {
      const int row = qp.activeRows()[k];
      if (!exact.in_basis[row] && qp.lambda()(row) > kPositive) active.push_back(row);
    }
    std::sort(active.begin(), active.end());
    return true;
  } catch (const Error&) {  // H is only definite together with the equalities
    return false;
  }
}

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
  const Adjustment adjustment = adjust(program, may_drop);
  const ExactProgram exact(program, adjustment);
  const SurveyContext context{map, program, exact, options};
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
    const TreelessMap current(program, toPartition(found, ExploreStatus::kIncomplete));
    result.report = certify(current.view(map.path()), program, options);
    const std::size_t before = found.size();
    for (const Defect& defect : result.report.defects) {
      std::vector<std::vector<int>> candidates;
      if (!defect.missing.empty() || defect.kind == Defect::Kind::kGap) candidates.push_back(defect.missing);
      std::vector<int> active;
      if (defect.witness.size() > 0 &&
          activeSetAt(program, exact, adjustment.regularisation, defect.witness, active))
        candidates.push_back(active);
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
