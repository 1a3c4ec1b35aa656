// Equalities that follow from others up to rounding: the doubles, taken exactly, fix more of z or contradict
// each other.
#include <sstream>

#include "mutation.hpp"

namespace polyfly {
namespace {

TEST(RedundantEqualities, AreDroppedAndProvenToHold) {
  std::size_t dropped = 0;
  for (const bool whole : {true, false}) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
      const CertifyReport report = proven(redundantEqualities(seed, whole));
      EXPECT_LT(report.law_error, 1e-10);
      dropped += report.dropped_equalities.size();
    }
  }
  EXPECT_GT(dropped, 12u);
}

TEST(RedundantEqualities, WithoutRoundingNoneIsDropped) {
  ParametricProgram program = redundantEqualities(1, true);
  program.b.head(4) << 0.25, 0.5, 1.25, 0.75;
  EXPECT_TRUE(proven(program).dropped_equalities.empty());
}

TEST(RedundantEqualities, WhatDiffersByMoreThanRoundingIsNotDropped) {
  const ParametricProgram program = redundantEqualities(2, true);
  const MapContent content = solved(program);
  ParametricProgram other = program;
  other.b(3) += 1e-9;
  EXPECT_FALSE(certified(content, other).passed());
  other = program;
  other.S(3, 1) += 1e-9;
  EXPECT_FALSE(certified(content, other).passed());
}

TEST(RedundantEqualities, RepairKeepsThem) {
  const ParametricProgram program = redundantEqualities(3, true);
  const Partition whole = explore(program);
  Partition one = whole;
  one.regions.resize(1);
  const RepairResult result = repair(MapInMemory(encode(program, one)).map(), program);
  EXPECT_TRUE(result.report.passed()) << certifyText(result.report);
  EXPECT_EQ(result.partition.regions.size(), whole.regions.size());
}

class DroppedEquality : public Mutation {
 protected:
  DroppedEquality() : Mutation(once([] { return redundantEqualities(2, true); })) {}

  /// Adds to b of the last equality, in certificate and map's problem alike.
  Change shiftingLastBound(double by) const {
    return [by](Words& words) {
      constexpr std::size_t kFirst = 3;  // b, rows, columns
      std::string& bound = words[kFirst + 3];
      std::ostringstream text;
      text << std::hexfloat << std::stod(bound) + by;
      bound = text.str();
      return true;
    };
  }
};

TEST_F(DroppedEquality, MustHoldWithinItsTolerance) {
  const double size = program_.A.row(3).cwiseAbs().maxCoeff();
  for (const double sign : {1.0, -1.0}) expectRefused("b", shiftingLastBound(sign * 0x1p-39 * size));
}

TEST_F(DroppedEquality, MustBeNamed) { expectRefused("dropped", replacing({"dropped", "0"})); }

TEST_F(DroppedEquality, IsNoneOfTheBasis) {
  const auto addTheFirst = [](Words& words) {
    words[1] = std::to_string(std::stoul(words[1]) + 1);
    words.emplace_back("0");
    return true;
  };
  expectRefused("dropped", addTheFirst);
  expectRefused("basis", replacing({"basis", "1", "0"}));
}

}  // namespace
}  // namespace polyfly
