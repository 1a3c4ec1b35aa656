#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "code_tables.hpp"
#include "map_facts.hpp"
#include "test_template.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kVertices = 16;
constexpr std::size_t kWithin = 24;
constexpr std::size_t kFacets = 24;
constexpr std::size_t kOutside = 8;
constexpr std::uint64_t kSeed = 1;
/// What stays in u where there is no answer.
constexpr double kUntouched = 0.5;
/// Distance from the box, in ranges, within which float may take a parameter for inside.
constexpr double kBesideBox = 1e-3;
/// Part of the tolerance that the comparison itself may round away, relative to u.
constexpr double kComparison = 0x1p-22;

class VectorMaker {
 public:
  VectorMaker(const RegionMap& map, const ExportOptions& options, double margin)
      : map_(map), type_(options.type), margin_(margin), random_(kSeed) {}

  TestVectors make() {
    const std::size_t p = map_.parameters().size();
    for (std::size_t i = 0; i < kVertices; ++i) {
      std::vector<double> theta(p);
      for (std::size_t k = 0; k < p; ++k) {
        const Signal& signal = map_.parameters()[k];
        theta[k] = (i >> k % kVertices & 1u) != 0 ? signal.upper : signal.lower;
      }
      add(theta);
    }
    for (std::size_t i = 0; i < kWithin; ++i) add(within());
    for (std::size_t i = 0; i < kFacets; ++i) addBesideFacet();
    for (std::size_t i = 0; i < kOutside; ++i) {
      std::vector<double> theta = within();
      const Signal& signal = map_.parameters()[i % p];
      const double step = 0.25 * (signal.upper - signal.lower) + 0.25;
      theta[i % p] = i % 2 == 0 ? signal.upper + step : signal.lower - step;
      add(theta);
    }
    return vectors_;
  }

 private:
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

  std::vector<double> within() {
    std::vector<double> theta;
    for (const Signal& signal : map_.parameters())
      theta.push_back(signal.lower + uniform() * (signal.upper - signal.lower));
    return theta;
  }

  /// A point within, moved onto a plane of the map along the coordinate that the plane depends on most.
  void addBesideFacet() {
    std::vector<double> theta = within();
    const std::size_t p = theta.size();
    if (map_.planeCount() == 0) return add(theta);
    const double* const plane = map_.plane(random_() % map_.planeCount());
    std::size_t steepest = 0;
    double rest = plane[p];
    for (std::size_t k = 0; k < p; ++k) {
      if (std::abs(plane[k]) > std::abs(plane[steepest])) steepest = k;
      rest -= plane[k] * theta[k];
    }
    if (plane[steepest] != 0.0) theta[steepest] += rest / plane[steepest];
    add(theta);
  }

  /// Whether every region is farther away than the exported code could take for inside.
  bool isClearlyOutside(const std::vector<double>& theta) const {
    const std::size_t p = theta.size();
    for (std::size_t i = 0; i < map_.regionCount(); ++i) {
      const RegionView region = map_.region(i);
      double violation = -std::numeric_limits<double>::infinity();
      for (std::uint32_t r = 0; r < region.row_count; ++r) {
        const std::int32_t row = region.rows[r];
        const double* const plane = map_.plane(static_cast<std::size_t>(std::abs(row)) - 1);
        double distance = -plane[p];
        for (std::size_t k = 0; k < p; ++k) distance += plane[k] * theta[k];
        violation = std::max(violation, row < 0 ? -distance : distance);
      }
      if (violation <= 2.0 * margin_) return false;
    }
    return true;
  }

  /// A parameter is left out where rounding decides whether there is an answer.
  void add(std::vector<double> theta) {
    round(theta);
    std::vector<double> u(map_.inputs().size(), kUntouched);
    const Lookup found = map_.evaluate(theta.data(), u.data());
    const bool is_inside = found.status == LookupStatus::kInside;
    const bool may_differ = type_ != ExportType::kDouble && found.status == LookupStatus::kOutsidePartition &&
                            !isClearlyOutside(theta);
    // Rounding puts vertices just outside of the box: the code's box is as much wider.
    const bool is_beside_box =
        type_ != ExportType::kDouble && found.status == LookupStatus::kOutsideBox && isInBox(theta);
    if (may_differ || is_beside_box) return;
    vectors_.theta.insert(vectors_.theta.end(), theta.begin(), theta.end());
    vectors_.status.push_back(is_inside ? 0 : 1);
    vectors_.u.insert(vectors_.u.end(), u.begin(), u.end());
  }

  /// Rounds to the code's numbers.
  void round(std::vector<double>& theta) const {
    if (type_ == ExportType::kDouble) return;
    for (double& value : theta) value = static_cast<float>(value);
  }

  bool isInBox(const std::vector<double>& theta) const {
    for (std::size_t k = 0; k < theta.size(); ++k) {
      const Signal& signal = map_.parameters()[k];
      const double slack = kBesideBox * (signal.upper - signal.lower);
      if (theta[k] < signal.lower - slack || theta[k] > signal.upper + slack) return false;
    }
    return true;
  }

  const RegionMap& map_;
  const ExportType type_;
  const double margin_;
  std::mt19937_64 random_;
  TestVectors vectors_;
};

/// Greatest differences of the code's answers from those of the vectors, which are rounded themselves.
std::vector<double> comparedWithin(const RegionMap& map, const ExportOptions& options,
                                   const ExportBound& bound, const std::vector<double>& u) {
  const std::size_t m = map.inputs().size();
  std::vector<double> tolerance(m, 0.0);
  for (std::size_t j = 0; j < m && options.type != ExportType::kDouble; ++j) {
    double greatest = 0.0;
    for (std::size_t i = j; i < u.size(); i += m) greatest = std::max(greatest, std::abs(u[i]));
    tolerance[j] = bound.error[j] + kComparison * greatest;
  }
  return tolerance;
}

}  // namespace

std::string exportTest(const RegionMap& map, const ExportOptions& options, const ExportBound& bound) {
  checkExportName(options.name);
  TestVectors vectors = VectorMaker(map, options, bound.margin).make();
  vectors.tolerance = comparedWithin(map, options, bound, vectors.u);
  Replacements keys = mapKeys(map, options);
  keys["oracle"] = "the map";
  keys["workspace"] = "";
  keys["parameter_note"] =
      "vertices of the box, points within,\n * points on and beside facets, points outside.";
  keys["call"] = options.name + "_evaluate(theta, u)";
  return testText(std::move(keys), options.type, vectors);
}

std::string testText(Replacements keys, ExportType type, const TestVectors& vectors) {
  const std::size_t count = vectors.status.size();
  keys["vectors"] = std::to_string(count);
  keys["theta"] = initialiser(vectors.theta, vectors.theta.size() / count, type);
  keys["status"] = initialiser(vectors.status, 0);
  keys["u"] = initialiser(vectors.u, vectors.u.size() / count, type);
  keys["tolerance"] = initialiser(vectors.tolerance, 0, type);
  return replaced(kTestTemplate, keys);
}

}  // namespace polyfly
