// Regions that meet nothing but sets flatter than any that a map keeps: those behind are found all the same.
#include <gtest/gtest.h>

#include <cmath>

#include "made_program.hpp"
#include "random.hpp"
#include "random_program.hpp"
#include "solved_map.hpp"

namespace polyfly {
namespace {

/// min |z - (1 + tilt, theta)|^2 with z_0 <= 1 and z_0 + tilt z_1 <= 1: the first row is active below 0, the
/// second above tilt^2, both between.
ParametricProgram hinge(double tilt) {
  ParametricProgram program = madeProgram(1, {2, 2, 1});
  program.H = Eigen::Matrix2d::Identity();
  program.f = -Eigen::Vector2d(1.0 + tilt, 0.0);
  program.F = -Eigen::Vector2d(0.0, 1.0);
  program.A << 1.0, 0.0, 1.0, tilt;
  program.b.setOnes();
  program.S.setZero();
  return program;
}

TEST(FlatSets, LeadToTheRegionBehind) {
  for (const double tilt : {1e-3, 1e-4, 1e-5, 8e-6, 4e-6, 2e-6, 1e-6, 3e-7}) {
    const ParametricProgram program = hinge(tilt);
    const Partition partition = explore(program);
    EXPECT_EQ(partition.status, ExploreStatus::kComplete) << tilt;
    for (const double theta : {-0.9, -1e-6, 1e-6, 0.5})
      EXPECT_FALSE(holders(partition, Eigen::VectorXd::Constant(1, theta), 1e-8).empty()) << tilt;
    const CertifyReport report = certified(partition, program);
    EXPECT_TRUE(report.passed()) << tilt << "\n" << certifyText(report);
  }
}

/// Some rows are others, or sums of others, but for `distance`.
ParametricProgram nearlyRepeated(std::uint64_t seed) {
  Random random(seed);
  const int n = 2 + random.below(3), p = 1 + random.below(2), m = n + 4 + random.below(4);
  ParametricProgram program = madeProgram(seed, {n, m, p});
  for (int i = m - 2; i < m; ++i) {
    const double distance = std::pow(10.0, random.uniform(-7.0, -4.0));
    const int first = random.below(m - 2), second = random.below(m - 2);
    const double weight = random.below(2) == 0 ? 0.0 : random.uniform(0.3, 1.0);
    program.A.row(i) = program.A.row(first) + weight * program.A.row(second) + distance * random.matrix(1, n);
    program.b(i) = program.b(first) + weight * program.b(second) + distance * random.uniform(-1.0, 1.0);
    program.S.row(i) = program.S.row(first) + weight * program.S.row(second) + distance * random.matrix(1, p);
  }
  return program;
}

TEST(FlatSets, NearlyRepeatedRowsLoseNothing) {
  constexpr std::uint64_t kPrograms = 100;
  for (std::uint64_t seed = 1; seed <= kPrograms; ++seed) {
    const ParametricProgram program = nearlyRepeated(seed);
    const Partition partition = explore(program);
    ASSERT_EQ(partition.status, ExploreStatus::kComplete) << seed;
    const CertifyReport report = certified(partition, program);
    EXPECT_TRUE(report.passed()) << seed << "\n" << certifyText(report);
  }
}

/// The same without curvature, and bounds on z.
ParametricProgram nearlyRepeatedLinear(std::uint64_t seed) {
  ParametricProgram program = nearlyRepeated(seed);
  Random random(seed);
  program.H.setZero();
  program.f = random.matrix(program.variableCount(), 1);
  if (seed % 2 == 0) program.F.setZero();
  const int n = program.variableCount();
  for (int i = 0; i < n; ++i) {
    for (const double sign : {-1.0, 1.0})
      appendRow(program, sign * Eigen::VectorXd::Unit(n, i), 2.0,
                Eigen::VectorXd::Zero(program.parameterCount()));
  }
  return program;
}

// What such programs are called complete for is proven; where too much meets for doubles, they are called
// incomplete, with a witness in the box.
TEST(FlatSets, NearlyRepeatedRowsOfLinearProgramsLoseNothingInSilence) {
  constexpr std::uint64_t kPrograms = 100;
  std::uint64_t complete = 0;
  for (std::uint64_t seed = 1; seed <= kPrograms; ++seed) {
    const ParametricProgram program = nearlyRepeatedLinear(seed);
    const Partition partition = explore(program);
    if (partition.status != ExploreStatus::kComplete) {
      EXPECT_EQ(partition.status, ExploreStatus::kIncomplete) << seed;
      EXPECT_LE(partition.witness.cwiseAbs().maxCoeff(), 1.0) << seed;
      continue;
    }
    ++complete;
    const CertifyReport report = certified(partition, program);
    EXPECT_TRUE(report.passed()) << seed << "\n" << certifyText(report);
  }
  EXPECT_GT(complete, kPrograms * 9 / 10);
}

}  // namespace
}  // namespace polyfly
