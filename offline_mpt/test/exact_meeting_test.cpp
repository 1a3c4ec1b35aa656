// Where many regions meet, some have facets in common that no map lists: what lies behind them is found all
// the same.
#include "map_in_memory.hpp"
#include "mutation.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"

namespace polyfly {
namespace {

/// Proves the map and has the proof confirmed.
CertifyReport proven(const ParametricProgram& program) {
  const MapContent content = encode(program, explore(program));
  CertifyReport report = certify(MapInMemory(content).map(), program);
  EXPECT_TRUE(report.passed()) << certifyText(report);
  EXPECT_EQ(refusal(report.certificate, bytesOf(content)), "");
  return report;
}

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

TEST(MeetingRegions, AnotherDescriptionOfARegionIsCoveredByTheMap) {
  std::uint64_t others = 0;
  for (const int horizon : {1, 2, 3}) {
    SCOPED_TRACE(horizon);
    others += proven(normControl(horizon)).slivers;
  }
  EXPECT_GT(others, 0u);
}

TEST(MeetingRegions, AMissingRegionIsAGap) {
  int tried = 0;
  for (unsigned seed = 1; seed <= 1; ++seed) {
    const ParametricProgram program = nearlyMeeting(3, 3, 4e-9, seed);
    const Partition whole = explore(program);
    for (std::size_t r = 0; r < whole.regions.size(); r += 3) {
      if (whole.regions[r].radius < 1e-6) continue;
      Partition fewer = whole;
      fewer.regions.erase(fewer.regions.begin() + static_cast<std::ptrdiff_t>(r));
      EXPECT_FALSE(certify(MapInMemory(encode(program, fewer)).map(), program).passed()) << seed << " " << r;
      ++tried;
    }
  }
  EXPECT_GT(tried, 3);
}

}  // namespace
}  // namespace polyfly
