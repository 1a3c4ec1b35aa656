// Proposals for maps of robust problems, against `offline_mpt solve` of the problem that is proposed.
#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "made_robust.hpp"
#include "region_maps/region_map.hpp"
#include "run_program.hpp"
#include "validation/map_proposal.hpp"

namespace polyfly {
namespace {

class RobustProposal : public testing::Test {
 protected:
  RegionMap solved(const std::string& name, const std::string& text) const {
    const std::string problem = scratch_.path(name + ".yaml"), map = scratch_.path(name + ".map");
    std::ofstream(problem) << text;
    const std::filesystem::path folder = scratch_.path("");
    const Outcome outcome = waitForProgram(
        startProgram({OFFLINE_MPT_PROGRAM, "solve", problem, "-o", map, "--quiet"}, folder), folder);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return RegionMap::open(map);
  }
  RegionMap madeMap() const {
    MadeRobust made;
    made.states = 2;
    made.input = "[-2, 2]";
    return solved("made", made.text());
  }
  // A sample beyond the range of the position error, 1.5 m.
  static MapUse away(const RegionMap& map) {
    MapUseCounter counter(map);
    const double theta[] = {1.9, 0.1};
    counter.add(0.0, theta);
    return counter.use();
  }

  ScratchFolder scratch_;
};

TEST_F(RobustProposal, countsTheRegionsThatSolvingFinds) {
  const RegionMap map = madeMap();
  const auto proposal = proposeMap(map, away(map), "lateral");
  ASSERT_TRUE(proposal.has_value());
  EXPECT_EQ(proposal->obstacle, "");
  ASSERT_EQ(proposal->changes.size(), 1u);
  EXPECT_EQ(proposal->changes[0].parameter, "e_p");
  EXPECT_EQ(proposal->regions, map.regionCount());
  EXPECT_TRUE(proposal->counted_all);
  const RegionMap wider = solved("wider", proposal->problem);
  EXPECT_EQ(proposal->regions_then, wider.regionCount());
  EXPECT_GE(wider.parameters()[0].upper, 1.9);
  const double theta[] = {1.9, 0.1};
  EXPECT_EQ(wider.locate(theta).status, LookupStatus::kInside);
}

TEST_F(RobustProposal, saysWhenItStoppedCounting) {
  const RegionMap map = madeMap();
  ProposalLimits limits;
  limits.seconds = 0.0;
  const auto proposal = proposeMap(map, away(map), "lateral", limits);
  ASSERT_TRUE(proposal.has_value());
  EXPECT_FALSE(proposal->counted_all);
  EXPECT_EQ(proposal->regions_then, 0u);
  EXPECT_FALSE(proposal->problem.empty());
  EXPECT_NE(proposal->obstacle.find("not counted within 0 s"), std::string::npos) << proposal->obstacle;
}

}  // namespace
}  // namespace polyfly
