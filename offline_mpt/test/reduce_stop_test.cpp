// Reductions and their proofs, stopped in each phase.
#include <gtest/gtest.h>

#include <atomic>
#include <string>

#include "grid_map.hpp"
#include "map_in_memory.hpp"
#include "offline_mpt/reduce.hpp"
#include "offline_mpt/reduce_proven.hpp"
#include "polyfly_base/error.hpp"
#include "reduce/cell_geometry.hpp"

namespace polyfly {
namespace {

TEST(ReduceProven, SaysThatAProofWasInterrupted) {
  const MapInMemory original(gridMap(4, 3, cellsOf({"UUbL", "UbcL", "bcLL"})));
  const std::atomic<bool> stop{true};
  ReductionOptions proof;
  proof.stop = &stop;
  const ProvenReduction stopped = reduceProven(original.map(), "small", {}, proof);
  EXPECT_TRUE(stopped.report.interrupted);
  EXPECT_FALSE(stopped.report.passed());
}

/// What the error says; nothing where none was thrown.
std::string errorOf(const RegionMap& map, const ReduceOptions& options) {
  try {
    reduce(map, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Reduce, StopsWhileItJoinsAndWhileTreesGrow) {
  const MapInMemory original(gridMap(4, 3, cellsOf({"UUbL", "UbcL", "bcLL"})));
  for (const TreeMode tree : {TreeMode::kAuto, TreeMode::kSmall}) {
    std::atomic<bool> stop{false};
    ReduceOptions options;
    options.tree = tree;
    options.stop = &stop;
    EXPECT_EQ(errorOf(original.map(), options), "");
    for (auto* const phase : {&options.progress, &options.tree_progress}) {
      stop = false;
      *phase = [&](std::uint64_t, std::uint64_t) { stop = true; };
      EXPECT_NE(errorOf(original.map(), options).find("reduce: interrupted"), std::string::npos);
      *phase = {};
    }
  }
}

// The same where leaves are joined and shortened after the tree has grown.
TEST(Reduce, NoQuestionIsAnsweredAfterAStop) {
  const ScaledPlanes planes{2, {1.0, 0.0, 0.5}};
  std::atomic<bool> stop{false};
  CellGeometry geometry(planes, &stop);
  ConvexCell cell;
  cell.rows = {1};
  geometry.describe(cell);
  EXPECT_FALSE(geometry.holdsOn(-1, cell, 0.0));
  stop = true;
  const double direction[] = {1.0, 0.0};
  double point[2];
  EXPECT_THROW(geometry.describe(cell), ReductionStopped);
  EXPECT_THROW(geometry.support(cell, direction, point), ReductionStopped);
  EXPECT_THROW(geometry.covered(cell, {&cell.rows}, 0.0), ReductionStopped);
}

}  // namespace
}  // namespace polyfly
