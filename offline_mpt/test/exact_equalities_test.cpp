// Equalities that follow from others up to rounding: the doubles, taken exactly, fix more of z or contradict
// each other.
#include <algorithm>
#include <sstream>

#include "map_in_memory.hpp"
#include "mutation.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"

namespace polyfly {
namespace {

CertifyReport certified(const ParametricProgram& program) {
  return certify(MapInMemory(encode(program, explore(program))).map(), program);
}

TEST(RedundantEqualities, AreDroppedAndProvenToHold) {
  std::size_t dropped = 0;
  for (const bool whole : {true, false}) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
      const ParametricProgram program = redundantEqualities(seed, whole);
      const MapContent content = encode(program, explore(program));
      const CertifyReport report = certify(MapInMemory(content).map(), program);
      ASSERT_TRUE(report.passed()) << whole << " " << seed << "\n" << certifyText(report);
      EXPECT_EQ(refusal(report.certificate, bytesOf(content)), "");
      EXPECT_LT(report.law_error, 1e-10);
      dropped += report.dropped_equalities.size();
    }
  }
  EXPECT_GT(dropped, 12u);
}

TEST(RedundantEqualities, WithoutRoundingNoneIsDropped) {
  ParametricProgram program = redundantEqualities(1, true);
  program.b.head(4) << 0.25, 0.5, 1.25, 0.75;
  const CertifyReport report = certified(program);
  EXPECT_TRUE(report.passed()) << certifyText(report);
  EXPECT_TRUE(report.dropped_equalities.empty());
}

TEST(RedundantEqualities, WhatDiffersByMoreThanRoundingIsNotDropped) {
  const ParametricProgram program = redundantEqualities(2, true);
  const MapContent content = encode(program, explore(program));
  ParametricProgram other = program;
  other.b(3) += 1e-9;
  EXPECT_FALSE(certify(MapInMemory(content).map(), other).passed());
  other = program;
  other.S(3, 1) += 1e-9;
  EXPECT_FALSE(certify(MapInMemory(content).map(), other).passed());
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
  DroppedEquality() : Mutation(redundantEqualities(2, true)) {}

  /// Adds to b of the last equality, in certificate and map's problem alike.
  Change shiftingLastBound(double by) const {
    return [by](std::vector<std::string>& words) {
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
  int tried = 0;
  const double size = program_.A.row(3).cwiseAbs().maxCoeff();
  for (const double sign : {1.0, -1.0})
    EXPECT_NE(refusalOfLines("b ", shiftingLastBound(sign * 0x1p-39 * size), tried), "");
  EXPECT_EQ(tried, 1);
}

TEST_F(DroppedEquality, MustBeNamed) {
  int tried = 0;
  EXPECT_NE(refusalOfLines("dropped ", replacing({"dropped", "0"}), tried), "");
  EXPECT_EQ(tried, 1);
}

TEST_F(DroppedEquality, IsNoneOfTheBasis) {
  int tried = 0;
  EXPECT_NE(refusalOfLines(
                "dropped ",
                [](std::vector<std::string>& words) {
                  words[1] = std::to_string(std::stoul(words[1]) + 1);
                  words.emplace_back("0");
                  return true;
                },
                tried),
            "");
  EXPECT_NE(refusalOfLines("basis ", replacing({"basis", "1", "0"}), tried), "");
  EXPECT_EQ(tried, 1);
}

}  // namespace
}  // namespace polyfly
