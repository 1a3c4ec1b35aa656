#include "costly_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

constexpr int kAnywhere = 10000;
constexpr int kBesidePlanes = 20000;
constexpr int kAround = 20000;
constexpr std::uint64_t kPointSeed = 2;
/// Steps around the costliest point, in ranges: from one to this.
constexpr double kLeastStep = 1e-4;

/// Runs the code's look-up on its tables, without the rounding of its sums.
class LookupCount {
 public:
  LookupCount(const RegionMap& map, const ExportOptions& options)
      : tables_(codeTables(map, options)),
        p_(map.parameters().size()),
        m_(map.inputs().size()),
        nodes_(map.nodeCount()),
        root_(map.root() & ~MapContent::kLeaf),
        first_fallback_(static_cast<std::uint32_t>(map.firstFallback())) {}

  CodeCost at(std::vector<double> theta) const {
    for (std::size_t i = 0; i < p_ && !tables_.fixed.theta_exponent.empty(); ++i)
      theta[i] = std::nearbyint(std::ldexp(theta[i], tables_.fixed.theta_exponent[i]));
    CodeCost cost;
    cost.comparisons = 2 * p_;
    std::uint32_t child = root_;
    while (child < nodes_) {
      ++cost.nodes;
      ++cost.comparisons;
      child = tables_.node_child[2 * child + (distance(theta, tables_.node_plane[child]) <= 0.0 ? 0 : 1)];
    }
    search(theta, child - static_cast<std::uint32_t>(nodes_), cost);
    cost.multiply_adds = (std::uint64_t{cost.nodes} + cost.rows + m_) * p_;
    return cost;
  }

 private:
  double distance(const std::vector<double>& theta, std::uint32_t plane) const {
    const double* const a = tables_.planes.data() + std::size_t{plane} * (p_ + 1);
    const double unit = tables_.fixed.theta_exponent.empty() ? 1.0 : std::ldexp(1.0, kPlaneUnit);
    double sum = -a[p_] * unit;
    for (std::size_t i = 0; i < p_; ++i) sum += a[i] * theta[i];
    return sum;
  }

  void search(const std::vector<double>& theta, std::uint32_t leaf, CodeCost& cost) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = tables_.leaf_first[leaf]; i < tables_.leaf_first[leaf + 1] && least > 0.0; ++i) {
      double greatest = -std::numeric_limits<double>::infinity();
      for (std::uint32_t k = tables_.candidate_first[i]; k < tables_.candidate_first[i + 1]; ++k) {
        const std::uint32_t row = tables_.rows[k];
        const double value = distance(theta, row / 2) * (row % 2 == 0 ? 1.0 : -1.0);
        ++cost.rows;
        cost.comparisons += 2;
        greatest = std::max(greatest, value);
        if (value > tables_.tolerance) {
          greatest = std::numeric_limits<double>::infinity();
          break;
        }
      }
      cost.comparisons += 4;
      if (tables_.candidate_region[i] >= first_fallback_)
        greatest = std::max(greatest, 0.0) + tables_.handicap;
      least = std::min(least, greatest);
    }
  }

  const CodeTables tables_;
  const std::size_t p_, m_, nodes_;
  const std::uint32_t root_, first_fallback_;
};

class PointSearch {
 public:
  PointSearch(const RegionMap& map, const ExportOptions& options)
      : map_(map), count_(map, options), random_(kPointSeed) {}

  CostlyPoint run() {
    for (int i = 0; i < kAnywhere; ++i) offer(anywhere());
    for (int i = 0; i < kBesidePlanes && map_.planeCount() != 0; ++i) offer(besidePlane());
    for (int i = 0; i < kAround && !best_.theta.empty(); ++i) offer(around());
    return best_;
  }

 private:
  /// In [0, 1).
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

  std::vector<double> anywhere() {
    std::vector<double> theta;
    for (const Signal& signal : map_.parameters())
      theta.push_back(signal.lower + uniform() * (signal.upper - signal.lower));
    return theta;
  }

  std::vector<double> besidePlane() {
    std::vector<double> theta = anywhere();
    const std::size_t p = theta.size();
    const double* const plane = map_.plane(random_() % map_.planeCount());
    const std::size_t moved = random_() % p;
    double rest = plane[p];
    for (std::size_t i = 0; i < p; ++i) rest -= plane[i] * theta[i];
    if (plane[moved] != 0.0) theta[moved] += rest / plane[moved];
    return theta;
  }

  std::vector<double> around() {
    std::vector<double> theta = best_.theta;
    const double step = std::pow(kLeastStep, uniform());
    for (std::size_t i = 0; i < theta.size(); ++i) {
      const Signal& signal = map_.parameters()[i];
      theta[i] += step * (uniform() - 0.5) * (signal.upper - signal.lower);
    }
    return theta;
  }

  void offer(std::vector<double> theta) {
    std::vector<double> u(map_.inputs().size());
    for (std::size_t i = 0; i < theta.size(); ++i) {
      const Signal& signal = map_.parameters()[i];
      theta[i] = std::min(std::max(theta[i], signal.lower), signal.upper);
    }
    if (map_.evaluate(theta.data(), u.data()).status != LookupStatus::kInside) return;
    const CodeCost cost = count_.at(theta);
    // Points of equal cost are taken too: they lead away from a local optimum.
    if (!best_.theta.empty() && cost.multiply_adds < best_.cost.multiply_adds) return;
    best_ = {std::move(theta), cost};
  }

  const RegionMap& map_;
  const LookupCount count_;
  std::mt19937_64 random_;
  CostlyPoint best_;
};

}  // namespace

CostlyPoint costlyPoint(const RegionMap& map, const ExportOptions& options) {
  return PointSearch(map, options).run();
}

}  // namespace polyfly
