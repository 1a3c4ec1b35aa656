#include "search_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "../src/index_kernel.hpp"
#include "../src/lanes.hpp"
#include "synthetic_map.hpp"

namespace polyfly {
namespace {

using Random = std::mt19937_64;

// The reference of all that follows: the file's own tree, in double.
void expectAsInFile(const RegionMap& map, const std::vector<double>& theta) {
  const Lookup expected = map.locateInFile(theta.data());
  const Lookup found = map.locate(theta.data());
  ASSERT_EQ(found.status, expected.status);
  ASSERT_EQ(found.region, expected.region);
  ASSERT_EQ(found.law, expected.law);
}

/// Onto a plane of the map, as well as rounding lets us, and then `beyond` of a unit vector away.
void moveOnto(const MapContent& content, std::size_t plane, double beyond, std::vector<double>& theta) {
  const std::size_t p = theta.size();
  const double* const a = content.planes.data() + plane * (p + 1);
  // Along the plane's normal where the ranges are all [-1, 1].
  long double distance = -static_cast<long double>(a[p]);
  long double square = 0.0L;
  for (std::size_t i = 0; i < p; ++i) {
    const double half = 0.5 * (content.parameters[i].upper - content.parameters[i].lower);
    distance += static_cast<long double>(a[i]) * theta[i];
    square += static_cast<long double>(a[i] * half) * (a[i] * half);
  }
  if (!(square > 0.0L)) return;
  const long double steps = beyond / std::sqrt(square) - distance / square;
  for (std::size_t i = 0; i < p; ++i) {
    const double half = 0.5 * (content.parameters[i].upper - content.parameters[i].lower);
    theta[i] += static_cast<double>(steps * a[i] * half * half);
  }
}

std::size_t anyPlane(const MapContent& content, Random& random) {
  return random() % (content.planes.size() / (content.parameters.size() + 1));
}

// Anywhere, on planes and beside them at all scales, near several at once, on the box and just outside.
void expectAsInFileEverywhere(const MadeMap& made, std::uint64_t seed, int points) {
  Random random(seed);
  const MapContent& content = made.content;
  for (int i = 0; i < points && !testing::Test::HasFatalFailure(); ++i) {
    std::vector<double> theta = randomPoint(content, random, i % 8 == 0 ? 1.1 : 1.0);
    expectAsInFile(made.map, theta);
    for (int k = 0; k < 3; ++k) {
      std::uniform_real_distribution<double> exponent(-18.0, -2.0);
      const double beyond = random() % 4 == 0 ? 0.0 : std::pow(10.0, exponent(random));
      moveOnto(content, anyPlane(content, random), random() % 2 == 0 ? beyond : -beyond, theta);
      expectAsInFile(made.map, theta);
    }
    const std::size_t axis = random() % theta.size();
    const Signal& range = content.parameters[axis];
    for (const double face : {range.lower, range.upper}) {
      for (const double towards : {range.lower, range.upper, -HUGE_VAL, HUGE_VAL}) {
        theta[axis] = std::nextafter(face, towards);
        expectAsInFile(made.map, theta);
      }
    }
    theta[axis] = i % 2 == 0 ? std::nan("") : HUGE_VAL;
    expectAsInFile(made.map, theta);
  }
}

/// Some of the tests that a map may name.
void spoilTests(MapContent& content, Random& random) {
  for (std::size_t i = 0; i < content.tests.size(); ++i) {
    const std::uint32_t rows = content.regions[content.candidates[i]].row_count;
    const std::uint32_t all = testsOfAll(rows);
    content.tests[i] =
        random() % 4 == 0 ? static_cast<std::uint32_t>(random()) & all : content.tests[i] & all;
  }
}

void addFallbackRegions(MapContent& content, Random& random) {
  content.first_fallback = static_cast<std::uint32_t>(1 + random() % (content.regions.size() - 1));
  for (const MapContent::Leaf& leaf : content.leaves) {
    const auto first = content.candidates.begin() + leaf.first;
    std::stable_partition(first, first + leaf.count,
                          [&](std::uint32_t region) { return region < content.first_fallback; });
  }
}

/// Regions that overlap, leave gaps, have no rows or are fallback regions: all that a valid file may hold.
void spoil(MapContent& content, Random& random) {
  for (std::int32_t& row : content.rows) {
    if (random() % 12 == 0) row = -row;
  }
  for (MapContent::Region& region : content.regions) {
    if (random() % 8 == 0) region.row_count = static_cast<std::uint32_t>(random() % (region.row_count + 1));
  }
  if (content.regions.size() > 1) addFallbackRegions(content, random);
  spoilTests(content, random);
}

class SearchIndexTest : public testing::TestWithParam<std::uint32_t> {};

TEST_P(SearchIndexTest, AnswersAsTheFileDoes) {
  TreeRecipe recipe;
  recipe.parameters = GetParam();
  recipe.regions = 70;
  for (const double tolerance : {0.0, 1e-9, 1e-8}) {
    for (const std::uint32_t leaf_regions : {1u, 4u, 70u}) {
      recipe.tolerance = tolerance;
      recipe.leaf_regions = leaf_regions;
      recipe.holes_one_in = leaf_regions == 4 ? 3 : 0;
      recipe.names_tests = tolerance == 1e-9;
      recipe.seed = 50 * recipe.parameters + leaf_regions;
      MapContent content = makeTreeMap(recipe);
      const MadeMap made(content);
      ASSERT_GT(made.map.indexCost().bytes, 0u);
      expectAsInFileEverywhere(made, recipe.seed, 60);
      Random random(recipe.seed);
      spoil(content, random);
      expectAsInFileEverywhere(MadeMap(content), recipe.seed + 1, 60);
    }
  }
}

TEST_P(SearchIndexTest, AnswersAsTheFileDoesOnGrids) {
  const MadeMap made(makeGridMap(GetParam(), GetParam() <= 4 ? 3 : 2));
  ASSERT_GT(made.map.indexCost().bytes, 0u);
  expectAsInFileEverywhere(made, GetParam(), 200);
  // All multiples of a half: faces and corners of cells, where every number is exact.
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    std::vector<double> theta;
    for (const Signal& range : made.content.parameters) {
      theta.push_back(0.5 * static_cast<double>(random() % static_cast<unsigned>(2.0 * range.upper + 1.0)));
    }
    expectAsInFile(made.map, theta);
  }
}

/// The ranges of the parameters moved and scaled, with the planes, so that all stays where it was in the box.
MapContent inOtherUnits(MapContent content, double centre, double half) {
  const std::size_t p = content.parameters.size();
  for (std::size_t i = 0; i < p; ++i) {
    Signal& range = content.parameters[i];
    const double old_half = 0.5 * (range.upper - range.lower);
    const double old_centre = 0.5 * (range.upper + range.lower);
    range.lower = centre - half;
    range.upper = centre + half;
    const double rounded_half = 0.5 * (range.upper - range.lower);
    for (std::size_t plane = 0; plane < content.planes.size(); plane += p + 1) {
      double& a = content.planes[plane + i];
      double& c = content.planes[plane + p];
      c -= a * old_centre;
      a *= old_half / rounded_half;
      c += a * centre;
    }
  }
  return content;
}

TEST_P(SearchIndexTest, AnswersAsTheFileDoesInAnyUnits) {
  TreeRecipe recipe;
  recipe.parameters = GetParam();
  recipe.leaf_regions = 2;
  recipe.seed = GetParam();
  const MapContent content = makeTreeMap(recipe);
  for (const double centre : {0.0, -3e5, 1e12}) {
    for (const double half : {1.0, 1e-6, 3e7, 1e-100, 1e200, 1e-310}) {
      if (centre != 0.0 && half < 1e-20) continue;
      MapContent other = inOtherUnits(content, centre, half);
      const auto finite = [](double number) { return std::isfinite(number); };
      if (!std::all_of(other.planes.begin(), other.planes.end(), finite)) continue;
      expectAsInFileEverywhere(MadeMap(std::move(other)), recipe.seed, 30);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Parameters, SearchIndexTest, testing::Range(1u, 9u));

// What the margin promises, on the arithmetic itself: sure is right, and twice the bound away all is sure.
template <std::uint32_t kParameters>
void expectMargin(double centre) {
  TreeRecipe recipe;
  recipe.parameters = kParameters;
  recipe.regions = 64;
  recipe.seed = kParameters;
  const MadeMap made(inOtherUnits(makeTreeMap(recipe), centre, 1.0));
  using Kernel = IndexKernel<kParameters>;
  const SearchIndex made_again(made.map);
  const SearchIndex::View& index = made_again.view();
  const double margin = index.margin * 0x1p-28;
  EXPECT_LT(margin, 6e-4);
  const auto sides_of = [&](const std::vector<double>& theta) {
    return Kernel::sides(Kernel::block(index, index.root), Kernel::prepare(index, theta.data()),
                         Lanes::all(2 * index.margin));
  };
  Random random(9);
  int sure = 0, unsure = 0;
  for (int i = 0; i < 4000; ++i) {
    std::vector<double> theta = randomPoint(made.content, random, 0.9);
    const std::uint32_t root = made.map.node(0).plane;
    const double beyond = std::uniform_real_distribution<double>(-2.5, 2.5)(random) * margin;
    moveOnto(made.content, root, beyond, theta);
    if (made.map.locate(theta.data()).status == LookupStatus::kOutsideBox) continue;
    const auto sides = sides_of(theta);
    const std::uint32_t number = Kernel::childNumber(sides);
    EXPECT_EQ(sides.surely & ~sides.perhaps, 0u);
    if (number == Kernel::kNoChild) {
      ++unsure;
      continue;
    }
    ++sure;
    ASSERT_EQ(number >= SearchIndex::kChildren / 2, beyond > 0.0) << beyond;
  }
  EXPECT_GT(sure, 50);
  EXPECT_GT(unsure, 50);
  // Far from every plane of the root's block.
  for (int i = 0; i < 300; ++i) {
    const std::vector<double> theta = randomPoint(made.content, random, 1.0);
    bool near = false;
    for (std::size_t node = 0; node < made.map.nodeCount(); ++node) {
      const double* const a = made.map.plane(made.map.node(node).plane);
      long double distance = -static_cast<long double>(a[kParameters]);
      for (std::size_t k = 0; k < kParameters; ++k) distance += static_cast<long double>(a[k]) * theta[k];
      near = near || std::abs(distance) < 2.0L * margin;
    }
    if (near) continue;
    EXPECT_NE(Kernel::childNumber(sides_of(theta)), Kernel::kNoChild);
  }
}

TEST(SearchIndexMargin, IsABoundOfTheRounding) {
  expectMargin<1>(0.0);
  expectMargin<2>(-7.0);
  expectMargin<4>(0.0);
  expectMargin<5>(1e4);
  expectMargin<8>(0.3);
}

TEST(SearchIndexShape, MapsWithoutATreeOrWithOneRegionHaveOneToo) {
  for (const std::uint32_t cells : {1u, 3u}) {
    MapContent content = makeGridMap(2, cells);
    const auto regions = static_cast<std::uint32_t>(content.regions.size());
    content.nodes.clear();
    content.leaves = {{0, regions}};
    content.root = MapContent::kLeaf;
    content.candidates.clear();
    for (std::uint32_t i = 0; i < regions; ++i) content.candidates.push_back(i);
    const MadeMap made(std::move(content));
    EXPECT_GT(made.map.indexCost().bytes, 0u);
    EXPECT_EQ(made.map.indexCost().blocks, 0u);
    expectAsInFileEverywhere(made, cells, 100);
  }
}

TEST(SearchIndexShape, LeavesMayBeEmptyOrShared) {
  MapContent content = makeGridMap(2, 4);
  for (std::size_t i = 0; i < content.leaves.size(); i += 3) content.leaves[i].count = 0;
  for (MapContent::Node& node : content.nodes) {
    if ((node.above & MapContent::kLeaf) != 0 && node.plane % 2 == 0) node.above = MapContent::kLeaf | 1u;
  }
  expectAsInFileEverywhere(MadeMap(std::move(content)), 1, 200);
}

TEST(SearchIndexShape, ARangeMayBeASinglePoint) {
  MapContent content = makeGridMap(3, 3);
  content.parameters[1].lower = content.parameters[1].upper = 1.5;
  // A plane needs a range to have a length: those of this parameter lean by less than they are apart.
  constexpr double kSteep = 1e6;
  for (std::size_t j = 0; j <= 3; ++j) {
    double* const plane = content.planes.data() + 4 * (4 + j);
    plane[0] = 2.0 / 3.0;
    plane[1] = kSteep;
    plane[3] = kSteep * static_cast<double>(j);
  }
  const MadeMap made(std::move(content));
  EXPECT_GT(made.map.indexCost().bytes, 0u);
  expectAsInFileEverywhere(made, 1, 200);
  const double theta[] = {0.5, 1.5, 2.5};
  EXPECT_EQ(made.map.locate(theta).region, 0u + 3u * 1u + 9u * 2u);
}

// A range too small for a gain of its own still moves planes with huge coefficients.
TEST(SearchIndexShape, ARangeMayBeNearlyAPoint) {
  MapContent content = makeGridMap(2, 2);
  content.parameters[1].lower = 0.0;
  content.parameters[1].upper = 3e-310;
  // The planes theta_0 <= 0, 1, 2 lean by 3e-3 over the range of theta_1. Those of theta_1 would exceed doubles: theta_0 is
  // above or below them everywhere.
  for (std::size_t plane = 0; plane < 3; ++plane) {
    content.planes[3 * plane] = std::sqrt(1.0 - 1.5e-3 * 1.5e-3);
    content.planes[3 * plane + 1] = 1e307;
  }
  const std::vector<double> far = {1.0, 0.0, -9.0, 1.0, 0.0, 9.0, 1.0, 0.0, 9.0};
  std::copy(far.begin(), far.end(), content.planes.begin() + 9);
  const MadeMap made(std::move(content));
  for (int i = 0; i <= 100; ++i) {
    expectAsInFile(made.map, {0.995 + 1e-4 * i, 3e-310});
    expectAsInFile(made.map, {0.995 + 1e-4 * i, 0.0});
  }
  expectAsInFileEverywhere(made, 1, 100);
}

TEST(SearchIndexShape, ThereIsNoneWhereItCannotServe) {
  EXPECT_EQ(MadeMap(makeGridMap(9, 1)).map.indexCost().bytes, 0u);
}

// Leaves of a file may overlap, those of the index do not: it must not grow beyond all measure.
TEST(SearchIndexShape, ThereIsNoneWhereItWouldBeMuchLargerThanTheFile) {
  MapContent content = makeGridMap(1, 256);
  content.candidates.clear();
  for (std::uint32_t i = 0; i < 4096; ++i) content.candidates.push_back(i % 256);
  for (MapContent::Leaf& leaf : content.leaves) leaf = {0, 4096};
  const MadeMap made(std::move(content));
  EXPECT_EQ(made.map.indexCost().bytes, 0u);
  expectAsInFileEverywhere(made, 1, 50);
}

// Two parameters: a block is 8 lanes, a cube's 4 rows are one group of 4, and each lane two multiply-adds.
TEST(SearchIndexShape, ItsCostIsThatOfTheLongestPath) {
  const MadeMap shallow(makeGridMap(2, 2));  // 2 nodes, one block
  EXPECT_EQ(shallow.map.indexCost().blocks, 1u);
  EXPECT_EQ(shallow.map.indexCost().multiply_adds, 2u * (8u + 4u));
  const MadeMap deep(
      makeGridMap(2, 4));  // 4 nodes on each path: fewest blocks are the root's and 2 full ones
  EXPECT_EQ(deep.map.indexCost().blocks, 3u);
  EXPECT_EQ(deep.map.indexCost().multiply_adds, 2u * (16u + 4u));
}

TEST(SearchIndexShape, ItMovesWithItsMap) {
  MadeMap made(makeGridMap(3, 3));
  const RegionMap moved = std::move(made.map);
  const double theta[] = {0.5, 1.5, 2.5};
  EXPECT_EQ(moved.locate(theta).region, 21u);
}

#if defined(__SSE2__)
TEST(LanesTest, AllKindsComputeTheSame) {
  Random random(4);
  struct alignas(16) Words {
    std::int32_t words[4];
  };
  const auto draw = [&] {
    Words words;
    for (std::int32_t& word : words.words) {
      word = static_cast<std::int32_t>(random());
      if (random() % 8 == 0) word = static_cast<std::int32_t>(0x80008000u);
    }
    return words;
  };
  const auto expect_same = [](const PortableLanes::Type& portable, const Sse2Lanes::Type& lanes) {
    PortableLanes::Type other;
    std::memcpy(other.data(), &lanes, sizeof other);
    EXPECT_EQ(portable, other);
    EXPECT_EQ(PortableLanes::negative(portable), Sse2Lanes::negative(lanes));
  };
  for (int i = 0; i < 2000; ++i) {
    const Words a = draw(), b = draw(), c = draw();
    const auto pa = PortableLanes::load(a.words), pb = PortableLanes::load(b.words),
               pc = PortableLanes::load(c.words);
    const auto sa = Sse2Lanes::load(a.words), sb = Sse2Lanes::load(b.words), sc = Sse2Lanes::load(c.words);
    expect_same(PortableLanes::addProducts(pc, pa, pb), Sse2Lanes::addProducts(sc, sa, sb));
    expect_same(PortableLanes::add(pa, pb), Sse2Lanes::add(sa, sb));
    expect_same(PortableLanes::either(pa, pb), Sse2Lanes::either(sa, sb));
    expect_same(PortableLanes::all(a.words[0]), Sse2Lanes::all(a.words[0]));
  }
}
#endif

}  // namespace
}  // namespace polyfly
