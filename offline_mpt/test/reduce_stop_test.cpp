// Reductions and their proofs, stopped in each phase.
#include <gtest/gtest.h>

#include <atomic>
#include <string>

#include "error_of.hpp"
#include "grid_map.hpp"
#include "holds.hpp"
#include "map_in_memory.hpp"
#include "offline_mpt/reduce.hpp"
#include "offline_mpt/reduce_proven.hpp"
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

TEST(Reduce, StopsWhileItJoinsAndWhileTreesGrow) {
  const MapInMemory original(gridMap(4, 3, cellsOf({"UUbL", "UbcL", "bcLL"})));
  for (const TreeMode tree : {TreeMode::kAuto, TreeMode::kSmall}) {
    std::atomic<bool> stop{false};
    ReduceOptions options;
    options.tree = tree;
    options.stop = &stop;
    const auto error = [&] { return errorOf([&] { reduce(original.map(), options); }); };
    EXPECT_EQ(error(), "no error");
    for (auto* const phase : {&options.progress, &options.tree_progress}) {
      stop = false;
      *phase = [&](std::uint64_t, std::uint64_t) { stop = true; };
      EXPECT_TRUE(holds(error(), "reduce: interrupted"));
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
