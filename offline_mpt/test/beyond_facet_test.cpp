// By how much u differs beyond a facet, against look-ups there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "exact_programs.hpp"
#include "random.hpp"
#include "random_program.hpp"
#include "solved_map.hpp"

namespace polyfly {
namespace {

double valueOf(const RegionMap& map, std::uint32_t region, std::size_t input,
               const std::vector<double>& theta) {
  const double* const law = map.law(map.region(region).law) + input * (theta.size() + 1);
  return std::inner_product(theta.begin(), theta.end(), law, law[theta.size()]);
}

/// From a point inside of a region to a facet in this direction, and 8 tolerances further; all scaled to [-1, 1].
Eigen::VectorXd pointBeyondFacet(const RegionMap& map, std::uint32_t index, const Eigen::VectorXd& centre,
                                 const Eigen::VectorXd& half, const Eigen::VectorXd& inside,
                                 const Eigen::VectorXd& direction) {
  const Eigen::Index p = inside.size();
  const RegionView region = map.region(index);
  double step = 10.0;
  Eigen::VectorXd outwards = direction;
  for (std::uint32_t i = 0; i < region.row_count; ++i) {
    const Eigen::Map<const Eigen::VectorXd> plane(
        map.plane(static_cast<std::size_t>(std::abs(region.rows[i])) - 1), p + 1);
    const double sign = region.rows[i] > 0 ? 1.0 : -1.0;
    const Eigen::VectorXd normal = sign * plane.head(p).cwiseProduct(half);
    const double slack = sign * (plane(p) - plane.head(p).dot(centre)) - normal.dot(inside);
    if (normal.dot(direction) <= 0.0 || slack / normal.dot(direction) > step) continue;
    step = slack / normal.dot(direction);
    outwards = normal;
  }
  return inside + step * direction + 8.0 * map.tolerance() * outwards;
}

// Behind a facet lies a region that shares it: no smaller face is met.
TEST(Certify, BeyondAFacetTheInputDiffersByWhatIsStated) {
  Random random(5);
  for (const ParametricProgram& program : {doubleIntegrator(4), randomProgram(4, 12, 2, 3)}) {
    const Partition partition = explore(program);
    const MapInMemory memory(encode(program, partition));
    const RegionMap& map = memory.map();
    const CertifyReport report = certify(map, program, {});
    ASSERT_TRUE(report.passed());
    const int p = program.parameterCount();
    Eigen::VectorXd centre(p), half(p);
    for (int j = 0; j < p; ++j) {
      const Signal& range = program.parameters[static_cast<std::size_t>(j)];
      centre(j) = 0.5 * (range.lower + range.upper);
      half(j) = 0.5 * (range.upper - range.lower);
    }
    const auto unscaled = [&](const Eigen::VectorXd& t) {
      const Eigen::VectorXd theta = centre + half.cwiseProduct(t);
      return std::vector<double>(theta.data(), theta.data() + p);
    };
    double greatest = 0.0;
    for (const CriticalRegion& region : partition.regions) {
      const std::uint32_t index = map.locateExhaustively(region.centre.data()).region;
      const Eigen::VectorXd inside = (region.centre - centre).cwiseQuotient(half);
      for (int k = 0; k < 50; ++k) {
        const std::vector<double> theta =
            unscaled(pointBeyondFacet(map, index, centre, half, inside, random.matrix(p, 1).col(0)));
        const Lookup behind = map.locateExhaustively(theta.data());
        for (std::size_t i = 0; behind.status == LookupStatus::kInside && i < map.inputs().size(); ++i)
          greatest = std::max(
              greatest, std::abs(valueOf(map, index, i, theta) - valueOf(map, behind.region, i, theta)));
      }
    }
    EXPECT_LE(greatest, report.beyond_facet);
    EXPECT_GT(greatest, 1e-3 * report.beyond_facet);
  }
}

}  // namespace
}  // namespace polyfly
