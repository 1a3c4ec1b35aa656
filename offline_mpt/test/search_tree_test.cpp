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
  options.law_rows = 16;  // of eight intervals
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

}  // namespace
}  // namespace polyfly
