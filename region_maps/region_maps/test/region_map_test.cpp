#include "region_maps/region_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <utility>

#include "error_of.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/format.hpp"
#include "region_maps/write_map.hpp"
#include "scratch_folder.hpp"
#include "synthetic_map.hpp"

namespace polyfly {
namespace {

void expectSame(const std::vector<Signal>& found, const std::vector<Signal>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].name, expected[i].name);
    EXPECT_EQ(found[i].unit, expected[i].unit);
    EXPECT_EQ(found[i].lower, expected[i].lower);
    EXPECT_EQ(found[i].upper, expected[i].upper);
  }
}

void expectSame(const RegionMap& map, const MapContent& content) {
  EXPECT_EQ(map.name(), content.name);
  EXPECT_EQ(map.problemText(), content.problem_text);
  EXPECT_EQ(map.problemKind(), content.problem_kind);
  EXPECT_EQ(map.solverStatus(), content.solver_status);
  EXPECT_EQ(map.solverNotes(), content.solver_notes);
  EXPECT_EQ(map.period(), content.period);
  EXPECT_EQ(map.tolerance(), content.tolerance);
  expectSame(map.parameters(), content.parameters);
  expectSame(map.inputs(), content.inputs);
  const std::size_t plane = content.parameters.size() + 1;
  const std::size_t law = plane * content.inputs.size();
  ASSERT_EQ(map.planeCount() * plane, content.planes.size());
  ASSERT_EQ(map.lawCount() * law, content.laws.size());
  ASSERT_EQ(map.regionCount(), content.regions.size());
  EXPECT_EQ(map.nodeCount(), content.nodes.size());
  EXPECT_EQ(map.leafCount(), content.leaves.size());
  for (std::size_t i = 0; i < map.planeCount(); ++i) {
    EXPECT_TRUE(std::equal(map.plane(i), map.plane(i) + plane,
                           content.planes.begin() + static_cast<std::ptrdiff_t>(i * plane)));
  }
  for (std::size_t i = 0; i < map.lawCount(); ++i) {
    EXPECT_TRUE(std::equal(map.law(i), map.law(i) + law,
                           content.laws.begin() + static_cast<std::ptrdiff_t>(i * law)));
  }
  for (std::size_t i = 0; i < map.regionCount(); ++i) {
    const RegionView found = map.region(i);
    const MapContent::Region& expected = content.regions[i];
    ASSERT_EQ(found.row_count, expected.row_count);
    ASSERT_EQ(found.active_count, expected.active_count);
    EXPECT_EQ(found.law, expected.law);
    EXPECT_TRUE(
        std::equal(found.rows, found.rows + found.row_count, content.rows.begin() + expected.first_row));
    EXPECT_TRUE(std::equal(found.active, found.active + found.active_count,
                           content.active.begin() + expected.first_active));
  }
}

/// The cost by walking all paths, as FORMAT.md defines it.
LookupCost walkedCost(const MapContent& map) {
  LookupCost cost;
  std::uint64_t both = 0;
  const std::function<void(std::uint32_t, std::uint32_t)> walk = [&](std::uint32_t child,
                                                                     std::uint32_t depth) {
    if ((child & MapContent::kLeaf) == 0) {
      walk(map.nodes[child].below, depth + 1);
      walk(map.nodes[child].above, depth + 1);
      return;
    }
    const MapContent::Leaf& leaf = map.leaves[child & ~MapContent::kLeaf];
    std::uint32_t rows = 0;
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
      const std::uint32_t all = map.regions[map.candidates[i]].row_count;
      for (std::uint32_t row = 0; row < all; ++row)
        rows += map.tests.empty() || (map.tests[i] >> std::min(row, 31u) & 1u) != 0 ? 1 : 0;
    }
    cost.depth = std::max(cost.depth, depth);
    cost.region_checks = std::max(cost.region_checks, rows);
    both = std::max<std::uint64_t>(both, depth + rows);
  };
  walk(map.root, 0);
  cost.multiply_adds = (both + map.inputs.size()) * map.parameters.size();
  return cost;
}

TEST(RegionMap, GivesBackAllThatWasWritten) {
  const ScratchFolder folder;
  for (std::uint32_t p = 1; p <= 10; ++p) {
    TreeRecipe recipe;
    recipe.parameters = p;
    recipe.inputs = 1 + p % 3;
    recipe.leaf_regions = 1 + p % 4;
    recipe.holes_one_in = p % 2 == 0 ? 5 : 0;
    recipe.seed = p;
    const MapContent content = makeTreeMap(recipe);
    const std::string path = folder.file("tree.map");
    writeMap(content, path);
    const RegionMap map = RegionMap::open(path);
    EXPECT_EQ(map.path(), path);
    EXPECT_EQ(map.bytes(), readBytes(path).size());
    expectSame(map, content);
  }
}

TEST(RegionMap, GivesBackTextWithManyLinesAndAnyCharacter) {
  MapContent content = makeSmallMap();
  content.inputs[0].name = "\xc3\xa4";                                // two bytes
  content.inputs[0].unit = "\xe2\x82\xac \xe0\xa4\x85 \xed\x95\x9c";  // three each
  content.solver_notes += "\xf0\x9f\x9a\x81 \xf4\x8f\xbf\xbf\t\n";    // four each
  AlignedBytes copy(layOut(content));
  const RegionMap map = RegionMap::view(copy.data(), copy.size(), "small");
  EXPECT_EQ(map.path(), "small");
  expectSame(map, content);
}

TEST(RegionMap, GivesBackEmptyTextAndInfiniteInputBounds) {
  MapContent content = makeSmallMap();
  content.name = content.problem_text = content.problem_kind = content.solver_status = content.solver_notes =
      "";
  content.inputs[0].unit = "";
  content.inputs[0].lower = -std::numeric_limits<double>::infinity();
  content.inputs[0].upper = std::numeric_limits<double>::infinity();
  AlignedBytes bytes(layOut(content));
  expectSame(RegionMap::view(bytes.data(), bytes.size(), "bare"), content);
}

TEST(RegionMap, OneRegionNeedsNoNode) {
  TreeRecipe recipe;
  recipe.regions = 1;
  const MapContent content = makeTreeMap(recipe);
  ASSERT_TRUE(content.nodes.empty());
  AlignedBytes bytes(layOut(content));
  const RegionMap map = RegionMap::view(bytes.data(), bytes.size(), "one");
  expectSame(map, content);
  EXPECT_EQ(map.cost().depth, 0u);
}

TEST(RegionMap, BoundsTheCostOfALookUp) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    TreeRecipe recipe;
    recipe.seed = seed;
    recipe.regions = static_cast<std::uint32_t>(1 + 13 * seed);
    recipe.leaf_regions = static_cast<std::uint32_t>(1 + seed % 5);
    recipe.names_tests = seed % 2 == 0;
    const MapContent content = makeTreeMap(recipe);
    AlignedBytes bytes(layOut(content));
    const LookupCost found = RegionMap::view(bytes.data(), bytes.size(), "cost").cost();
    const LookupCost expected = walkedCost(content);
    EXPECT_EQ(found.depth, expected.depth);
    EXPECT_EQ(found.region_checks, expected.region_checks);
    EXPECT_EQ(found.multiply_adds, expected.multiply_adds);
  }
}

TEST(RegionMap, ReadsVersion1) {
  for (std::uint32_t p = 1; p <= 9; p += 4) {
    TreeRecipe recipe;
    recipe.parameters = p;
    recipe.leaf_regions = 3;
    recipe.seed = p;
    const MadeMap made(makeTreeMap(recipe));
    const std::vector<std::byte> old = layOutVersion1(made.content);
    ASSERT_EQ(old.size() + format::kAlignment, made.bytes.size());
    AlignedBytes bytes(old);
    const RegionMap map = RegionMap::view(bytes.data(), bytes.size(), "old");
    EXPECT_EQ(map.formatVersion(), 1u);
    EXPECT_EQ(made.map.formatVersion(), 2u);
    expectSame(map, made.content);
    EXPECT_EQ(map.cost().multiply_adds, made.map.cost().multiply_adds);
    EXPECT_EQ(map.leaf(0).tests, nullptr);
    std::mt19937_64 random(p);
    for (int i = 0; i < 500; ++i) {
      const std::vector<double> theta = randomPoint(made.content, random, 1.05);
      EXPECT_EQ(map.locate(theta.data()).status, made.map.locate(theta.data()).status);
      EXPECT_EQ(map.locate(theta.data()).region, made.map.locate(theta.data()).region);
    }
  }
}

TEST(RegionMap, LeavesMayBeShared) {
  MapContent content = makeSmallMap();
  content.nodes[1].above = content.nodes[1].below;
  AlignedBytes bytes(layOut(content));
  EXPECT_EQ(RegionMap::view(bytes.data(), bytes.size(), "shared").cost().depth, 2u);
}

TEST(RegionMap, StaysValidWhenItMoves) {
  const ScratchFolder folder;
  const std::string path = folder.file("moved.map");
  writeMap(makeGridMap(3, 4), path);
  std::vector<RegionMap> maps;
  maps.push_back(RegionMap::open(path));
  maps.push_back(RegionMap::open(path));
  RegionMap other = std::move(maps[0]);
  maps.clear();
  maps.shrink_to_fit();
  other = RegionMap::open(path);
  const double theta[] = {0.5, 1.5, 2.5};
  double u = -1.0;
  EXPECT_EQ(other.evaluate(theta, &u).status, LookupStatus::kInside);
  EXPECT_EQ(u, 0 + 4 * (1 + 4 * 2));
}

TEST(RegionMap, OutlivesTheNameOfItsFile) {
  const ScratchFolder folder;
  const std::string path = folder.file("replaced.map");
  writeMap(makeGridMap(2, 3), path);
  const RegionMap map = RegionMap::open(path);
  writeMap(makeSmallMap(), path);
  const double theta[] = {2.5, 2.5};
  double u = -1.0;
  map.evaluate(theta, &u);
  EXPECT_EQ(u, 8.0);
  EXPECT_EQ(RegionMap::open(path).name(), "small");
}

// `cp other.map in_force.map`, `truncate` and `: > file` while a map is loaded.
TEST(RegionMap, KeepsItsAnswersWhereTheFileIsOverwrittenInPlace) {
  const ScratchFolder folder;
  MapContent content = makeGridMap(2, 3);
  const std::string path = folder.save("changed.map", layOut(content));
  const RegionMap map = RegionMap::open(path);
  const std::string before(map.file());
  const auto fly = [&] {
    std::vector<double> inputs;
    std::mt19937_64 random(7);
    for (int i = 0; i < 200; ++i) {
      double u = -1.0;
      map.evaluate(randomPoint(content, random, 1.1).data(), &u);
      inputs.push_back(u);
    }
    return inputs;
  };
  const std::vector<double> expected = fly();
  MapContent other = content;
  for (double& number : other.laws) number += 1.0;
  const auto overwrite = [&](const std::vector<std::byte>& bytes) {
    // Opened for reading too, so that the file is neither replaced nor cut off first.
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  };
  overwrite(layOut(other));
  EXPECT_EQ(fly(), expected) << "another map of the same size";
  overwrite(std::vector<std::byte>(before.size(), std::byte{0xff}));
  EXPECT_EQ(fly(), expected) << "garbage";
  for (const std::size_t size : {before.size() / 2, std::size_t{0}}) {
    std::filesystem::resize_file(path, size);
    EXPECT_EQ(fly(), expected) << "cut off at " << size;
    EXPECT_TRUE(map.file() == before);
  }
}

TEST(RegionMap, RefusesMemoryThatIsNotAligned) {
  const std::vector<std::byte> bytes = layOut(makeSmallMap());
  std::vector<std::byte> shifted(bytes.size() + 8);
  std::memcpy(shifted.data() + 8, bytes.data(), bytes.size());
  AlignedBytes copy(shifted);
  EXPECT_EQ(errorOf([&] { RegionMap::view(copy.data() + 8, bytes.size(), "shifted"); }),
            "shifted: must be aligned to 64 bytes in memory");
}

}  // namespace
}  // namespace polyfly
