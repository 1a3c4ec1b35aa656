// By how much a loop exceeds its soft bounds under a disturbance, against loops that solve each program anew.
#include "offline_mpt/loop_excess.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "offline_mpt/explore.hpp"
#include "soft_problems.hpp"
#include "verify/strict_qp.hpp"

namespace polyfly {
namespace {

constexpr double kTolerance = 1e-6;
constexpr double kPrecision = 1e-10;

/// x+ = x + u + d, that follows a reference beyond its bound of 2.
std::string integrator(const std::string& input, const std::string& disturbance,
                       const std::string& reference = "range: [0, 3]") {
  return R"(polyfly_problem: 1
name: integrator
type: tracking_mpc
model:
  time: discrete
  states: [{name: x, unit: m}]
  inputs: [{name: u, unit: m, range: )" +
         input + R"(}]
  disturbances: [{name: d, unit: m)" +
         disturbance + R"(}]
  A: [[1]]
  B: [[1]]
  B_d: [[1]]
  C: [[1]]
sampling_time: 1
horizon: 2
weights: {Q: [1], R: [0.1]}
constraints:
  - {of: x, range: [-5, 2], soft: {linear: 1000, quadratic: 1, slack: horizon}}
parameters:
  - {name: x_ref, role: state_reference, of: x, unit: m, )" +
         reference + R"(}
  - {name: e, role: error, of: x, unit: m, range: [-6, 6]}
)";
}

std::string cart(const std::string& slack) { return cartProblem(softSpeed(30.0, slack), {5, true}); }

/// A made problem with a disturbance of its second state.
std::string madeLoop(unsigned seed) {
  std::string text = madeProblem({true, seed % 2 == 0, seed % 3 == 0}, seed);
  const bool third_order = text.find("name: a,") != std::string::npos;
  const std::string effect =
      std::string("  B_d: [[0], [1]") + (third_order ? ", [0]" : "") + "]\n  disturbances:\n";
  return text.insert(text.find("  A: "), effect + "    - {name: d, unit: m/s^2, range: [-0.8, 0.6]}\n");
}

/// The loop of a problem with one input, one soft bound on a state and parameters of the roles error, state_reference,
/// input_reference and previous_input. Each step solves its program anew.
class SimulatedLoop {
 public:
  explicit SimulatedLoop(const MpcProblem& problem)
      : problem_(problem),
        model_(discretise(problem, problem.sampling_time)),
        program_(withSlacks(condense(problem))),
        oracle_(program_, Convexity::kAsGiven) {}

  /// The excess now or in the prediction; at most 0 where the bound is met.
  double excessFrom(const Eigen::VectorXd& theta) {
    const Eigen::VectorXd u = answer(theta);
    return std::max(excessOf(stateOf(theta), u(0)), u.tail(u.size() - 1).maxCoeff());
  }

  /// Excess after one step, or before it where the bound has an input. `theta` becomes the next one.
  double step(double d, Eigen::VectorXd* theta) {
    const double u = answer(*theta)(0);
    const Eigen::VectorXd error = ofRole(ParameterRole::kError, problem_.stateCount(), *theta);
    const double reference = ofRole(ParameterRole::kInputReference, 1, *theta)(0);
    const Eigen::VectorXd held = stateOf(*theta) - error;
    const bool has_input = !problem_.constraints[0].G_u.isZero(0.0);
    const Eigen::VectorXd next = model_.A * error + model_.B * (u - reference) + model_.Bd * d;
    for (std::size_t j = 0; j < problem_.parameters.size(); ++j) {
      const MpcProblem::Parameter& parameter = problem_.parameters[j];
      double& entry = (*theta)(static_cast<Eigen::Index>(j));
      if (parameter.role == ParameterRole::kError) entry = next(parameter.index);
      if (parameter.role == ParameterRole::kPreviousInput) entry = u;
    }
    return excessOf(has_input ? Eigen::VectorXd(error + held) : Eigen::VectorXd(next + held), u);
  }

  bool inBox(const Eigen::VectorXd& theta) const {
    for (std::size_t j = 0; j < problem_.parameters.size(); ++j) {
      const Signal& signal = problem_.parameters[j].signal;
      const double value = theta(static_cast<Eigen::Index>(j));
      if (value < signal.lower || value > signal.upper) return false;
    }
    return true;
  }

  Eigen::VectorXd randomParameter(std::mt19937* generator) const {
    Eigen::VectorXd theta(static_cast<Eigen::Index>(problem_.parameters.size()));
    for (Eigen::Index j = 0; j < theta.size(); ++j) {
      const Signal& signal = problem_.parameters[static_cast<std::size_t>(j)].signal;
      theta(j) = std::uniform_real_distribution<double>(signal.lower, signal.upper)(*generator);
    }
    return theta;
  }

 private:
  /// Its result is u and the slacks.
  static ParametricProgram withSlacks(ParametricProgram program) {
    const auto count = static_cast<Eigen::Index>(program.slacks.size());
    program.E.conservativeResize(1 + count, Eigen::NoChange);
    program.C.conservativeResize(1 + count, Eigen::NoChange);
    program.E.bottomRows(count).setZero();
    program.C.bottomRows(count).setZero();
    program.c = Eigen::VectorXd::Zero(1 + count);
    for (Eigen::Index i = 0; i < count; ++i)
      program.E(1 + i, program.slacks[static_cast<std::size_t>(i)].variable) = 1.0;
    program.inputs.resize(static_cast<std::size_t>(1 + count), program.inputs[0]);
    return program;
  }

  Eigen::VectorXd answer(const Eigen::VectorXd& theta) {
    const StrictAnswer answer = oracle_.solve(theta, kPrecision);
    EXPECT_EQ(answer.verdict, StrictAnswer::Verdict::kOptimal);
    return answer.u;
  }

  Eigen::VectorXd ofRole(ParameterRole role, int size, const Eigen::VectorXd& theta) const {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(size);
    for (std::size_t j = 0; j < problem_.parameters.size(); ++j)
      if (problem_.parameters[j].role == role)
        values(problem_.parameters[j].index) = theta(static_cast<Eigen::Index>(j));
    return values;
  }

  Eigen::VectorXd stateOf(const Eigen::VectorXd& theta) const {
    return ofRole(ParameterRole::kError, problem_.stateCount(), theta) +
           ofRole(ParameterRole::kStateReference, problem_.stateCount(), theta);
  }

  double excessOf(const Eigen::VectorXd& x, double u) const {
    const StageConstraint& constraint = problem_.constraints[0];
    const double value = constraint.G_x.dot(x) + constraint.G_u(0) * u;
    return std::max(value - constraint.signal.upper, constraint.signal.lower - value);
  }

  const MpcProblem& problem_;
  const DiscreteModel model_;
  const ParametricProgram program_;
  StrictQp oracle_;
};

struct Solved {
  explicit Solved(const std::string& text)
      : problem(parseProblem(text, "loop.yaml")), partition(explore(condense(problem))) {
    EXPECT_EQ(partition.status, ExploreStatus::kComplete);
    excess = loopExcess(problem, partition);
  }
  MpcProblem problem;
  Partition partition;
  std::vector<LoopExcess> excess;
};

/// Greatest excess of loops from random parameters where the bound is met, under extreme disturbances.
double greatestFlown(const MpcProblem& problem, int loops, int steps, unsigned seed) {
  SimulatedLoop loop(problem);
  std::mt19937 generator(seed);
  double greatest = 0.0;
  for (int i = 0; i < loops; ++i) {
    Eigen::VectorXd theta = loop.randomParameter(&generator);
    if (loop.excessFrom(theta) > kTolerance) continue;
    bool up = generator() % 2 == 0;
    const bool keeps = generator() % 2 == 0;
    for (int k = 0; k < steps && loop.inBox(theta); ++k) {
      if (!keeps) up = generator() % 2 == 0;
      const Signal& d = problem.disturbances[0];
      greatest = std::max(greatest, loop.step(up ? d.upper : d.lower, &theta));
    }
  }
  return greatest;
}

TEST(LoopExcess, IsTheDisturbanceWhereOneStepMendsIt) {
  const Solved solved(integrator("[-1, 1]", ", range: [-0.1, 0.3]"));
  ASSERT_EQ(solved.excess.size(), 1u);
  EXPECT_EQ(solved.excess[0].unknown, "");
  EXPECT_NEAR(solved.excess[0].excess, 0.3, kTolerance);
  EXPECT_EQ(solved.excess[0].d(0), 0.3);
}

TEST(LoopExcess, GrowsToTheEdgeOfTheMapUnderADisturbanceBeyondTheInput) {
  const Solved solved(integrator("[-0.2, 0.2]", ", range: [-0.1, 0.3]"));
  // From x = 9, where x_ref is 3 and e is 6.
  EXPECT_NEAR(solved.excess.at(0).excess, 9.0 - 0.2 + 0.3 - 2.0, kTolerance);
}

TEST(LoopExcess, IsZeroWhereTheTargetIsFarWithinTheBound) {
  const Solved solved(integrator("[-1, 1]", ", range: [-0.3, 0.3]", "value: 0"));
  EXPECT_EQ(solved.excess.at(0).excess, 0.0);
  EXPECT_EQ(solved.excess[0].theta.size(), 0);
  EXPECT_NE(loopExcessText(solved.problem, solved.excess[0]).find("never exceeded"), std::string::npos);
}

TEST(LoopExcess, NoFlownLoopPassesItAndSomeComeNear) {
  for (const char* slack : {"horizon", "stage"}) {
    const Solved solved(cart(slack));
    ASSERT_EQ(solved.excess.size(), 1u);
    const double flown = greatestFlown(solved.problem, 1500, 12, 1);
    EXPECT_LE(flown, solved.excess[0].excess + kTolerance);
    EXPECT_GE(flown, 0.7 * solved.excess[0].excess);
  }
}

TEST(LoopExcess, ABoundWithAnInputCountsWhereTheInputActs) {
  std::string text = cart("horizon");
  const std::string bound = "{of: v, range: [-2, 2.5]";
  text.replace(text.find(bound), bound.size(), "{name: mix, of: {v: 1, a: 0.4}, unit: m/s, range: [-2, 2.5]");
  const Solved solved(text);
  const LoopExcess& excess = solved.excess.at(0);
  const double flown = greatestFlown(solved.problem, 1000, 12, 2);
  EXPECT_LE(flown, excess.excess + kTolerance);
  EXPECT_GE(flown, 0.5 * excess.excess);
  SimulatedLoop loop(solved.problem);
  Eigen::VectorXd theta = excess.theta;
  EXPECT_NEAR(loop.step(excess.d(0), &theta), excess.excess, kTolerance);
}

TEST(LoopExcess, IsTheSameWhereStatesAreParametersInsteadOfErrors) {
  std::string text = cart("horizon");
  for (const char* word : {"role: error", "role: error"})
    text.replace(text.find(word), std::string(word).size(), "role: state");
  EXPECT_NEAR(Solved(text).excess.at(0).excess, Solved(cart("horizon")).excess.at(0).excess, kTolerance);
}

TEST(LoopExcess, NoLoopOfAMadeProblemPassesIt) {
  int exceeded = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Solved solved(madeLoop(seed));
    ASSERT_EQ(solved.excess.size(), 1u);
    ASSERT_EQ(solved.excess[0].unknown, "");
    const double flown = greatestFlown(solved.problem, 100, 10, seed);
    EXPECT_LE(flown, solved.excess[0].excess + kTolerance) << seed;
    exceeded += flown > 0.01 ? 1 : 0;
  }
  EXPECT_GE(exceeded, 4);
}

TEST(LoopExcess, OneStepFromTheWitnessReachesIt) {
  for (const std::string& text : {cart("horizon"), cart("stage"), madeLoop(1), madeLoop(2)}) {
    const Solved solved(text);
    const LoopExcess& excess = solved.excess.at(0);
    ASSERT_GT(excess.excess, 0.0);
    SimulatedLoop loop(solved.problem);
    Eigen::VectorXd theta = excess.theta;
    EXPECT_NEAR(loop.step(excess.d(0), &theta), excess.excess, kTolerance);
  }
}

TEST(LoopExcess, GrowsWithTheDisturbance) {
  const double small = Solved(integrator("[-1, 1]", ", range: [-0.1, 0.1]")).excess.at(0).excess;
  const double large = Solved(integrator("[-1, 1]", ", range: [-0.5, 0.5]")).excess.at(0).excess;
  EXPECT_NEAR(small, 0.1, kTolerance);
  EXPECT_NEAR(large, 0.5, kTolerance);
}

TEST(LoopExcess, NeedsARange) { EXPECT_TRUE(Solved(integrator("[-1, 1]", "")).excess.empty()); }

TEST(LoopExcess, SaysWhichFixedParameterTheLoopWouldChange) {
  std::string text = cart("horizon");
  const std::string range = "unit: m/s, range: [-4, 4]";
  text.replace(text.find(range), range.size(), "unit: m/s, value: 2.4");
  const Solved solved(text);
  EXPECT_NE(solved.excess.at(0).unknown.find("e_v"), std::string::npos);
  EXPECT_NE(loopExcessText(solved.problem, solved.excess[0]).find("not computed"), std::string::npos);
}

}  // namespace
}  // namespace polyfly
