// The tree against a test of all regions: inside, on faces, at corners and outside.
#include "offline_mpt/search_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>

#include "map_in_memory.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "random_program.hpp"
#include "tree/tree_cells.hpp"

namespace polyfly {
namespace {

double answer(const RegionMap& map, const Lookup& lookup, const Eigen::VectorXd& theta) {
  const double* law = map.law(lookup.law);
  double u = law[theta.size()];
  for (Eigen::Index j = 0; j < theta.size(); ++j) u += law[j] * theta(j);
  return u;
}

void expectSameAnswer(const RegionMap& map, const Eigen::VectorXd& theta) {
  const Lookup tree = map.locate(theta.data());
  const Lookup all = map.locateExhaustively(theta.data());
  ASSERT_EQ(tree.status, all.status) << theta.transpose();
  if (tree.status != LookupStatus::kInside) return;
  const double expected = answer(map, all, theta);
  EXPECT_NEAR(answer(map, tree, theta), expected, 1e-6 * (1.0 + std::abs(expected))) << theta.transpose();
}

class TreeOverGenerated : public ::testing::TestWithParam<int> {};

TEST_P(TreeOverGenerated, AnswersAsTheTestOfAllRegions) {
  const int p = GetParam();
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const ParametricProgram program = randomProgram(p < 4 ? 4 : 2, p < 4 ? 14 : 8, p, seed);
    const Partition partition = explore(program);
    const MapInMemory memory(encode(program, partition));
    const RegionMap& map = memory.map();
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1.05, 1.05);
    for (int k = 0; k < 2000; ++k) {
      expectSameAnswer(map, Eigen::VectorXd::NullaryExpr(p, [&] { return uniform(random); }));
    }
    // on every facet, straight across from the region's centre
    for (const CriticalRegion& region : partition.regions) {
      for (Eigen::Index f = 0; f < region.G.rows(); ++f) {
        const Eigen::VectorXd a = region.G.row(f);
        const double slack = region.g(f) - a.dot(region.centre);
        expectSameAnswer(map, region.centre + slack / a.squaredNorm() * a);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Parameters, TreeOverGenerated, ::testing::Values(1, 2, 3, 4, 5));

TEST(SearchTree, DepthIsBalancedAndStated) {
  const ParametricProgram program = randomProgram(8, 24, 3, 5);
  const Partition partition = explore(program);
  const MapInMemory memory(encode(program, partition));
  const double regions = static_cast<double>(partition.regions.size());
  ASSERT_GT(regions, 20.0);
  EXPECT_LE(memory.map().cost().depth, 2.0 * std::log2(regions) + 4.0);
}

TEST(SearchTree, OneRegionNeedsNoNode) {
  ParametricProgram program = randomProgram(2, 1, 2, 1);
  program.b(0) = 1e6;  // never active
  const Partition partition = explore(program);
  ASSERT_EQ(partition.regions.size(), 1u);
  const MapInMemory memory(encode(program, partition));
  EXPECT_EQ(memory.map().nodeCount(), 0u);
  expectSameAnswer(memory.map(), Eigen::Vector2d(0.3, -0.9));
  expectSameAnswer(memory.map(), Eigen::Vector2d(1.3, -0.9));
}

// Intervals [i, i + 1] / 8 - 1 as regions.
TreeRegions intervals() {
  TreeRegions regions;
  regions.p = 1;
  constexpr int kCount = 16;
  for (int i = 0; i <= kCount; ++i) regions.planes.insert(regions.planes.end(), {1.0, i / 8.0 - 1.0});
  for (int i = 0; i < kCount; ++i) {
    regions.rows.push_back({i + 2, -(i + 1)});
    regions.centres.push_back((i + 0.5) / 8.0 - 1.0);
  }
  return regions;
}

std::size_t mostCandidates(const SearchTree& tree) {
  std::size_t most = 0;
  for (const MapContent::Leaf& leaf : tree.leaves) most = std::max<std::size_t>(most, leaf.count);
  return most;
}

TEST(SearchTree, IntervalsAreHalvedUntilALeafIsSmallEnough) {
  const TreeRegions regions = intervals();
  for (int leaf_regions = 1; leaf_regions <= 16; leaf_regions *= 2) {
    TreeOptions options;
    options.leaf_regions = leaf_regions;
    const SearchTree tree = buildTree(regions, options);
    EXPECT_EQ(tree.leaves.size(), 16u / static_cast<unsigned>(leaf_regions));
    EXPECT_EQ(mostCandidates(tree), static_cast<std::size_t>(leaf_regions));
    EXPECT_EQ(1u << tree.depth, tree.leaves.size());
  }
}

TEST(SearchTree, RegionsOfOneLawMayShareALeaf) {
  TreeRegions regions = intervals();
  for (std::size_t i = 0; i < 16; ++i) regions.laws.push_back(i < 8 ? 0 : static_cast<std::uint32_t>(i));
  TreeOptions options;
  options.leaf_regions = 1;
  // Half-spaces of eight intervals.
  options.law_rows = 16;
  const SearchTree tree = buildTree(regions, options);
  EXPECT_EQ(tree.leaves.size(), 9u);
  EXPECT_EQ(mostCandidates(tree), 8u);
  options.law_rows = 15;
  EXPECT_EQ(mostCandidates(buildTree(regions, options)), 4u);
}

TEST(SearchTree, TheLimitOnNodesIsKept) {
  const TreeRegions regions = intervals();
  for (const std::uint64_t limit : {1u, 2u, 3u, 7u, 100u}) {
    TreeOptions options;
    options.leaf_regions = 1;
    options.node_limit = limit;
    const SearchTree tree = buildTree(regions, options);
    EXPECT_LE(tree.nodes.size(), limit);
    EXPECT_GE(tree.nodes.size(), std::min<std::size_t>(limit, 15) / 2);
    std::size_t listed = 0;
    for (const MapContent::Leaf& leaf : tree.leaves) listed += leaf.count;
    EXPECT_EQ(listed, 16u);
  }
}

TEST(SearchTree, ThreadsDoNotChangeIt) {
  const ParametricProgram program = randomProgram(8, 24, 4, 3);
  const Partition partition = explore(program);
  ASSERT_GT(partition.regions.size(), 200u);  // more than one task
  TreeOptions options;
  const MapContent one = encode(program, partition, options);
  std::uint64_t last = 0;
  options.threads = 3;
  options.progress = [&last](std::uint64_t done, std::uint64_t total) {
    EXPECT_LE(done, total);
    EXPECT_GE(done, last);
    last = done;
  };
  const MapContent three = encode(program, partition, options);
  EXPECT_EQ(layOut(one), layOut(three));
  EXPECT_GT(last, 0u);
}

TEST(SearchTree, EndsEarlyWhenToldTo) {
  const std::atomic<bool> stop{true};
  TreeOptions options;
  options.stop = &stop;
  const SearchTree tree = buildTree(intervals(), options);
  EXPECT_EQ(tree.nodes.size(), 0u);
  EXPECT_EQ(mostCandidates(tree), 16u);
}

// Regions that overlap cannot be separated: they share a leaf, and the first one answers.
TEST(SearchTree, OverlappingRegionsShareALeaf) {
  TreeRegions regions;
  regions.p = 1;
  regions.planes = {1.0, 0.5, 1.0, -0.5};  // t <= 0.5, t <= -0.5
  regions.rows = {{1, -2}, {1, -2}};       // both are [-0.5, 0.5]
  regions.centres = {0.0, 0.0};
  const SearchTree tree = buildTree(regions);
  EXPECT_EQ(mostCandidates(tree), 2u);
}

/// A regular polygon of many sides, and planes 0: x <= 0, 1 and 2: cut off its uppermost and lowest points on
/// x = 0, which are no corners.
TreeRegions polygonWithCuts() {
  constexpr int kSides = 60;
  constexpr double kTurn = 2.0 * M_PI / kSides;
  // Height at which x = 0 meets a side.
  const double top = 0.9 / std::cos(0.25 * kTurn);
  TreeRegions regions;
  regions.p = 2;
  regions.planes = {1.0, 0.0, 0.0, 0.6, 0.8, 0.8 * top - 1e-3, 0.6, -0.8, 0.8 * top - 1e-3};
  regions.rows.emplace_back();
  for (int k = 0; k < kSides; ++k) {
    const double angle = (k + 0.25) * kTurn;
    regions.planes.insert(regions.planes.end(), {std::cos(angle), std::sin(angle), 0.9});
    regions.rows[0].push_back(k + 4);
  }
  regions.centres = {0.0, 0.0};
  return regions;
}

// The point that shows a side may give way to that of the next plane tried. The part on that side once kept
// an inner point on the other, and then seemed to reach where it does not: the tree got leaves without
// interior, and parameters in them, by rounding, no answer.
TEST(SearchTree, PartsOfRegionsKeepAPointInside) {
  const TreeRegions regions = polygonWithCuts();
  TreeGeometry geometry(regions, 1e-9, 1);
  CellSplitter splitter(geometry);
  CellMembers whole = geometry.takeMembers(), left, right;
  std::vector<std::int32_t> path;
  splitter.divide(whole, 0, path, {static_cast<unsigned char>(splitter.sides(whole[0], 0, path))}, left,
                  right);
  ASSERT_EQ(left.size(), 1u);
  path = {1};
  for (const std::size_t plane : {std::size_t{1}, std::size_t{2}}) {
    CellMembers members = left, below, above;
    const unsigned sides = splitter.sides(members[0], plane, path);
    ASSERT_EQ(sides, kBelow | kAbove);
    ASSERT_EQ(splitter.sides(members[0], 3 - plane, path), kBelow | kAbove);
    splitter.divide(members, plane, path, {static_cast<unsigned char>(sides)}, below, above);
    ASSERT_EQ(below.size() + above.size(), 2u);
    const auto distance = [&](std::size_t of, const CellMember& part) {
      const double* row = regions.planes.data() + 3 * of;
      return row[0] * part.inner[0] + row[1] * part.inner[1] - row[2];
    };
    EXPECT_LT(distance(plane, below[0]), 0.0);
    EXPECT_GT(distance(plane, above[0]), 0.0);
    EXPECT_LT(distance(0, above[0]), 0.0);
    for (std::size_t k = 3; k < regions.planes.size() / 3; ++k) EXPECT_LT(distance(k, above[0]), 0.0);
  }
}

}  // namespace
}  // namespace polyfly
