// The difference of two maps against counts on a grid, and against samples.
#include "offline_mpt/diff.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "error_of.hpp"
#include "exact_programs.hpp"
#include "grid_map.hpp"
#include "offline_mpt/reduce.hpp"
#include "random_program.hpp"
#include "solved_map.hpp"

namespace polyfly {
namespace {

// Rounding of planes and gains of the grid, whose numbers are not powers of two.
constexpr double kRounding = 1e-14;

std::string jsonOf(const MapInMemory& first, const MapInMemory& second, int threads = 1) {
  DiffOptions options;
  options.threads = threads;
  return diffJson(diffMaps(first.map(), second.map(), options), {"u"});
}

double gainOf(const GridRectangle& rectangle) {
  return rectangle.law == 'U' || rectangle.law == 'L' ? 0.0 : kGainOfA * (rectangle.law - 'a' + 1);
}

double offsetOf(const GridRectangle& rectangle) {
  return rectangle.law == 'U' ? 1.0 : rectangle.law == 'L' ? -1.0 : 0.0;
}

/// What the maps of two grids have in common, counted.
struct GridDifference {
  std::uint64_t pairs = 0;
  std::uint64_t different = 0;
  double greatest = 0.0;
};

GridDifference countOnGrid(const std::vector<GridRectangle>& first,
                           const std::vector<GridRectangle>& second) {
  GridDifference result;
  for (const GridRectangle& a : first) {
    for (const GridRectangle& b : second) {
      const int x0 = std::max(a.x0, b.x0), x1 = std::min(a.x1, b.x1);
      if (x0 >= x1 || std::max(a.y0, b.y0) >= std::min(a.y1, b.y1)) continue;
      ++result.pairs;
      double size = 0.0;
      for (const int x : {x0, x1})
        size = std::max(size, std::abs((gainOf(a) - gainOf(b)) * x + offsetOf(a) - offsetOf(b)));
      result.different += a.law != b.law ? 1 : 0;
      result.greatest = std::max(result.greatest, size);
    }
  }
  return result;
}

/// Whether each unit cell of `inner` belongs to a rectangle of `outer`.
bool coversOnGrid(const std::vector<GridRectangle>& outer, const std::vector<GridRectangle>& inner) {
  return std::all_of(inner.begin(), inner.end(), [&](const GridRectangle& cell) {
    return std::any_of(outer.begin(), outer.end(), [&](const GridRectangle& other) {
      return other.x0 <= cell.x0 && cell.x1 <= other.x1 && other.y0 <= cell.y0 && cell.y1 <= other.y1;
    });
  });
}

/// Unit cells with random laws, some missing.
std::vector<GridRectangle> randomGrid(int width, int height, std::mt19937& random) {
  const std::string laws = "abcUL.";
  std::vector<GridRectangle> cells;
  for (int x = 0; x < width; ++x) {
    for (int y = 0; y < height; ++y) {
      const char law = laws[random() % laws.size()];
      if (law != '.') cells.push_back({x, x + 1, y, y + 1, law});
    }
  }
  return cells;
}

TEST(Diff, AgreesWithCountsOnRandomGrids) {
  std::mt19937 random(1);
  int covered = 0, different = 0;
  for (int k = 0; k < 60; ++k) {
    const int width = 2 + static_cast<int>(random() % 4), height = 1 + static_cast<int>(random() % 3);
    const std::vector<GridRectangle> first = randomGrid(width, height, random);
    std::vector<GridRectangle> second = randomGrid(width, height, random);
    if (k % 3 == 0) second = {{0, width, 0, height, 'b'}};
    if (first.empty() || second.empty()) continue;
    const MapInMemory one(gridMap(width, height, first)), other(gridMap(width, height, second));
    const DiffReport report = diffMaps(one.map(), other.map());
    const GridDifference expected = countOnGrid(first, second);
    EXPECT_EQ(report.pairs, expected.pairs);
    EXPECT_EQ(report.different_pairs, expected.different);
    EXPECT_EQ(report.differences.size(), expected.different);
    EXPECT_NEAR(report.greatest.at(0).size, expected.greatest, kRounding);
    EXPECT_EQ(report.second_covers_first.covers, coversOnGrid(second, first));
    if (k % 3 != 0) {
      EXPECT_EQ(report.first_covers_second.covers, coversOnGrid(first, second));
    }
    covered += report.second_covers_first.covers ? 1 : 0;
    different += report.same() ? 0 : 1;
  }
  EXPECT_GT(covered, 10);
  EXPECT_GT(different, 40);
}

TEST(Diff, TellsWhereTheGreatestDifferenceIs) {
  const MapInMemory first(gridMap(4, 2, {{0, 4, 0, 2, 'a'}}));
  const MapInMemory second(gridMap(4, 2, {{0, 3, 0, 2, 'a'}, {3, 4, 0, 1, 'c'}, {3, 4, 1, 2, 'a'}}));
  const DiffReport report = diffMaps(first.map(), second.map());
  ASSERT_EQ(report.differences.size(), 1u);
  const LawDifference& difference = report.differences.front();
  EXPECT_EQ(difference.first_region, 0u);
  EXPECT_EQ(difference.second_region, 1u);
  EXPECT_NEAR(difference.size, 2.0 * kGainOfA * 4.0, kRounding);
  EXPECT_NEAR(difference.theta(0), 4.0, kRounding);
  EXPECT_LE(difference.theta(1), 1.0 + kRounding);
  EXPECT_EQ(report.pairs, 3u);
  EXPECT_FALSE(report.same());
  EXPECT_TRUE(report.first_covers_second.covers && report.second_covers_first.covers);
  DiffOptions coarse;
  coarse.tolerance = 0.1;
  EXPECT_TRUE(diffMaps(first.map(), second.map(), coarse).same());
}

TEST(Diff, AGapHasAWitness) {
  const MapInMemory first(gridMap(4, 2, cellsOf({"aaaa", "aaaa"})));
  const MapInMemory second(gridMap(4, 2, cellsOf({"aaaa", "aa.a"})));
  const DiffReport report = diffMaps(first.map(), second.map());
  EXPECT_TRUE(report.first_covers_second.covers);
  ASSERT_FALSE(report.second_covers_first.covers);
  const Eigen::VectorXd& witness = report.second_covers_first.witness;
  EXPECT_TRUE(witness(0) > 2.0 && witness(0) < 3.0 && witness(1) > 1.0 && witness(1) < 2.0);
  EXPECT_EQ(first.map().locate(witness.data()).region, report.second_covers_first.region);
  EXPECT_EQ(second.map().locate(witness.data()).status, LookupStatus::kOutsidePartition);
  EXPECT_EQ(report.different_pairs, 0u);
  EXPECT_FALSE(report.same());
}

TEST(Diff, RangesMayDiffer) {
  const MapInMemory first(gridMap(4, 2, cellsOf({"aaaa", "aaaa"})));
  const MapInMemory second(gridMap(3, 2, {{0, 3, 0, 2, 'a'}}));
  const DiffReport report = diffMaps(first.map(), second.map());
  EXPECT_EQ(report.pairs, 6u);
  EXPECT_TRUE(report.first_covers_second.covers);
  ASSERT_FALSE(report.second_covers_first.covers);
  EXPECT_GT(report.second_covers_first.witness(0), 3.0);
  EXPECT_EQ(report.different_pairs, 0u);
}

TEST(Diff, AReducedMapIsTheSame) {
  const MapInMemory original(gridMap(8, 3, cellsOf({"UUbL....", "UbcL....", "bcLL...."})));
  MapContent content = reduce(original.map()).content;
  const MapInMemory reduced(content);
  const DiffReport report = diffMaps(original.map(), reduced.map());
  EXPECT_TRUE(report.same()) << diffText(report, {"u"});
  const std::uint32_t law = content.regions.back().law;
  content.laws[law * 3 + 2] += 0.5;
  const MapInMemory changed(content);
  EXPECT_NEAR(diffMaps(original.map(), changed.map()).greatest.at(0).size, 0.5, kRounding);
}

// Samples never exceed the greatest difference, and it is reached.
TEST(Diff, BoundsTheDifferenceOfSolvedPrograms) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    ParametricProgram program = randomProgram(3, 6, 2, seed);
    outputAllVariables(program);
    const MapInMemory first(solved(program));
    program.f(0) += 0.05;
    const MapInMemory second(solved(program));
    const DiffReport report = diffMaps(first.map(), second.map());
    EXPECT_FALSE(report.same());
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
    std::vector<double> seen(report.greatest.size(), 0.0);
    for (int k = 0; k < 20'000; ++k) {
      const double theta[] = {coordinate(random), coordinate(random)};
      std::vector<double> u(seen.size()), v(seen.size());
      if (first.map().evaluate(theta, u.data()).status != LookupStatus::kInside ||
          second.map().evaluate(theta, v.data()).status != LookupStatus::kInside)
        continue;
      for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = std::max(seen[i], std::abs(u[i] - v[i]));
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const LawDifference& greatest = report.greatest[i];
      EXPECT_LE(seen[i], greatest.size + kRounding);
      EXPECT_GT(seen[i], 0.5 * greatest.size);
      const double* const u = first.map().law(first.map().region(greatest.first_region).law) + i * 3;
      const double* const v = second.map().law(second.map().region(greatest.second_region).law) + i * 3;
      const double size =
          (u[0] - v[0]) * greatest.theta(0) + (u[1] - v[1]) * greatest.theta(1) + (u[2] - v[2]);
      EXPECT_NEAR(std::abs(size), greatest.size, kRounding);
    }
  }
}

TEST(Diff, ASolvedMapIsTheSameAsItselfWithAnotherTree) {
  const ParametricProgram program = doubleIntegrator(5);
  const Partition partition = explore(program);
  TreeOptions none;
  none.mode = TreeMode::kNone;
  const MapInMemory first(encode(program, partition)), second(encode(program, partition, none));
  const DiffReport report = diffMaps(first.map(), second.map());
  EXPECT_TRUE(report.same()) << diffText(report, {"u"});
  EXPECT_GE(report.pairs, first.map().regionCount());
}

TEST(Diff, TheReportDoesNotDependOnThreads) {
  std::mt19937 random(7);
  const MapInMemory first(gridMap(5, 3, randomGrid(5, 3, random)));
  const MapInMemory second(gridMap(5, 3, randomGrid(5, 3, random)));
  EXPECT_EQ(jsonOf(first, second, 1), jsonOf(first, second, 3));
}

TEST(Diff, RefusesMapsThatCannotBeCompared) {
  const MapContent content = gridMap(4, 2, {{0, 4, 0, 2, 'a'}});
  const MapInMemory map(content);
  const auto refusal = [&](const MapContent& changed) {
    const MapInMemory other(changed);
    return errorOf([&] { diffMaps(map.map(), other.map()); });
  };
  MapContent other = content;
  other.parameters[1].unit = "rad";
  EXPECT_NE(refusal(other).find("parameter 1 y [rad], not y [m]"), std::string::npos) << refusal(other);
  other = content;
  other.inputs[0].name = "v";
  EXPECT_NE(refusal(other).find("input 0 v [m], not u [m]"), std::string::npos) << refusal(other);
  other = content;
  // Half-spaces of x alone, because in a parameter without a range no plane has a length.
  for (std::size_t k = 5; k < 8; ++k) {
    other.planes[3 * k] = 0.5;
    other.planes[3 * k + 1] = 0.0;
    other.planes[3 * k + 2] = k == 5 ? -10.0 : 10.0;
  }
  other.parameters[1].lower = other.parameters[1].upper;
  EXPECT_NE(refusal(other).find("parameter y has no range"), std::string::npos) << refusal(other);
}

}  // namespace
}  // namespace polyfly
