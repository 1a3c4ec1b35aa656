// The benchmark's check of samples finds what is wrong with a partition.
#include "../bench/sample_check.hpp"

#include <gtest/gtest.h>

namespace polyfly::bench {
namespace {

// min 1/2 h z^2 - (theta or 1) z  s.t.  z <= 1, z >= theta - 0.5;  theta in [-2, 2]. Feasible up to 1.5,
// where with h = 1 z = min(theta, 1), and with h = 0 and cost -z, z = 1.
ParametricProgram program(bool quadratic) {
  ParametricProgram result;
  result.name = "by_hand";
  result.H = Eigen::MatrixXd::Constant(1, 1, quadratic ? 1.0 : 0.0);
  result.f = Eigen::VectorXd::Constant(1, quadratic ? 0.0 : -1.0);
  result.F = Eigen::MatrixXd::Constant(1, 1, quadratic ? -1.0 : 0.0);
  result.A = (Eigen::MatrixXd(2, 1) << 1.0, -1.0).finished();
  result.b = (Eigen::VectorXd(2) << 1.0, 0.5).finished();
  result.S = (Eigen::MatrixXd(2, 1) << 0.0, -1.0).finished();
  result.parameters.push_back({"theta", "1", -2.0, 2.0});
  result.A_theta.resize(0, 1);
  result.b_theta.resize(0);
  result.inputs.push_back({"z", "1", -10.0, 10.0});
  result.E = Eigen::MatrixXd::Identity(1, 1);
  result.C = Eigen::MatrixXd::Zero(1, 1);
  result.c = Eigen::VectorXd::Zero(1);
  return result;
}

CriticalRegion region(double lower, double upper, double slope, double offset) {
  CriticalRegion result;
  result.G = (Eigen::MatrixXd(2, 1) << 0.5, -0.5).finished();
  result.g = (Eigen::VectorXd(2) << 0.5 * upper, -0.5 * lower).finished();
  result.K = Eigen::MatrixXd::Constant(1, 1, slope);
  result.k = Eigen::VectorXd::Constant(1, offset);
  return result;
}

nlohmann::json samples(bool quadratic) {
  nlohmann::json result = nlohmann::json::array();
  for (const double theta : {-1.5, -0.3, 0.6, 1.2, 1.4}) {
    const double z = quadratic && theta < 1.0 ? theta : 1.0;
    const double objective = quadratic ? 0.5 * z * z - theta * z : -z;
    result.push_back(
        {{"theta", {theta}}, {"feasible", true}, {"margin", 0.1}, {"u", {z}}, {"obj", objective}});
  }
  for (const double theta : {1.6, 1.9})
    result.push_back({{"theta", {theta}}, {"feasible", false}, {"margin", 1.5 - theta}});
  return result;
}

Partition partition(std::vector<CriticalRegion> regions) {
  Partition result;
  result.status = ExploreStatus::kComplete;
  result.regions = std::move(regions);
  return result;
}

TEST(SampleCheck, APartitionThatIsRightPasses) {
  const SampleCheck check = checkSamples(
      program(true), partition({region(-2.0, 1.0, 1.0, 0.0), region(1.0, 1.5, 0.0, 1.0)}), samples(true));
  EXPECT_EQ(check.feasible, 5);
  EXPECT_EQ(check.infeasible, 2);
  EXPECT_EQ(check.missed, 0);
  EXPECT_EQ(check.false_inside, 0);
  EXPECT_LT(check.u_error, 1e-12);
}

TEST(SampleCheck, ALostRegionIsMissed) {
  EXPECT_EQ(checkSamples(program(true), partition({region(-2.0, 1.0, 1.0, 0.0)}), samples(true)).missed, 2);
  EXPECT_EQ(checkSamples(program(true), partition({}), samples(true)).missed, 5);
}

TEST(SampleCheck, ARegionThatReachesTooFarHoldsInfeasibleSamples) {
  const SampleCheck check = checkSamples(
      program(true), partition({region(-2.0, 1.0, 1.0, 0.0), region(1.0, 1.7, 0.0, 1.0)}), samples(true));
  EXPECT_EQ(check.false_inside, 1);
}

TEST(SampleCheck, AWrongLawIsAnErrorEvenWhereARightOneOverlapsIt) {
  const Partition wrong =
      partition({region(-2.0, 1.0, 1.0, 0.0), region(1.0, 1.5, 0.0, 1.0), region(1.1, 1.3, 0.0, 0.7)});
  EXPECT_NEAR(checkSamples(program(true), wrong, samples(true)).u_error, 0.3 / 1.5, 1e-12);
}

TEST(SampleCheck, SamplesAtTheEdgeAndInaccurateOnesAreLeftOut) {
  nlohmann::json list = samples(true);
  list[0]["margin"] = 1e-7;
  list[1]["kkt"] = 1e-6;
  list[5]["margin"] = -1e-7;
  const SampleCheck check = checkSamples(program(true), partition({}), list);
  EXPECT_EQ(check.feasible, 3);
  EXPECT_EQ(check.infeasible, 1);
}

TEST(SampleCheck, OfALinearProgramTheNearestOptimumCounts) {
  const SampleCheck right =
      checkSamples(program(false), partition({region(-2.0, 1.5, 0.0, 1.0)}), samples(false));
  EXPECT_LT(right.u_error, 1e-6);
  const SampleCheck wrong =
      checkSamples(program(false), partition({region(-2.0, 1.5, 0.0, 0.95)}), samples(false));
  EXPECT_NEAR(wrong.u_error, 0.05, 1e-6);
}

}  // namespace
}  // namespace polyfly::bench
