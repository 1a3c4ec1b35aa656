#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <new>
#include <random>
#include <thread>

#include "allocations.hpp"
#include "region_maps/region_map.hpp"
#include "synthetic_map.hpp"

namespace polyfly {
namespace {

using Random = std::mt19937_64;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kNone = 0xffffffffu;

/// How far theta is outside of plane `row`, in more digits than the subject has.
long double excess(const MapContent& content, std::int32_t row, const std::vector<double>& theta) {
  const std::size_t p = theta.size();
  const double* const plane = content.planes.data() + (static_cast<std::size_t>(std::abs(row)) - 1) * (p + 1);
  long double sum = -static_cast<long double>(plane[p]);
  for (std::size_t i = 0; i < p; ++i) sum += static_cast<long double>(plane[i]) * theta[i];
  return row < 0 ? -sum : sum;
}

struct Oracle {
  std::uint32_t region = kNone;
  bool close = false;  ///< theta is so near a face that the answer is a matter of rounding
};

Oracle ask(const MapContent& content, const std::vector<double>& theta) {
  constexpr long double kMargin = 1e-8L;  // more than any tolerance used here
  Oracle oracle;
  for (std::uint32_t i = 0; i < content.regions.size(); ++i) {
    const MapContent::Region& region = content.regions[i];
    long double worst = -1e9L;
    for (std::uint32_t j = 0; j < region.row_count; ++j) {
      worst = std::max(worst, excess(content, content.rows[region.first_row + j], theta));
    }
    if (std::abs(worst) < kMargin) oracle.close = true;
    if (worst < 0) oracle.region = i;
  }
  return oracle;
}

void expectLaw(const MapContent& content, std::uint32_t law, const std::vector<double>& theta,
               const double* u) {
  const std::size_t p = theta.size();
  for (std::size_t j = 0; j < content.inputs.size(); ++j) {
    const double* const row = content.laws.data() + (law * content.inputs.size() + j) * (p + 1);
    long double sum = row[p];
    for (std::size_t i = 0; i < p; ++i) sum += static_cast<long double>(row[i]) * theta[i];
    EXPECT_NEAR(u[j], static_cast<double>(sum), 1e-13);
  }
}

class PointLocation : public testing::TestWithParam<std::uint32_t> {};

TEST_P(PointLocation, FindsTheRegionThatHoldsTheParameter) {
  const std::uint32_t p = GetParam();
  int outside = 0;
  for (const std::uint32_t leaf_regions : {1u, 3u, 60u}) {
    TreeRecipe recipe;
    recipe.parameters = p;
    recipe.inputs = 1 + p % 3;
    recipe.regions = 60;
    recipe.leaf_regions = leaf_regions;
    recipe.holes_one_in = 3;
    recipe.seed = 100 * p + leaf_regions;
    const MadeMap made(makeTreeMap(recipe));
    Random random(recipe.seed);
    int inside = 0;
    int close = 0;
    for (int i = 0; i < 500; ++i) {
      const std::vector<double> theta = randomPoint(made.content, random, 1.0);
      std::vector<double> u(recipe.inputs, 99.0);
      const Lookup found = made.map.evaluate(theta.data(), u.data());
      const Lookup reference = made.map.locateExhaustively(theta.data());
      const Oracle oracle = ask(made.content, theta);
      if (oracle.close) {
        ++close;
        continue;
      }
      EXPECT_EQ(found.status, reference.status);
      EXPECT_EQ(made.map.locate(theta.data()).status, found.status);
      if (oracle.region == kNone) {
        ++outside;
        EXPECT_EQ(found.status, LookupStatus::kOutsidePartition);
        EXPECT_EQ(u, std::vector<double>(recipe.inputs, 99.0));
        continue;
      }
      ++inside;
      EXPECT_EQ(found.status, LookupStatus::kInside);
      EXPECT_EQ(found.region, oracle.region);
      EXPECT_EQ(reference.region, oracle.region);
      EXPECT_EQ(made.map.locate(theta.data()).region, oracle.region);
      EXPECT_EQ(found.law, made.content.regions[oracle.region].law);
      EXPECT_EQ(reference.law, found.law);
      expectLaw(made.content, found.law, theta, u.data());
    }
    EXPECT_GT(inside, 50);
    EXPECT_LT(close, 5);
  }
  EXPECT_GT(outside, 0);
}

// Rows that the nodes on the path and the box imply change no answer.
TEST_P(PointLocation, ImpliedRowsNeedNoTest) {
  for (const std::uint32_t leaf_regions : {1u, 3u, 60u}) {
    TreeRecipe recipe;
    recipe.parameters = GetParam();
    recipe.regions = 60;
    recipe.leaf_regions = leaf_regions;
    recipe.holes_one_in = 3;
    recipe.seed = 100 * recipe.parameters + leaf_regions;
    const MadeMap all(makeTreeMap(recipe));
    recipe.names_tests = true;
    const MadeMap named(makeTreeMap(recipe));
    ASSERT_EQ(named.content.tests.size(), named.content.candidates.size());
    EXPECT_LT(named.map.cost().multiply_adds, all.map.cost().multiply_adds);
    Random random(recipe.seed);
    for (int i = 0; i < 500; ++i) {
      const std::vector<double> theta = randomPoint(all.content, random, 1.0);
      const Lookup expected = all.map.locate(theta.data());
      const Lookup found = named.map.locate(theta.data());
      ASSERT_EQ(found.status, expected.status);
      if (expected.status != LookupStatus::kInside) continue;
      EXPECT_EQ(found.region, expected.region);
    }
  }
}

TEST_P(PointLocation, LeavesNoGapBetweenRegionsEvenWithoutTolerance) {
  TreeRecipe recipe;
  recipe.parameters = GetParam();
  recipe.regions = 50;
  recipe.tolerance = 0.0;
  recipe.seed = 7 + GetParam();
  const MadeMap made(makeTreeMap(recipe));
  const std::size_t p = recipe.parameters;
  Random random(recipe.seed);
  for (int i = 0; i < 500; ++i) {
    std::vector<double> theta = randomPoint(made.content, random, 0.5);
    // Onto a plane of the tree, as well as rounding lets us.
    const MapContent::Node& node = made.content.nodes[random() % made.content.nodes.size()];
    const double* const a = made.content.planes.data() + node.plane * (p + 1);
    double norm = 0.0;
    for (std::size_t k = 0; k < p; ++k) norm += a[k] * a[k];
    const auto distance =
        static_cast<double>(excess(made.content, static_cast<std::int32_t>(node.plane) + 1, theta));
    for (std::size_t k = 0; k < p; ++k) theta[k] -= a[k] * distance / norm;
    const Lookup found = made.map.locate(theta.data());
    if (found.status == LookupStatus::kOutsideBox) continue;
    ASSERT_EQ(found.status, LookupStatus::kInside);
    EXPECT_EQ(made.map.locateExhaustively(theta.data()).status, LookupStatus::kInside);
    EXPECT_TRUE(made.map.contains(found.region, theta.data()));
  }
}

TEST_P(PointLocation, RefusesWhatIsNotFinite) {
  TreeRecipe recipe;
  recipe.parameters = GetParam();
  const MadeMap made(makeTreeMap(recipe));
  for (std::size_t i = 0; i < recipe.parameters; ++i) {
    for (const double bad : {std::nan(""), -std::nan(""), kInfinity, -kInfinity}) {
      Random random(i);
      std::vector<double> theta = randomPoint(made.content, random, 1.0);
      theta[i] = bad;
      // Told apart from a parameter that is merely too large.
      if (recipe.parameters > 1) theta[(i + 1) % recipe.parameters] = 1e9;
      double u[] = {7.0, 8.0};
      EXPECT_EQ(made.map.evaluate(theta.data(), u).status, LookupStatus::kNotFinite);
      EXPECT_EQ(made.map.locate(theta.data()).status, LookupStatus::kNotFinite);
      EXPECT_EQ(made.map.locateExhaustively(theta.data()).status, LookupStatus::kNotFinite);
      EXPECT_EQ(u[0], 7.0);
      EXPECT_EQ(u[1], 8.0);
    }
  }
}

TEST_P(PointLocation, RefusesWhatIsOutsideTheBox) {
  TreeRecipe recipe;
  recipe.parameters = GetParam();
  const MadeMap made(makeTreeMap(recipe));
  Random random(3);
  for (std::size_t i = 0; i < recipe.parameters; ++i) {
    const Signal& range = made.content.parameters[i];
    const double half = 0.5 * (range.upper - range.lower);
    for (const double place : {range.lower - 1e-6 * half, range.upper + 1e-6 * half, -1e300, 1e300}) {
      std::vector<double> theta = randomPoint(made.content, random, 1.0);
      theta[i] = place;
      double u[] = {7.0, 8.0};
      EXPECT_EQ(made.map.evaluate(theta.data(), u).status, LookupStatus::kOutsideBox);
      EXPECT_EQ(made.map.locate(theta.data()).status, LookupStatus::kOutsideBox);
      EXPECT_EQ(made.map.locateExhaustively(theta.data()).status, LookupStatus::kOutsideBox);
      EXPECT_EQ(u[0], 7.0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Parameters, PointLocation, testing::Range(1u, 11u));

/// All points of the grid with half the cells' spacing: insides, faces, edges, corners.
TEST(PointLocationOnGrid, FacesBelongToTheLowerCell) {
  for (std::uint32_t p = 1; p <= 8; ++p) {
    const std::uint32_t cells = p <= 2 ? 5 : p <= 4 ? 3 : 2;
    const MadeMap made(makeGridMap(p, cells));
    std::uint64_t points = 1;
    for (std::uint32_t i = 0; i < p; ++i) points *= 2 * cells + 1;
    for (std::uint64_t point = 0; point<points; point += p> 5 ? 7 : 1) {
      std::vector<double> theta;
      std::uint32_t region = 0;
      std::uint32_t stride = 1;
      std::uint64_t rest = point;
      for (std::uint32_t i = 0; i < p; ++i, rest /= 2 * cells + 1, stride *= cells) {
        const auto half_steps = static_cast<std::uint32_t>(rest % (2 * cells + 1));
        theta.push_back(0.5 * half_steps);
        region += stride * (half_steps <= 1 ? 0 : (half_steps + 1) / 2 - 1);
      }
      double u = -1.0;
      const Lookup found = made.map.evaluate(theta.data(), &u);
      ASSERT_EQ(found.status, LookupStatus::kInside) << p << " parameters, point " << point;
      ASSERT_EQ(found.region, region) << p << " parameters, point " << point;
      ASSERT_EQ(u, region);
      ASSERT_EQ(made.map.locateExhaustively(theta.data()).region, region);
    }
  }
}

TEST(PointLocationOnGrid, FacesOfTheBoxAreInsideAndTheNextNumberIsNot) {
  const MadeMap made(makeGridMap(3, 2));
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double face : {0.0, 2.0}) {
      double theta[] = {0.7, 0.7, 0.7};
      theta[i] = face;
      EXPECT_EQ(made.map.locate(theta).status, LookupStatus::kInside);
      theta[i] = std::nextafter(face, face == 0.0 ? -1.0 : 3.0);
      EXPECT_EQ(made.map.locate(theta).status, LookupStatus::kOutsideBox);
    }
  }
}

TEST(PointLocationTolerance, WidensTheBoxByATimesHalfItsRange) {
  constexpr double kTolerance = 1.0 / (1 << 27);
  MapContent content = makeGridMap(2, 4);
  content.tolerance = kTolerance;  // of half the range, which is 2
  const MadeMap made(std::move(content));
  for (const double sign : {-1.0, 1.0}) {
    double theta[] = {0.5, 2.0 + sign * (2.0 + 2.0 * kTolerance)};
    EXPECT_EQ(made.map.locate(theta).status, LookupStatus::kInside);
    EXPECT_EQ(made.map.locateExhaustively(theta).status, LookupStatus::kInside);
    theta[1] = std::nextafter(theta[1], sign * kInfinity);
    EXPECT_EQ(made.map.locate(theta).status, LookupStatus::kOutsideBox);
  }
}

TEST(PointLocationTolerance, IsTheSameOnBothSidesOfAPlane) {
  constexpr double kTolerance = 1.0 / (1 << 27);
  MapContent content = makeGridMap(1, 2);
  content.tolerance = kTolerance;
  const MadeMap made(std::move(content));
  const auto holds = [&](std::size_t region, double theta) { return made.map.contains(region, &theta); };
  const double beyond = 1.0 + kTolerance;
  const double before = 1.0 - kTolerance;
  EXPECT_TRUE(holds(0, beyond));
  EXPECT_FALSE(holds(0, std::nextafter(beyond, 2.0)));
  EXPECT_TRUE(holds(1, before));
  EXPECT_FALSE(holds(1, std::nextafter(before, 0.0)));
  EXPECT_FALSE(holds(1, std::nan("")));
}

TEST(PointLocationLeaf, TheFirstCandidateThatHoldsWins) {
  MapContent content = makeSmallMap();
  content.nodes.clear();
  content.leaves = {{0, 4}};
  content.root = MapContent::kLeaf;
  content.candidates = {3, 1, 0, 2};
  const MadeMap made(std::move(content));
  // All four regions have this corner.
  const double corner[] = {1.0, 1.0};
  EXPECT_EQ(made.map.locate(corner).region, 3u);
  EXPECT_EQ(made.map.locateExhaustively(corner).region, 0u);
  const double right[] = {1.5, 0.5};
  EXPECT_EQ(made.map.locate(right).region, 1u);
  // This point lies between regions 0 and 1.
  const double left[] = {1.0, 0.5};
  EXPECT_EQ(made.map.locate(left).region, 1u);
}

// Two cells with a gap between them: of two regions within the tolerance, the nearer one answers.
TEST(PointLocationLeaf, TheNearestWithinTheToleranceAnswersWhereNoneHolds) {
  MapContent content = makeGridMap(1, 2);  // cells [0, 1] and [1, 2]
  constexpr double kGap = 1.0 / (1 << 27);
  content.tolerance = kGap;
  content.nodes.clear();
  content.leaves = {{0, 2}};
  content.root = MapContent::kLeaf;
  content.candidates = {0, 1};
  // The second cell begins later.
  content.planes.insert(content.planes.end(), {1.0, 1.0 + kGap});
  const auto late = static_cast<std::int32_t>(content.planes.size() / 2);
  for (std::uint32_t i = 0; i < content.regions[1].row_count; ++i) {
    std::int32_t& row = content.rows[content.regions[1].first_row + i];
    if (row < 0) row = -late;
  }
  const MadeMap made(std::move(content));
  const auto region = [&](double theta) {
    const Lookup found = made.map.locate(&theta);
    EXPECT_EQ(found.status, LookupStatus::kInside);
    EXPECT_EQ(made.map.locateExhaustively(&theta).region, found.region);
    return found.region;
  };
  EXPECT_EQ(region(1.0), 0u);
  EXPECT_EQ(region(1.0 + 0.25 * kGap), 0u);
  // Of regions at equal distances, the first one answers.
  EXPECT_EQ(region(1.0 + 0.5 * kGap), 0u);
  EXPECT_EQ(region(1.0 + 0.75 * kGap), 1u);
  EXPECT_EQ(region(1.0 + kGap), 1u);
}

TEST(PointLocationLeaf, AnEmptyLeafIsOutsideThePartition) {
  MapContent content = makeSmallMap();
  content.leaves[2].count = 0;
  const MadeMap made(std::move(content));
  const auto status = [&](double x, double y) {
    const double theta[] = {x, y};
    return made.map.locate(theta).status;
  };
  int outside = 0;
  for (const double x : {0.5, 1.5}) {
    for (const double y : {0.5, 1.5}) outside += status(x, y) == LookupStatus::kOutsidePartition ? 1 : 0;
  }
  EXPECT_EQ(outside, 1);
}

TEST(PointLocationBox, ARangeMayBeASinglePoint) {
  MapContent content = makeSmallMap();
  content.parameters[1].lower = content.parameters[1].upper = 0.5;
  // A plane needs a range to have a length: those of this parameter lean by less than they are apart.
  constexpr double kSteep = 1e6;
  for (std::size_t j = 0; j <= 2; ++j) {
    double* const plane = content.planes.data() + 3 * (3 + j);
    plane[0] = 1.0;
    plane[1] = kSteep;
    plane[2] = kSteep * static_cast<double>(j);
  }
  const MadeMap made(std::move(content));
  const double on[] = {1.5, 0.5};
  const double off[] = {1.5, std::nextafter(0.5, 1.0)};
  EXPECT_EQ(made.map.locate(on).region, 1u);
  EXPECT_EQ(made.map.locate(off).status, LookupStatus::kOutsideBox);
}

TEST(PointLocationAllocation, TheCounterCounts) {
  // Direct calls: compilers may leave out a pair of new and delete.
  const long before = polyfly_test::allocationCount();
  ::operator delete(::operator new(8));
  ::operator delete(::operator new(8, std::align_val_t(64)), std::align_val_t(64));
  const long after = polyfly_test::allocationCount();
  EXPECT_EQ(after, before + 2);
  const MadeMap made(makeSmallMap());
  EXPECT_GT(polyfly_test::allocationCount(), after + 10);
}

TEST(PointLocationAllocation, LookUpsAllocateNothing) {
  for (const std::uint32_t p : {1u, 5u, 8u, 9u}) {
    TreeRecipe recipe;
    recipe.parameters = p;
    recipe.leaf_regions = 3;
    recipe.holes_one_in = 5;
    const MadeMap made(makeTreeMap(recipe));
    Random random(1);
    std::vector<double> points;
    for (int i = 0; i < 300; ++i) {
      std::vector<double> theta = randomPoint(made.content, random, 1.3);
      if (i % 10 == 0) theta[0] = std::nan("");
      points.insert(points.end(), theta.begin(), theta.end());
    }
    int seen[4] = {};
    double u[2];
    const long before = polyfly_test::allocationCount();
    for (std::size_t i = 0; i < points.size(); i += p) {
      const Lookup found = made.map.evaluate(&points[i], u);
      ++seen[static_cast<int>(found.status)];
      made.map.locate(&points[i]);
      made.map.locateExhaustively(&points[i]);
      made.map.contains(0, &points[i]);
    }
    EXPECT_EQ(polyfly_test::allocationCount(), before);
    for (const int count : seen) EXPECT_GT(count, 0) << p << " parameters";
  }
}

TEST(PointLocationThreads, LookUpsMayRunConcurrently) {
  const MadeMap made(makeTreeMap({}));
  const auto total = [&] {
    Random random(5);
    double sum = 0.0;
    for (int i = 0; i < 2000; ++i) {
      double u[2] = {};
      made.map.evaluate(randomPoint(made.content, random, 1.0).data(), u);
      sum += u[0] + u[1];
    }
    return sum;
  };
  double other = 0.0;
  std::thread thread([&] { other = total(); });
  const double here = total();
  thread.join();
  EXPECT_EQ(here, other);
}

}  // namespace
}  // namespace polyfly
