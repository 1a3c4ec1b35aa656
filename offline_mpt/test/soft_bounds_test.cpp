// By how much soft bounds are exceeded and whether their weights are exact, against solutions at single parameters.
#include "offline_mpt/soft_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/explore.hpp"
#include "soft_problems.hpp"
#include "verify/strict_qp.hpp"

namespace polyfly {
namespace {

constexpr double kTolerance = 1e-6;
constexpr double kPrecision = 1e-10;

struct Solved {
  explicit Solved(const std::string& text)
      : program(condense(parseProblem(text, "cart.yaml"))), partition(explore(program)) {
    bounds = softBounds(program, partition, {});
    slacks = program;
    slacks.E =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(program.slacks.size()), program.variableCount());
    for (Eigen::Index i = 0; i < slacks.E.rows(); ++i)
      slacks.E(i, program.slacks[static_cast<std::size_t>(i)].variable) = 1.0;
    slacks.C = Eigen::MatrixXd::Zero(slacks.E.rows(), program.parameterCount());
    slacks.c = Eigen::VectorXd::Zero(slacks.E.rows());
    slacks.inputs.assign(program.slacks.size(), program.inputs[0]);
  }

  ParametricProgram program;
  Partition partition;
  std::vector<SoftBound> bounds;
  /// The program with its slacks as the result.
  ParametricProgram slacks;
};

Eigen::VectorXd randomParameter(const ParametricProgram& program, std::mt19937* generator) {
  Eigen::VectorXd theta(program.parameterCount());
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    const Signal& signal = program.parameters[static_cast<std::size_t>(i)];
    theta(i) = std::uniform_real_distribution<double>(signal.lower, signal.upper)(*generator);
  }
  return theta;
}

/// Greatest slack at theta; also of parameters at the edge of the box.
double excessAt(StrictQp* oracle, const Eigen::VectorXd& theta) {
  const StrictAnswer answer = oracle->solve(theta, kPrecision);
  EXPECT_EQ(answer.verdict, StrictAnswer::Verdict::kOptimal);
  return answer.u.maxCoeff();
}

TEST(SoftBounds, TheGreatestExcessIsReachedAndNeverPassed) {
  for (const char* slack : {"stage", "horizon"}) {
    const Solved solved(cartProblem(softSpeed(30.0, slack)));
    ASSERT_EQ(solved.partition.status, ExploreStatus::kComplete);
    ASSERT_EQ(solved.bounds.size(), 1u);
    const SoftBound& bound = solved.bounds[0];
    EXPECT_EQ(bound.name, "v");
    EXPECT_EQ(bound.unit, "m/s");
    StrictQp oracle(solved.slacks, Convexity::kAsGiven);
    EXPECT_NEAR(excessAt(&oracle, bound.excess.theta), bound.excess.value, kTolerance);
    std::mt19937 generator(1);
    int exceeded = 0;
    for (int i = 0; i < 300; ++i) {
      const double excess = excessAt(&oracle, randomParameter(solved.program, &generator));
      EXPECT_LE(excess, bound.excess.value + kTolerance);
      exceeded += excess > kTolerance ? 1 : 0;
    }
    EXPECT_GT(exceeded, 10);
    EXPECT_LT(exceeded, 290);
  }
}

TEST(SoftBounds, AnExactWeightExceedsTheBoundOnlyWhereItCannotHold) {
  for (const double weight : {1000.0, 5.0}) {
    const Solved solved(cartProblem(softSpeed(weight, "stage")));
    const SoftBound& bound = solved.bounds.at(0);
    const ParametricProgram hard = withHardBounds(solved.program);
    EXPECT_EQ(hard.variableCount(), 5);
    StrictQp soft_oracle(solved.slacks, Convexity::kAsGiven);
    StrictQp hard_oracle(hard, Convexity::kAsGiven);
    std::mt19937 generator(2);
    int feasible = 0, needless = 0;
    for (int i = 0; i < 400; ++i) {
      const Eigen::VectorXd theta = randomParameter(solved.program, &generator);
      if (hard_oracle.solve(theta, kPrecision).verdict != StrictAnswer::Verdict::kOptimal) continue;
      ++feasible;
      needless += excessAt(&soft_oracle, theta) > kTolerance ? 1 : 0;
    }
    EXPECT_GT(feasible, 20);
    if (weight > 100.0) {
      EXPECT_EQ(bound.exactness, SoftBound::Exactness::kExact) << softBoundText(bound);
      EXPECT_LT(bound.multiplier.value, weight);
      EXPECT_EQ(needless, 0);
    } else {
      EXPECT_EQ(bound.exactness, SoftBound::Exactness::kNotExact) << softBoundText(bound);
      EXPECT_GT(bound.multiplier.value, weight);
      EXPECT_GT(needless, 0);
    }
  }
}

TEST(SoftBounds, AWeightJustAboveTheGreatestMultiplierIsExactAndOneJustBelowIsNot) {
  const double greatest = Solved(cartProblem(softSpeed(100.0, "horizon"))).bounds.at(0).multiplier.value;
  EXPECT_GT(greatest, 1.0);
  const Solved above(cartProblem(softSpeed(greatest * 1.001, "horizon")));
  EXPECT_EQ(above.bounds.at(0).exactness, SoftBound::Exactness::kExact);
  const Solved below(cartProblem(softSpeed(greatest * 0.99, "horizon")));
  ASSERT_EQ(below.bounds.at(0).exactness, SoftBound::Exactness::kNotExact);
  // Near the witness there are parameters where hard bounds hold and the soft one is exceeded all the same.
  StrictQp soft_oracle(below.slacks, Convexity::kAsGiven);
  const ParametricProgram hard = withHardBounds(below.program);
  StrictQp hard_oracle(hard, Convexity::kAsGiven);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> nearby(-0.02, 0.02);
  int needless = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2d theta =
        below.bounds[0].multiplier.theta + Eigen::Vector2d(nearby(generator), nearby(generator));
    if (std::abs(theta(0)) > 10.0 || std::abs(theta(1)) > 4.0) continue;
    if (hard_oracle.solve(theta, kPrecision).verdict != StrictAnswer::Verdict::kOptimal) continue;
    needless += excessAt(&soft_oracle, theta) > kTolerance ? 1 : 0;
  }
  EXPECT_GT(needless, 0);
}

TEST(SoftBounds, ABoundThatIsNeverReachedHasNoExcess) {
  const Solved solved(cartProblem("  - {of: v, range: [-50, 50], soft: {linear: 1, quadratic: 1}}\n"));
  EXPECT_EQ(solved.bounds.at(0).excess.value, 0.0);
  EXPECT_EQ(solved.bounds[0].exactness, SoftBound::Exactness::kExact);
  EXPECT_NE(softBoundText(solved.bounds[0]).find("never exceeded"), std::string::npos);
}

TEST(SoftBounds, ABoundThatCanNeverHoldIsSaid) {
  const Solved solved(
      cartProblem("  - {name: impossible, of: {v: 1, p: 0.0001}, unit: m/s, lower: 40, "
                  "soft: {linear: 10, quadratic: 1}}\n"));
  const SoftBound& bound = solved.bounds.at(0);
  EXPECT_EQ(bound.exactness, SoftBound::Exactness::kNeverFeasible);
  EXPECT_GT(bound.excess.value, 35.0);
  EXPECT_NE(softBoundText(bound).find("no parameter of the box"), std::string::npos);
}

// Boxes whose edges are not sums of their middle and half of their width in doubles.
TEST(SoftBounds, TheWorstParametersLieInTheBox) {
  for (const char* box : {"[-0.7, 3.1]", "[-3.3, 0.1]", "[-2.3, 2.9]"}) {
    std::string text = cartProblem(softSpeed(2.0, "horizon"), {2, true});
    const std::string range = "unit: m/s, range: [-4, 4]";
    text.replace(text.find(range), range.size(), "unit: m/s, range: " + std::string(box));
    const Solved solved(text);
    const SoftBound& bound = solved.bounds.at(0);
    ASSERT_EQ(bound.excess.theta.size(), 2) << box;
    ASSERT_EQ(bound.multiplier.theta.size(), 2) << box;
    for (const Eigen::VectorXd& theta : {bound.excess.theta, bound.multiplier.theta}) {
      for (Eigen::Index i = 0; i < theta.size(); ++i) {
        const Signal& signal = solved.program.parameters[static_cast<std::size_t>(i)];
        EXPECT_GE(theta(i), signal.lower) << box;
        EXPECT_LE(theta(i), signal.upper) << box;
      }
    }
  }
}

TEST(SoftBounds, AQuadraticWeightAloneIsNotExactWhereTheBoundIsActive) {
  const Solved solved(cartProblem("  - {of: v, upper: 2, soft: {quadratic: 1000}}\n"));
  EXPECT_EQ(solved.bounds.at(0).exactness, SoftBound::Exactness::kNotExact);
  EXPECT_EQ(solved.bounds[0].linear_weight, 0.0);
}

TEST(SoftBounds, ThereAreNoneWithoutSlacks) {
  const Solved solved(cartProblem("  - {of: v, range: [-6, 6]}\n"));
  EXPECT_TRUE(solved.bounds.empty());
}

}  // namespace
}  // namespace polyfly
