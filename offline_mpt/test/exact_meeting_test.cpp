// Where many regions meet, some have facets in common that no map lists: what lies behind them is found all
// the same. Where a region and a plane of the tree meet at a side of the box, a row may rest on that side.
#include <cmath>

#include "certify/lookup/dropped_rows.hpp"
#include "mutation.hpp"
#include "norm_cost_programs.hpp"

namespace polyfly {
namespace {

TEST(MeetingRegions, HalfSpacesThatBothSidesLeaveOutAreClosed) {
  std::uint64_t left_out = 0;
  for (const double distance : {1e-9, 4e-9}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE(testing::Message() << distance << " " << seed);
      left_out += proven(nearlyMeeting(3, 3, distance, seed)).left_out_rows;
    }
  }
  EXPECT_GT(left_out, 0u);
}

// A half-space that was left out rested on others that were left out after it.
TEST(MeetingRegions, HalfSpacesThatAreLeftOutDoNotRestOnEachOther) { proven(nearlyMeeting(6, 3, 1e-9, 4)); }

/// Whether the centre of a region lies inside of another one, too.
bool haveOverlap(const Partition& partition) {
  for (const CriticalRegion& one : partition.regions) {
    for (const CriticalRegion& other : partition.regions) {
      if (&one != &other && (other.G * one.centre - other.g).maxCoeff() < -1e-3) return true;
    }
  }
  return false;
}

// Of an optimum with more tight rows than variables, several active sets are right. Their regions overlap, and no facet of the
// one need be a facet of the other.
TEST(MeetingRegions, RegionsOfOneLawMayOverlap) {
  for (const int horizon : {1, 2, 3}) {
    SCOPED_TRACE(horizon);
    proven(normControl(horizon));
  }
  const ParametricProgram program = normCostMpc(integrators(2, 1.0), CostNorm::kOne, 4);
  EXPECT_TRUE(haveOverlap(explore(program)));
  proven(program);
}

TEST(MeetingRegions, AMissingRegionIsAGap) {
  const ParametricProgram program = nearlyMeeting(3, 3, 4e-9, 1);
  const Partition whole = explore(program);
  int tried = 0;
  for (std::size_t r = 0; r < whole.regions.size(); r += 3) {
    if (whole.regions[r].radius < 1e-6) continue;
    Partition fewer = whole;
    fewer.regions.erase(fewer.regions.begin() + static_cast<std::ptrdiff_t>(r));
    EXPECT_FALSE(certified(fewer, program).passed()) << r;
    ++tried;
  }
  EXPECT_GT(tried, 3);
}

/// A region y <= 0.3, y >= -0.5, and a tree of one plane through (1, 0.3), on which x rises by `steep` where y rises by 1.
/// Below the plane, y <= 0.3 is not tested.
MapContent cornerMap(double steep) {
  const double length = std::hypot(1.0, steep);
  MapContent map;
  map.name = "corner";
  map.problem_kind = "json";
  map.solver_status = "complete";
  map.tolerance = 1e-8;
  map.parameters = {{"x", "1", -1.0, 1.0}, {"y", "1", -1.0, 1.0}};
  map.inputs = {{"u", "1", -1.0, 1.0}};
  map.planes = {-steep / length, 1.0 / length, (0.3 - steep) / length, 0.0, 1.0, 0.3, 0.0, 1.0, -0.5};
  map.laws = {0.0, 0.0, 0.0};
  map.rows = {2, -3};
  map.regions = {{0, 2, 0, 0, 0}};
  map.nodes = {{0, MapContent::kLeaf, MapContent::kLeaf | 1u}};
  map.leaves = {{0, 1}, {1, 1}};
  map.candidates = {0, 0};
  map.tests = {2u, 3u};
  return map;
}

// The plane and x <= 1 + 2^-26, which look-ups accept, let y exceed 0.3 by steep * 2^-26.
TEST(MeetingRegions, RowsRestOnTheWiderBoxThatLookupsAccept) {
  for (const double steep : {0.5, 2.0, 3.1, 4.0, 5.0, 5.2, 5.5, 7.0}) {
    SCOPED_TRACE(steep);
    const MapInMemory memory(cornerMap(steep));
    const RegionMap& map = memory.map();
    const WholePlanes planes(map, ExactRanges(map.parameters()));
    const RegionDrops drops = dropRows(map, planes, LookupTree(map), 0);
    const double reach = steep * std::ldexp(1.0, -26);
    if (reach > kReach * map.tolerance()) {
      EXPECT_EQ(drops.unbounded.size(), 1u);
      continue;
    }
    EXPECT_TRUE(drops.unbounded.empty());
    ASSERT_FALSE(drops.rows.empty());
    EXPECT_NEAR(drops.rows.back().constant, -reach, 1e-12);
  }
}

}  // namespace
}  // namespace polyfly
