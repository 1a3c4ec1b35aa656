// What `solve` finds out about its own answers: right maps pass, forged ones are refused.
#include "verify/self_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "made_program.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "spring_chain.hpp"

namespace polyfly {
namespace {

constexpr double kBarelyWrong = 1e-5;  // of the input's range
constexpr double kSteepLaws = 1e-9;    // how exact they must be

MapContent encoded(const ParametricProgram& program, const Partition& partition) {
  TreeOptions tree;
  tree.node_limit = 255;
  return encode(program, partition, tree);
}

/// One region that holds the box [-1, 1], u = gain theta.
MapContent oneRegion(const ParametricProgram& program, double gain) {
  Partition partition;
  partition.status = ExploreStatus::kComplete;
  CriticalRegion region;
  region.G = Eigen::MatrixXd(2, 1);
  region.G << 1.0, -1.0;
  region.g = Eigen::VectorXd::Ones(2);
  region.K = Eigen::MatrixXd::Constant(1, 1, gain);
  region.k = Eigen::VectorXd::Zero(1);
  region.centre = Eigen::VectorXd::Zero(1);
  region.radius = 1.0;
  partition.regions.push_back(region);
  return encoded(program, partition);
}

/// Two variables and their bounds; a parameter in [-1, 1]; the output is the first.
ParametricProgram twoVariables(const Eigen::Matrix2d& H, const Eigen::Vector2d& F) {
  ParametricProgram program;
  program.name = "two";
  program.text_kind = "json";
  program.H = H;
  program.f = Eigen::VectorXd::Zero(2);
  program.F = F;
  program.A.resize(4, 2);
  program.A << 1, 0, -1, 0, 0, 1, 0, -1;
  program.b = Eigen::VectorXd::Constant(4, 2.0);
  program.S = Eigen::MatrixXd::Zero(4, 1);
  program.parameters.push_back({"t", "1", -1.0, 1.0});
  program.A_theta.resize(0, 1);
  program.b_theta.resize(0);
  program.inputs.push_back({"u", "1", -2.0, 2.0});
  program.E = Eigen::MatrixXd::Identity(1, 2);
  program.C = Eigen::MatrixXd::Zero(1, 1);
  program.c = Eigen::VectorXd::Zero(1);
  return program;
}

TEST(SelfCheck, PassesRightMapsAndRefusesEachWrongLaw) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    ParametricProgram program = madeProgram(seed, {3, 8, 2});
    for (Signal& input : program.inputs) input.lower = -(input.upper = 1.0);
    const Partition partition = explore(program);
    ASSERT_EQ(partition.status, ExploreStatus::kComplete);
    MapContent content = encoded(program, partition);
    const AnswerCheck right = checkAnswers(content, program);
    EXPECT_EQ(right.fault, "") << "seed " << seed;
    EXPECT_GE(right.samples, 200u);
    EXPECT_EQ(checkAnswers(content, program, {3, nullptr, {}}).worst, right.worst);

    const std::size_t width =
        content.laws.size() / content.inputs.size() / (partition.regions.front().K.cols() + 1);
    for (std::size_t law = 0; law < width; ++law) {
      MapContent wrong = content;
      wrong.laws[(law + 1) * content.inputs.size() * 3 - 1] += 2.0 * kBarelyWrong;
      const std::string fault = checkAnswers(wrong, program).fault;
      EXPECT_NE(fault.find("region "), std::string::npos)
          << "seed " << seed << " law " << law << ": " << fault;
      EXPECT_NE(fault.find("theta = ("), std::string::npos) << fault;
    }
  }
}

TEST(SelfCheck, FindsThatACompleteMapIsSilent) {
  const ParametricProgram program = madeProgram(2, {3, 8, 2});
  Partition partition = explore(program);
  ASSERT_GT(partition.regions.size(), 3u);
  partition.regions.erase(partition.regions.begin() + 1);
  const AnswerCheck check = checkAnswers(encoded(program, partition), program);
  EXPECT_NE(check.fault.find("no region holds theta = ("), std::string::npos) << check.fault;
  partition.status = ExploreStatus::kLimited;
  EXPECT_EQ(checkAnswers(encoded(program, partition), program).fault, "");
}

// x+ = x + u over two steps with unit weights and the terminal weight 1e12: u = -2/3 x. The law -x/2 leaves 5e-13 of the
// greatest number.
TEST(SelfCheck, SeesASmallResidualThatChangesTheInput) {
  Eigen::Matrix2d H;
  H << 1e12 + 2, 1e12, 1e12, 1e12 + 1;
  const ParametricProgram program = twoVariables(H, {1e12 + 1, 1e12});
  EXPECT_EQ(checkAnswers(oneRegion(program, -(2e12 + 1) / (3e12 + 2)), program).fault, "");
  EXPECT_NE(checkAnswers(oneRegion(program, -0.5), program).fault, "");
  EXPECT_NE(checkAnswers(oneRegion(program, -2.0 / 3.0 - kBarelyWrong), program).fault, "");
}

// Of z_1 + z_2 = theta each split costs the same: any u is right between the bounds, and none beyond.
TEST(SelfCheck, AcceptsEachOptimumOfALinearProgram) {
  ParametricProgram program = twoVariables(Eigen::Matrix2d::Zero(), Eigen::Vector2d::Zero());
  program.f << 1.0, 1.0;
  program.A.conservativeResize(5, 2);
  program.A.row(4) << -1.0, -1.0;
  program.b.conservativeResize(5);
  program.b[4] = 0.0;
  program.S = Eigen::MatrixXd::Zero(5, 1);
  program.S(4, 0) = -1.0;
  EXPECT_EQ(checkAnswers(oneRegion(program, 0.5), program).fault, "");
  EXPECT_EQ(checkAnswers(oneRegion(program, 1.5), program).fault, "");
  EXPECT_NE(checkAnswers(oneRegion(program, 3.5), program).fault, "");
}

// Slopes reach 2.6e5 where u stays within 0.5: an error that is small beside the slopes is not small beside u.
TEST(SelfCheck, LawsOfASpringChainAreExactWhereTheyAreSteep) {
  const ParametricProgram program = springChain(3, 5);
  const Partition partition = explore(program);
  ASSERT_EQ(partition.status, ExploreStatus::kComplete);
  const AnswerCheck check = checkAnswers(encoded(program, partition), program);
  EXPECT_EQ(check.fault, "");
  EXPECT_LT(check.worst, kSteepLaws);
}

}  // namespace
}  // namespace polyfly
