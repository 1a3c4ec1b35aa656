// The tree against a test of all regions: inside, on faces, at corners and outside.
#include "offline_mpt/search_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <utility>

#include "map_in_memory.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "random_program.hpp"
#include "tree/growth_limit.hpp"

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

// A balanced tree whose leaves hold one interval each, of which no row is left to test.
TEST(SearchTree, IntervalsAreHalvedUntilNoRowIsLeft) {
  for (const TreeMode mode : {TreeMode::kFast, TreeMode::kAuto, TreeMode::kSmall}) {
    TreeOptions options;
    options.mode = mode;
    const SearchTree tree = buildTree(intervals(), options);
    EXPECT_EQ(tree.leaves.size(), 16u);
    EXPECT_EQ(tree.depth, 4u);
    EXPECT_EQ(mostCandidates(tree), 1u);
    EXPECT_EQ(tree.tests, std::vector<std::uint32_t>(16, 0));
    EXPECT_EQ(tree.end, TreeEnd::kNoGain);
  }
}

TEST(SearchTree, PlanesThatDivideLawsComeFirst) {
  TreeRegions regions = intervals();
  TreeOptions options;
  const SearchTree halves = buildTree(regions, options);
  EXPECT_EQ(halves.nodes.at(0).plane, 8u);
  for (std::uint32_t i = 0; i < 16; ++i) regions.laws.push_back(i < 12 ? 0 : 1);
  const SearchTree laws = buildTree(regions, options);
  EXPECT_EQ(laws.nodes.at(0).plane, 12u);
  EXPECT_EQ(mostCandidates(laws), 1u);
}

// Two planes cross at an angle of 0.005.
TEST(SearchTree, PlanesOfOnePathKeepTheLeastAngle) {
  TreeRegions regions;
  regions.p = 2;
  regions.planes = {0.0, 1.0, 0.0, std::sin(0.005), std::cos(0.005), 0.0};
  regions.rows = {{1, 2}, {1, -2}, {-1, 2}, {-1, -2}};
  regions.centres = {0.0, -0.5, 0.9, -0.002, -0.9, 0.002, 0.0, 0.5};
  TreeOptions options;
  EXPECT_EQ(buildTree(regions, options).depth, 2u);
  options.least_angle = 0.01;
  const SearchTree wide = buildTree(regions, options);
  EXPECT_EQ(wide.depth, 1u);
  EXPECT_EQ(mostCandidates(wide), 2u);
}

TEST(SearchTree, ThereMayBeNoNodes) {
  TreeOptions options;
  options.mode = TreeMode::kNone;
  const SearchTree tree = buildTree(intervals(), options);
  EXPECT_TRUE(tree.nodes.empty());
  EXPECT_EQ(mostCandidates(tree), 16u);
  // The first and the last interval end where the box does.
  EXPECT_EQ(tree.tests.front(), 0b01u);
  EXPECT_EQ(tree.tests[7], 0b11u);
  EXPECT_EQ(tree.tests.back(), 0b10u);
}

TEST(SearchTree, AllRowsAreTestedOnRequest) {
  TreeOptions options;
  options.all_rows = true;
  const SearchTree tree = buildTree(intervals(), options);
  EXPECT_EQ(tree.leaves.size(), 16u);
  EXPECT_TRUE(tree.tests.empty());
}

TEST(SearchTree, TheLimitOnNodesIsKept) {
  const TreeRegions regions = intervals();
  for (const std::uint64_t limit : {1u, 2u, 3u, 7u, 100u}) {
    TreeOptions options;
    options.node_limit = limit;
    const SearchTree tree = buildTree(regions, options);
    EXPECT_EQ(tree.nodes.size(), std::min<std::size_t>(limit, 15));
    EXPECT_EQ(tree.end, limit < 15 ? TreeEnd::kNodes : TreeEnd::kNoGain);
    std::size_t listed = 0;
    for (const MapContent::Leaf& leaf : tree.leaves) listed += leaf.count;
    EXPECT_EQ(listed, 16u);
  }
}

/// Half-spaces that the worst look-up evaluates.
std::uint64_t worstCase(const MapContent& content) {
  const MapInMemory memory(content);
  const std::uint64_t p = content.parameters.size();
  return memory.map().cost().multiply_adds / p - content.inputs.size();
}

TEST(SearchTree, ALargerTreeHasABetterWorstCase) {
  const ParametricProgram program = randomProgram(8, 24, 4, 3);
  const Partition partition = explore(program);
  std::uint64_t last = std::numeric_limits<std::uint64_t>::max();
  for (const TreeMode mode : {TreeMode::kNone, TreeMode::kFast, TreeMode::kAuto, TreeMode::kSmall}) {
    TreeOptions options;
    options.mode = mode;
    const std::uint64_t worst = worstCase(encode(program, partition, options));
    EXPECT_LE(worst, last) << toString(mode);
    last = worst;
  }
  EXPECT_LE(last, 2.0 * std::log2(static_cast<double>(partition.regions.size())) + 8.0);
}

// Of trees that try 3, 4 and 20 planes of each cell, and none of them is always the best.
TEST(SearchTree, TheBestOfSeveralSmallTreesIsKept) {
  int is_better = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const ParametricProgram program = randomProgram(4, 14, 3, seed);
    const Partition partition = explore(program);
    const auto cost = [&](std::uint64_t planes_tried) {
      TreeOptions options;
      options.mode = TreeMode::kSmall;
      options.planes_tried = planes_tried;
      const MapInMemory memory(encode(program, partition, options));
      return std::make_pair(memory.map().cost().multiply_adds, memory.map().nodeCount());
    };
    const auto best = cost(3), with_more = cost(4), with_most = cost(20);
    EXPECT_LE(best, with_more) << seed;
    EXPECT_LE(with_more, with_most) << seed;
    if (best < with_most) ++is_better;
  }
  EXPECT_GT(is_better, 0);
}

// Rows are left out only where the nodes, the box and the other rows imply them: a row that is left out holds at each
// parameter whose leaf it belongs to and that meets the others.
TEST(SearchTree, RowsThatAreLeftOutAreImplied) {
  for (const int p : {2, 3, 5}) {
    const ParametricProgram program = randomProgram(6, 16, p, 11);
    const Partition partition = explore(program);
    const MapInMemory memory(encode(program, partition));
    const RegionMap& map = memory.map();
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::size_t left_out = 0;
    for (int k = 0; k < 5000; ++k) {
      const Eigen::VectorXd theta = Eigen::VectorXd::NullaryExpr(p, [&] { return uniform(random); });
      const auto violation = [&](std::int32_t row) {
        const double* const plane = map.plane(static_cast<std::size_t>(std::abs(row)) - 1);
        const double distance = Eigen::Map<const Eigen::VectorXd>(plane, p).dot(theta) - plane[p];
        return row > 0 ? distance : -distance;
      };
      std::uint32_t child = map.root();
      while ((child & MapContent::kLeaf) == 0) {
        const MapContent::Node& node = map.node(child);
        child = violation(static_cast<std::int32_t>(node.plane) + 1) <= 0.0 ? node.below : node.above;
      }
      const LeafView leaf = map.leaf(child & ~MapContent::kLeaf);
      for (std::uint32_t i = 0; i < leaf.count; ++i) {
        const RegionView region = map.region(leaf.candidates[i]);
        double tested = -1.0, others = -1.0;
        for (std::uint32_t row = 0; row < region.row_count; ++row) {
          double& worst = isTested(leaf.testsOf(i), row) ? tested : others;
          worst = std::max(worst, violation(region.rows[row]));
          left_out += isTested(leaf.testsOf(i), row) ? 0 : 1;
        }
        if (tested > 0.0) continue;
        EXPECT_LE(others, 1e-9);
      }
    }
    EXPECT_GT(left_out, 1000u);
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
  EXPECT_EQ(tree.end, TreeEnd::kStopped);
  EXPECT_EQ(mostCandidates(tree), 16u);
}

// A tree whose cells would take too much memory grows in one cell after the other.
TEST(SearchTree, GrowsInPartsWhereMemoryIsShort) {
  const ParametricProgram program = randomProgram(8, 24, 4, 3);
  const Partition partition = explore(program);
  TreeOptions options;
  const std::uint64_t whole = worstCase(encode(program, partition, options));
  options.memory_limit = 2000 * partition.regions.size();
  const MapContent one = encode(program, partition, options);
  options.threads = 3;
  EXPECT_EQ(layOut(one), layOut(encode(program, partition, options)));
  EXPECT_LE(one.nodes.size(), std::max<std::size_t>(4096, 2 * partition.regions.size()));
  const MapInMemory memory(one);
  EXPECT_LE(worstCase(one), 2 * whole);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.05, 1.05);
  for (int k = 0; k < 5000; ++k)
    expectSameAnswer(memory.map(), Eigen::VectorXd::NullaryExpr(4, [&] { return uniform(random); }));
}

TEST(SearchTree, TheLimitOnMemoryIsKept) {
  const TreeRegions regions = intervals();
  TreeOptions options;
  options.memory_limit = 1;
  const SearchTree tree = buildTree(regions, options);
  EXPECT_EQ(tree.end, TreeEnd::kMemory);
  EXPECT_TRUE(tree.nodes.empty());
  EXPECT_EQ(mostCandidates(tree), 16u);
}

// Of a program whose parameters range from -1 to 1.
TreeRegions regionsOf(const ParametricProgram& program, const Partition& partition) {
  TreeOptions none;
  none.mode = TreeMode::kNone;
  const MapContent content = encode(program, partition, none);
  TreeRegions regions;
  regions.p = program.parameterCount();
  regions.planes = content.planes;
  for (std::size_t r = 0; r < content.regions.size(); ++r) {
    const auto first = content.rows.begin() + content.regions[r].first_row;
    regions.rows.emplace_back(first, first + content.regions[r].row_count);
    const Eigen::VectorXd& centre = partition.regions[r].centre;
    regions.centres.insert(regions.centres.end(), centre.data(), centre.data() + centre.size());
  }
  return regions;
}

// The work of a fast tree follows that of the exploration, also where parts of regions are many.
TEST(SearchTree, AFastTreeTakesFewPivots) {
  for (const int p : {4, 6, 7}) {
    const ParametricProgram program = randomProgram(6, 30, p, 2);
    const Partition partition = explore(program);
    TreeOptions options;
    options.mode = TreeMode::kFast;
    options.explored_pivots = partition.stats.lp_pivots;
    const double least = 40000.0, explored = static_cast<double>(options.explored_pivots);
    const SearchTree tree = buildTree(regionsOf(program, partition), options);
    EXPECT_GT(tree.nodes.size(), 1u);
    EXPECT_LE(static_cast<double>(tree.pivots), 2.2 * std::max(least, explored)) << p;
  }
}

// A default tree ends at 150 pivots per half-space of the regions, but not below 1 million. Of them, 40 % are enough
// from 5 parameters on, once the worst look-up evaluates one half-space of 64.
TEST(SearchTree, TheLimitOnPivotsFollowsTheHalfSpaces) {
  const auto end = [](TreeMode mode, std::size_t half_spaces, std::uint64_t explored, std::uint64_t pivots,
                      std::uint64_t worst, int parameters = 5) {
    TreeRegions regions = intervals();
    regions.p = parameters;
    regions.rows.assign(half_spaces / 2, {1, 2});
    TreeOptions options;
    options.mode = mode;
    options.explored_pivots = explored;
    Growth now;
    now.pivots = pivots;
    now.worst = worst;
    return GrowthLimit(regions, options).reached(now);
  };
  EXPECT_EQ(end(TreeMode::kAuto, 200, 10, 999999, 100), std::nullopt);
  EXPECT_EQ(end(TreeMode::kAuto, 200, 10, 1000000, 100), TreeEnd::kPivots);
  EXPECT_EQ(end(TreeMode::kAuto, 20000, 10, 2999999, 313), std::nullopt);
  EXPECT_EQ(end(TreeMode::kAuto, 20000, 0, 3000000, 313), TreeEnd::kPivots);
  EXPECT_EQ(end(TreeMode::kAuto, 20000, 0, 1199999, 312), std::nullopt);
  EXPECT_EQ(end(TreeMode::kAuto, 20000, 0, 1200000, 312), TreeEnd::kPivots);
  EXPECT_EQ(end(TreeMode::kAuto, 20000, 0, 2999999, 1, 4), std::nullopt);
  EXPECT_EQ(end(TreeMode::kFast, 20000, 0, 40000, 313), TreeEnd::kPivots);
  EXPECT_EQ(end(TreeMode::kFast, 20000, 50000, 49999, 0), std::nullopt);
  EXPECT_EQ(end(TreeMode::kSmall, 200, 10, 1000000000, 0), std::nullopt);
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
