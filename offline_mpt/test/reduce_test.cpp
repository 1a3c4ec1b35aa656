// Reduced maps against known optima, brute force, the original's answers and the exact proof.
#include "offline_mpt/reduce.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "exact_programs.hpp"
#include "grid_map.hpp"
#include "map_in_memory.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "offline_mpt/reduce_proven.hpp"
#include "offline_mpt/verify.hpp"
#include "offline_mpt/verify_reduction.hpp"
#include "polyfly_base/error.hpp"
#include "random.hpp"
#include "reduction_mutation.hpp"
#include "reference_problems.hpp"

namespace polyfly {
namespace {

ReduceOptions with(TreeMode tree) {
  ReduceOptions options;
  options.tree = tree;
  return options;
}

/// Reduces, and expects the exact proof, and that the checker confirms it.
ReduceResult reduceAndProve(const MapInMemory& original, const ReduceOptions& options = {}) {
  ReduceResult result = reduce(original.map(), options);
  const MapInMemory reduced(result.content);
  ReductionOptions proof;
  proof.certificate = true;
  const ReductionReport report = verifyReduction(reduced.map(), original.map(), proof);
  EXPECT_TRUE(report.passed()) << reductionText(report);
  EXPECT_EQ(reductionRefusal(report.certificate, reduced.bytes(), original.bytes()), "");
  return result;
}

/// Regions with the law of the letter a.
std::size_t regionsOfA(const MapContent& content) {
  return static_cast<std::size_t>(
      std::count_if(content.regions.begin(), content.regions.end(),
                    [&](const auto& region) { return content.laws[region.law * 3] == kGainOfA; }));
}

struct Shape {
  const char* name;
  std::vector<GridRectangle> rectangles;
  // Size of the square.
  int size;
  // Number of convex unions for law a.
  std::size_t unions;
};

std::vector<Shape> shapes() {
  return {
      {"L", cellsOf({"aa", "ab"}), 2, 2},
      {"square", cellsOf({"aa", "aa"}), 2, 1},
      // Two would do, but they overlap.
      {"plus", cellsOf({"bac", "aaa", "dae"}), 3, 3},
      {"ring", cellsOf({"aaa", "aba", "aaa"}), 3, 4},
      {"apart", cellsOf({"aba", "cdc", "aba"}), 3, 4},
      {"stairs", cellsOf({"aaa", "aab", "abb"}), 3, 3},
      // No two of them have a convex union, all five have.
      {"pinwheel",
       {{0, 2, 0, 1, 'a'}, {2, 3, 0, 2, 'a'}, {1, 3, 2, 3, 'a'}, {0, 1, 1, 3, 'a'}, {1, 2, 1, 2, 'a'}},
       3,
       1},
  };
}

TEST(Reduce, JoinsKnownShapes) {
  for (const Shape& shape : shapes()) {
    const MapInMemory original(gridMap(shape.size, shape.size, shape.rectangles));
    const ReduceResult result = reduceAndProve(original);
    EXPECT_EQ(regionsOfA(result.content), shape.unions) << shape.name;
  }
}

/// Fewest rectangles of cells with one letter that cover all of these, by trying all choices of so many.
std::size_t fewestRectangles(const std::vector<std::string>& rows, char law) {
  const int height = static_cast<int>(rows.size()), width = static_cast<int>(rows[0].size());
  unsigned wanted = 0;
  const auto bit = [&](int x, int y) { return 1u << (y * width + x); };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) wanted |= rows[y][x] == law ? bit(x, y) : 0u;
  }
  std::vector<unsigned> rectangles;
  for (int x0 = 0; x0 < width; ++x0) {
    for (int x1 = x0; x1 < width; ++x1) {
      for (int y0 = 0; y0 < height; ++y0) {
        for (int y1 = y0; y1 < height; ++y1) {
          unsigned mask = 0;
          for (int x = x0; x <= x1; ++x) {
            for (int y = y0; y <= y1; ++y) mask |= bit(x, y);
          }
          if ((mask & ~wanted) == 0) rectangles.push_back(mask);
        }
      }
    }
  }
  std::set<unsigned> reached = {0};
  for (std::size_t count = 0;; ++count) {
    if (reached.count(wanted) != 0) return count;
    std::set<unsigned> next;
    for (const unsigned cells : reached) {
      for (const unsigned rectangle : rectangles) next.insert(cells | rectangle);
    }
    reached = std::move(next);
  }
}

TEST(Reduce, IsNeverBelowBruteForceOnRandomGrids) {
  Random random(11);
  for (int trial = 0; trial < 12; ++trial) {
    std::vector<std::string> rows(3, "aaaa");
    for (std::string& row : rows) {
      for (char& cell : row) cell = random.below(3) == 0 ? 'b' : random.below(8) == 0 ? '.' : 'a';
    }
    rows[0][0] = 'a';
    const MapInMemory original(gridMap(4, 3, cellsOf(rows)));
    const std::size_t fewest = fewestRectangles(rows, 'a') + fewestRectangles(rows, 'b');
    const std::size_t regions = reduceAndProve(original).content.regions.size();
    EXPECT_GE(regions, fewest) << trial;
    EXPECT_LT(regions, original.map().regionCount()) << trial;
  }
}

/// Places of the box away from the planes of the grid.
std::vector<std::array<double, 2>> places(const RegionMap& map, int steps) {
  const Signal& x = map.parameters()[0];
  const Signal& y = map.parameters()[1];
  std::vector<std::array<double, 2>> result;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j)
      result.push_back({x.lower + (x.upper - x.lower) * (i + 0.4) / steps,
                        y.lower + (y.upper - y.lower) * (j + 0.6) / steps});
  }
  return result;
}

void expectSameAnswers(const RegionMap& a, const RegionMap& b, int steps) {
  for (const std::array<double, 2>& theta : places(a, steps)) {
    double u = 0.0, v = 0.0;
    const Lookup found = b.evaluate(theta.data(), &v);
    ASSERT_EQ(a.evaluate(theta.data(), &u).status, found.status) << theta[0] << ", " << theta[1];
    EXPECT_EQ(found.status, b.locateExhaustively(theta.data()).status);
    if (found.status == LookupStatus::kInside) {
      EXPECT_NEAR(u, v, 1e-12);
    }
  }
}

/// Whether the maps answer differently at one of many places of the box.
bool differSomewhere(const RegionMap& a, const RegionMap& b) {
  const std::vector<std::array<double, 2>> all = places(a, 200);
  return std::any_of(all.begin(), all.end(), [&](const std::array<double, 2>& theta) {
    double u = 0.0, v = 0.0;
    return a.evaluate(theta.data(), &u).status != b.evaluate(theta.data(), &v).status ||
           std::abs(u - v) > 1e-9;
  });
}

/// Every map that `change` makes of the reduced one must be refuted.
void expectRefuted(const MapInMemory& original, const MapContent& changed, const std::string& what) {
  const MapInMemory memory(changed);
  const ReductionReport report = verifyReduction(memory.map(), original.map());
  ASSERT_FALSE(report.passed()) << what;
  for (const ReductionDefect& defect : report.defects) {
    if (defect.kind == ReductionDefect::Kind::kAnswer) {
      EXPECT_TRUE(differSomewhere(original.map(), memory.map())) << what << ": " << defect.text;
      continue;
    }
    // The witness shows it: the maps do not answer alike there.
    double u = 0.0, v = 0.0;
    const Lookup here = original.map().evaluate(defect.witness.data(), &u);
    const Lookup there = memory.map().evaluate(defect.witness.data(), &v);
    EXPECT_TRUE(defect.kind == ReductionDefect::Kind::kClaim || here.status != there.status ||
                std::abs(u - v) > 1e-9)
        << what << ": " << defect.text;
  }
}

TEST(ReductionProof, RefutesEveryMutation) {
  const MapInMemory original(gridMap(8, 3, cellsOf({"UUbL....", "UbcL....", "bcLL...."})));
  for (const TreeMode mode : {TreeMode::kAuto, TreeMode::kSmall}) {
    const MapContent good = reduceAndProve(original, with(mode)).content;
    for (const auto& [what, changed] : wrongMaps(good)) expectRefuted(original, changed, what);
  }
}

TEST(ReductionProof, RefusesMapsThatDoNotBelongTogether) {
  const MapInMemory original(gridMap(2, 2, cellsOf({"aa", "ab"})));
  const MapInMemory other(gridMap(2, 2, cellsOf({"aa", "bb"})));
  const MapInMemory reduced(reduce(original.map()).content);
  EXPECT_THROW(verifyReduction(reduced.map(), other.map()), Error);
  EXPECT_THROW(verifyReduction(original.map(), original.map()), Error);
  EXPECT_THROW(verifyReduction(reduced.map(), reduced.map()), Error);
  EXPECT_THROW(reduce(reduced.map()), Error);
  MapContent changed = reduce(original.map()).content;
  changed.solver_status = "limited";
  EXPECT_THROW(verifyReduction(MapInMemory(changed).map(), original.map()), Error);
}

TEST(ReduceProven, GivesTheReducedMapWithItsProof) {
  const MapInMemory original(gridMap(4, 3, cellsOf({"UUbL", "UbcL", "bcLL"})));
  ReductionOptions proof;
  proof.certificate = true;
  const ProvenReduction proven = reduceProven(original.map(), "small", {}, proof);
  ASSERT_TRUE(proven.report.passed()) << reductionText(proven.report);
  const RegionMap small = proven.image.view("small");
  EXPECT_LT(small.regionCount(), original.map().regionCount());
  EXPECT_EQ(small.reducedFrom(), original.map().checksum());
  const MapInMemory expected(reduce(original.map()).content);
  EXPECT_EQ(small.checksum(), expected.map().checksum());
  EXPECT_EQ(reductionRefusal(proven.report.certificate, expected.bytes(), original.bytes()), "");
}

TEST(Reduce, TakesMapsThatAreNotComplete) {
  MapContent content = gridMap(2, 2, cellsOf({"aa", "ab"}));
  content.solver_status = "limited";
  EXPECT_NO_THROW(reduce(MapInMemory(content).map()));
}

// A leaf of one region tests no rows that the way to it implies.
TEST(Reduce, LookUpsTestOnlyWhatTheTreeDoesNotImply) {
  const ParametricProgram program = doubleIntegrator(5);
  const MapInMemory original(encode(program, explore(program)));
  EXPECT_TRUE(reduceAndProve(original).content.tests.empty());
  MapContent content = reduceAndProve(original, with(TreeMode::kSmall)).content;
  const LookupCost named = MapInMemory(content).map().cost();
  content.tests.clear();
  const MapInMemory whole(content);
  EXPECT_TRUE(verifyReduction(whole.map(), original.map()).passed());
  EXPECT_LT(named.multiply_adds, whole.map().cost().multiply_adds);
}

/// Depth of the shallowest tree of the grid's lines whose leaves hold one letter, by trying all of them.
std::size_t leastDepth(const std::vector<std::string>& rows, std::size_t x0, std::size_t x1, std::size_t y0,
                       std::size_t y1) {
  bool is_one = true;
  for (std::size_t y = y0; y < y1; ++y) {
    for (std::size_t x = x0; x < x1; ++x) is_one = is_one && rows[y][x] == rows[y0][x0];
  }
  if (is_one) return 0;
  std::size_t least = rows.size() * rows[0].size();
  for (std::size_t x = x0 + 1; x < x1; ++x)
    least = std::min(least, 1 + std::max(leastDepth(rows, x0, x, y0, y1), leastDepth(rows, x, x1, y0, y1)));
  for (std::size_t y = y0 + 1; y < y1; ++y)
    least = std::min(least, 1 + std::max(leastDepth(rows, x0, x1, y0, y), leastDepth(rows, x0, x1, y, y1)));
  return least;
}

/// Nodes whose both children are leaves of one candidate with the same law.
std::size_t uselessNodes(const MapContent& map) {
  const auto law = [&](std::uint32_t child) -> std::int64_t {
    if ((child & MapContent::kLeaf) == 0) return -1;
    const MapContent::Leaf& leaf = map.leaves[child & ~MapContent::kLeaf];
    return leaf.count == 1 ? map.regions[map.candidates[leaf.first]].law : -1;
  };
  return static_cast<std::size_t>(std::count_if(map.nodes.begin(), map.nodes.end(), [&](const auto& node) {
    return law(node.below) >= 0 && law(node.below) == law(node.above);
  }));
}

TEST(Reduce, LeavesOfSmallTreesHoldOneLawWhereTheMapFillsItsBox) {
  Random random(5);
  const ReduceOptions options = with(TreeMode::kSmall);
  for (int trial = 0; trial < 8; ++trial) {
    std::vector<std::string> rows(4, "aaaaa");
    for (std::string& row : rows) {
      for (char& cell : row) cell = static_cast<char>('a' + random.below(3));
    }
    const MapInMemory original(gridMap(5, 4, cellsOf(rows)));
    const MapContent content = reduceAndProve(original, options).content;
    for (const MapContent::Leaf& leaf : content.leaves) EXPECT_EQ(leaf.count, 1u) << trial;
    for (const std::uint32_t tests : content.tests) EXPECT_EQ(tests, 0u) << trial;
    EXPECT_EQ(uselessNodes(content), 0u) << trial;
    const MapInMemory reduced(content);
    expectSameAnswers(original.map(), reduced.map(), 40);
    const std::size_t least = leastDepth(rows, 0, 5, 0, 4);
    EXPECT_GE(reduced.map().cost().depth, least) << trial;
    EXPECT_LE(reduced.map().cost().depth, least + 1) << trial;
  }
}

TEST(Reduce, SmallTreesTellWhatIsOutside) {
  Random random(6);
  const ReduceOptions options = with(TreeMode::kSmall);
  for (int trial = 0; trial < 8; ++trial) {
    std::vector<std::string> rows(4, "aaaaa");
    for (std::string& row : rows) {
      for (char& cell : row) cell = random.below(5) == 0 ? '.' : random.below(2) == 0 ? 'a' : 'b';
    }
    rows[0][0] = 'a';
    const MapInMemory original(gridMap(5, 4, cellsOf(rows)));
    expectSameAnswers(original.map(), MapInMemory(reduceAndProve(original, options).content).map(), 40);
  }
}

TEST(Reduce, GivesTheSameBytesForAnyNumberOfThreads) {
  const MapInMemory original(gridMap(7, 4, cellsOf({"LaULLbL", "LLbUabL", "LaUUUcL", "aLUbUUa"})));
  for (const TreeMode mode : {TreeMode::kAuto, TreeMode::kSmall}) {
    ReduceOptions options = with(mode);
    const std::vector<std::byte> bytes = layOut(reduce(original.map(), options).content);
    options.threads = 3;
    EXPECT_EQ(layOut(reduce(original.map(), options).content), bytes);
  }
}

TEST(Reduce, KeepsWhatIsProvenOfAController) {
  const ParametricProgram program = doubleIntegrator(5);
  const MapInMemory original(encode(program, explore(program)));
  const ReduceResult result = reduceAndProve(original);
  EXPECT_LT(result.content.regions.size(), original.map().regionCount());
  EXPECT_GT(result.stats.merged_laws, 0u);
  const MapInMemory reduced(result.content);
  VerifyOptions options;
  options.samples = 1500;
  const VerifyReport report = verify(reduced.map(), program, options);
  EXPECT_TRUE(report.passed()) << verifyText(report);
  EXPECT_THROW(certify(reduced.map(), program), Error);
}

// However small u is, laws that differ stay apart.
TEST(Reduce, DoesNotDependOnTheUnitOfTheInput) {
  for (const double bound : {0.5, std::numeric_limits<double>::infinity()}) {
    std::size_t regions = 0;
    for (const double unit : {1.0, 0x1p-40}) {
      ParametricProgram program = doubleIntegrator(4);
      program.E *= unit;
      for (Signal& input : program.inputs) input.lower = -(input.upper = unit * bound);
      const MapInMemory original(encode(program, explore(program)));
      const std::size_t count = reduceAndProve(original).content.regions.size();
      EXPECT_TRUE(regions == 0 || count == regions) << count << " for " << regions;
      regions = count;
    }
    EXPECT_GT(regions, 2u);
  }
}

struct Reference {
  const char* name;
  std::size_t most_regions;
};

// Distinct laws, by PEERS' count: 5 of multirotor_N10, 15 of di_N10.
TEST(Reduce, ReferenceProblems) {
  const std::filesystem::path folder = referenceProblems();
  if (folder.empty())
    GTEST_SKIP() << "The reference problems are not here: set POLYFLY_DATA to their folder.";
  for (const Reference& reference : {Reference{"multirotor_N10", 7}, Reference{"di_N10", 23},
                                     Reference{"invpend_N5", 3}, Reference{"bemporad2002", 7}}) {
    const ParametricProgram program =
        loadProgram((folder / (std::string(reference.name) + ".json")).string());
    const MapInMemory original(encode(program, explore(program)));
    const ReduceResult result = reduceAndProve(original);
    EXPECT_LE(result.content.regions.size(), reference.most_regions) << reference.name;
    VerifyOptions options;
    options.samples = 600;
    const VerifyReport report = verify(MapInMemory(result.content).map(), program, options);
    EXPECT_TRUE(report.passed()) << reference.name << "\n" << verifyText(report);
  }
}

}  // namespace
}  // namespace polyfly
