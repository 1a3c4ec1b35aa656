// Constraints, blocks of moves, terminal sets and roles against the problem with all states as variables.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "full_space.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/online_program.hpp"
#include "support.hpp"

namespace {

using namespace polyfly;
using namespace polyfly_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 1e-7;
// Factor of a terminal weight with which a short horizon conditions H badly.
constexpr double kHeavy = 1e4;
// Of the cost of a plan that an unstable plant multiplies, relative.
constexpr double kWholeCost = 1e-10;
// A slack below this may be rounding of one that is 0.
constexpr double kSlackTolerance = 1e-7;

class Draw {
 public:
  explicit Draw(unsigned seed) : generator_(seed) {}
  double number(double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(generator_);
  }
  MatrixXd matrix(Eigen::Index rows, Eigen::Index cols, double size) {
    return MatrixXd::NullaryExpr(rows, cols, [&] { return number(-size, size); });
  }
  MatrixXd definite(Eigen::Index size) {
    const MatrixXd root = matrix(size, size, 1.0);
    return root * root.transpose() + 0.2 * MatrixXd::Identity(size, size);
  }

 private:
  std::mt19937 generator_;
};

/// Three states and two inputs in discrete time, near the limit of stability.
MpcProblem randomProblem(Draw* draw) {
  MpcProblem problem;
  problem.name = "random";
  problem.source = "random";
  problem.discrete = true;
  problem.A_c = MatrixXd::Identity(3, 3) + draw->matrix(3, 3, 0.25);
  problem.B_c = draw->matrix(3, 2, 1.0);
  problem.Bd_c = draw->matrix(3, 1, 0.5);
  problem.C = draw->matrix(2, 3, 1.0);
  problem.sampling_time = 0.2;
  problem.horizon = 6;
  problem.Q = draw->definite(3);
  problem.R = draw->definite(2);
  problem.R_delta = draw->definite(2);
  problem.P = draw->definite(3);
  problem.T = MatrixXd::Zero(0, 3);
  for (const char* name : {"x0", "x1", "x2"}) problem.states.push_back({name, "1", -kInfinity, kInfinity});
  for (const char* name : {"u0", "u1"})
    problem.inputs.push_back({name, "1", draw->number(-1.5, -0.5), draw->number(0.5, 1.5)});
  for (const char* name : {"y0", "y1"}) problem.outputs.push_back({name, "1", -kInfinity, kInfinity});
  problem.disturbances = {{"d", "1", -kInfinity, kInfinity}};
  for (int i = 0; i < 3; ++i)
    problem.parameters.push_back({{"e" + std::to_string(i), "1", -1, 1}, ParameterRole::kError, i});
  for (int i = 0; i < 2; ++i) {
    problem.parameters.push_back({{"p" + std::to_string(i), "1", -1, 1}, ParameterRole::kPreviousInput, i});
    problem.parameters.push_back({{"r" + std::to_string(i), "1", -1, 1}, ParameterRole::kInputReference, i});
  }
  return problem;
}

StageConstraint bound(const std::string& name, double lower, double upper) {
  StageConstraint constraint;
  constraint.signal = {name, "1", lower, upper};
  constraint.G_x = Eigen::RowVectorXd::Zero(3);
  constraint.G_u = Eigen::RowVectorXd::Zero(2);
  return constraint;
}

void makeSoft(StageConstraint* constraint, double linear, double quadratic) {
  constraint->soft = true;
  constraint->linear_weight = linear;
  constraint->quadratic_weight = quadratic;
}

void addStateReferences(MpcProblem* problem) {
  for (int i = 0; i < 3; ++i)
    problem->parameters.push_back(
        {{"x_ref" + std::to_string(i), "1", -1, 1}, ParameterRole::kStateReference, i});
}

/// The situation that a value of all parameters stands for: written out again, role by role.
Situation situationAt(const MpcProblem& problem, const DiscreteModel& model, const VectorXd& values) {
  Situation at;
  at.x_ref = VectorXd::Zero(3);
  at.u_ref = VectorXd::Zero(2);
  VectorXd e = VectorXd::Zero(3), x = VectorXd::Zero(3), r = VectorXd::Zero(2), d = VectorXd::Zero(1);
  VectorXd previous = VectorXd::Constant(2, std::nan(""));
  bool absolute = false;
  std::vector<MpcProblem::Parameter> all = problem.parameters;
  all.insert(all.end(), problem.fixed_parameters.begin(), problem.fixed_parameters.end());
  for (std::size_t j = 0; j < all.size(); ++j) {
    const double value = values(static_cast<Eigen::Index>(j));
    const int i = all[j].index;
    if (all[j].role == ParameterRole::kError) e(i) = value;
    if (all[j].role == ParameterRole::kState) x(i) = value;
    if (all[j].role == ParameterRole::kStateReference) at.x_ref(i) = value;
    if (all[j].role == ParameterRole::kInputReference) at.u_ref(i) = value;
    if (all[j].role == ParameterRole::kPreviousInput) previous(i) = value;
    if (all[j].role == ParameterRole::kReference) r(i) = value;
    if (all[j].role == ParameterRole::kDisturbance) d(i) = value;
    absolute = absolute || all[j].role == ParameterRole::kState;
  }
  if (absolute) {
    MatrixXd steady = MatrixXd::Zero(5, 5);
    steady << model.A - MatrixXd::Identity(3, 3), model.B, problem.C, MatrixXd::Zero(2, 2);
    VectorXd right(5);
    right << -model.Bd * d, r;
    const VectorXd solution = steady.inverse() * right;
    at.x_ref = solution.head(3);
    at.u_ref = solution.tail(2);
    at.x = x;
    at.w = model.Bd * d;
  } else {
    at.x = at.x_ref + e;
    at.w = at.x_ref - model.A * at.x_ref - model.B * at.u_ref + model.Bd * d;
  }
  at.u_previous = previous.array().isNaN().select(at.u_ref, previous);
  return at;
}

struct Tally {
  int feasible = 0;
  int infeasible = 0;
  int exceeded = 0;
};

/// Compares inputs, feasibility and slacks at random parameters.
Tally compare(const MpcProblem& problem, unsigned seed, double size) {
  const ParametricProgram program = condense(problem);
  OnlineProgram online(program);
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  Draw draw(seed);
  Tally tally;
  for (int trial = 0; trial < 60; ++trial) {
    const auto p = static_cast<Eigen::Index>(problem.parameters.size());
    VectorXd values(p + static_cast<Eigen::Index>(problem.fixed_parameters.size()));
    values.head(p) = draw.matrix(p, 1, size);
    for (Eigen::Index i = p; i < values.size(); ++i)
      values(i) = problem.fixed_parameters[static_cast<std::size_t>(i - p)].signal.lower;
    const VectorXd theta = values.head(p);
    const Situation at = situationAt(problem, model, values);
    const FullSpaceAnswer expected = solveFullSpace(problem, model, terminalWeight(problem, model), at);
    VectorXd u = VectorXd::Zero(2);
    const bool in_set =
        program.A_theta.rows() == 0 || (program.A_theta * theta - program.b_theta).maxCoeff() <= 0.0;
    const QpStatus status = in_set ? online.solve(theta.data(), u.data()) : QpStatus::kInfeasible;
    EXPECT_EQ(status, expected.status) << trial;
    if (expected.status != QpStatus::kOptimal || status != QpStatus::kOptimal) {
      ++tally.infeasible;
      continue;
    }
    ++tally.feasible;
    EXPECT_LT(maxAbs(u - expected.u.col(0)), kTolerance) << trial;
    VectorXd excess = VectorXd::Zero(expected.excess.size());
    for (const SlackVariable& slack : program.slacks) {
      for (Eigen::Index i = 0; i < excess.size(); ++i)
        if (problem.constraints[static_cast<std::size_t>(i)].signal.name == slack.name)
          excess(i) = std::max(excess(i), online.z()[slack.variable]);
    }
    EXPECT_LT(maxAbs(excess - expected.excess), kTolerance) << trial;
    if (excess.size() > 0 && excess.maxCoeff() > kSlackTolerance) ++tally.exceeded;
  }
  return tally;
}

TEST(Constraints, HardBoundsOnStatesThemselves) {
  int infeasible = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Draw draw(seed);
    MpcProblem problem = randomProblem(&draw);
    addStateReferences(&problem);
    problem.constraints = {bound("low", -0.8, kInfinity), bound("both", -1.2, 0.9)};
    problem.constraints[0].G_x(0) = 1.0;
    problem.constraints[1].G_x(2) = 1.0;
    const Tally tally = compare(problem, seed, 0.6);
    EXPECT_GT(tally.feasible, 0);
    infeasible += tally.infeasible;
  }
  EXPECT_GT(infeasible, 0);
}

TEST(Constraints, ARegulatorBoundsStatesWithoutFurtherParameters) {
  Draw draw(6);
  MpcProblem problem = randomProblem(&draw);
  problem.parameters.resize(3);
  problem.constraints = {bound("both", -0.5, 0.7)};
  problem.constraints[0].G_x(1) = 1.0;
  EXPECT_GT(compare(problem, 6, 1.0).feasible, 10);
}

TEST(Constraints, BoundsFromTheReference) {
  Draw draw(7);
  MpcProblem problem = randomProblem(&draw);
  problem.constraints = {bound("sum", -0.6, 0.8)};
  problem.constraints[0].absolute = false;
  problem.constraints[0].G_x << 1.0, -0.5, 0.0;
  problem.constraints[0].G_u << 0.3, 0.0;
  makeSoft(&problem.constraints[0], 3.0, 1.0);
  const Tally tally = compare(problem, 7, 1.0);
  EXPECT_EQ(tally.infeasible, 0);
  EXPECT_GT(tally.exceeded, 10);
}

TEST(Constraints, SoftBoundsWithAndWithoutALinearWeightAndWithOneSlackForAllStages) {
  for (unsigned seed = 11; seed <= 14; ++seed) {
    Draw draw(seed);
    MpcProblem problem = randomProblem(&draw);
    addStateReferences(&problem);
    problem.constraints = {bound("l1", -0.4, 0.5), bound("l2", -kInfinity, 0.3), bound("peak", -0.6, 0.6)};
    problem.constraints[0].G_x(0) = 1.0;
    problem.constraints[1].G_x << 0.5, 1.0, -1.0;
    problem.constraints[2].G_x(2) = 1.0;
    makeSoft(&problem.constraints[0], 10.0, 0.5);
    makeSoft(&problem.constraints[1], 0.0, 4.0);
    makeSoft(&problem.constraints[2], 20.0, 1.0);
    problem.constraints[2].slack = StageConstraint::Slack::kPerHorizon;
    const Tally tally = compare(problem, seed, 0.8);
    EXPECT_EQ(tally.infeasible, 0);
    EXPECT_GT(tally.exceeded, 10);
  }
}

TEST(Constraints, MixedRowsAndSumsOfInputs) {
  for (unsigned seed = 21; seed <= 23; ++seed) {
    Draw draw(seed);
    MpcProblem problem = randomProblem(&draw);
    addStateReferences(&problem);
    problem.constraints = {bound("mixed", -1.5, 1.5), bound("inputs", -0.8, kInfinity)};
    problem.constraints[0].G_x << 1.0, 0.0, 0.5;
    problem.constraints[0].G_u << 1.0, -1.0;
    problem.constraints[1].G_u << 1.0, 1.0;
    EXPECT_GT(compare(problem, seed, 0.5).feasible, 5);
  }
}

TEST(Constraints, BlocksOfMovesAndChanges) {
  for (unsigned seed = 31; seed <= 34; ++seed) {
    Draw draw(seed);
    MpcProblem problem = randomProblem(&draw);
    problem.moves = {1, 2, 3};
    problem.changes = {{"change of u0", "1", -0.3, 0.4}, {"change of u1", "1", -kInfinity, 0.25}};
    addStateReferences(&problem);
    problem.constraints = {bound("mixed", -1.0, 1.0)};
    problem.constraints[0].G_x << 1.0, 0.0, 0.5;
    problem.constraints[0].G_u << 0.0, 0.7;
    makeSoft(&problem.constraints[0], 5.0, 1.0);
    const Tally tally = compare(problem, seed, 0.4);
    EXPECT_GT(tally.feasible, 30);
  }
}

TEST(Constraints, TerminalSet) {
  int infeasible = 0;
  for (unsigned seed = 41; seed <= 43; ++seed) {
    Draw draw(seed);
    MpcProblem problem = randomProblem(&draw);
    problem.T = draw.matrix(4, 3, 1.0);
    problem.t = VectorXd::Constant(4, 0.3);
    const Tally tally = compare(problem, seed, 0.8);
    EXPECT_GT(tally.feasible, 0);
    infeasible += tally.infeasible;
  }
  EXPECT_GT(infeasible, 0);
}

TEST(Constraints, StatesReferencesAndDisturbancesAsParameters) {
  for (unsigned seed = 51; seed <= 53; ++seed) {
    Draw draw(seed);
    MpcProblem problem = randomProblem(&draw);
    problem.parameters.clear();
    for (int i = 0; i < 3; ++i)
      problem.parameters.push_back({{"x" + std::to_string(i), "1", -1, 1}, ParameterRole::kState, i});
    problem.parameters.push_back({{"d", "1", -1, 1}, ParameterRole::kDisturbance, 0});
    problem.parameters.push_back({{"r1", "1", -1, 1}, ParameterRole::kReference, 1});
    problem.parameters.push_back({{"p0", "1", -1, 1}, ParameterRole::kPreviousInput, 0});
    problem.fixed_parameters = {{{"r0", "1", 0.2, 0.2}, ParameterRole::kReference, 0}};
    problem.constraints = {bound("soft", -0.4, 0.5)};
    problem.constraints[0].G_x(0) = 1.0;
    makeSoft(&problem.constraints[0], 10.0, 0.5);
    const Tally tally = compare(problem, seed, 0.5);
    EXPECT_GT(tally.feasible, 50);
  }
}

TEST(Constraints, DisturbancesAlongTheHorizonOfErrors) {
  Draw draw(61);
  MpcProblem problem = randomProblem(&draw);
  problem.parameters.push_back({{"d", "1", -1, 1}, ParameterRole::kDisturbance, 0});
  problem.states[1].upper = 0.9;
  problem.T = draw.matrix(1, 3, 1.0);
  problem.t = VectorXd::Constant(1, 0.5);
  EXPECT_GT(compare(problem, 61, 0.6).feasible, 10);
}

constexpr int kUnstableHorizon = 14;

/// The same plant, so unstable that the inputs themselves would condition H badly.
MpcProblem unstableProblem(Draw* draw) {
  MpcProblem problem = randomProblem(draw);
  problem.A_c(0, 0) += 1.6;
  problem.horizon = kUnstableHorizon;
  problem.parameters.push_back({{"d", "1", -1, 1}, ParameterRole::kDisturbance, 0});
  return problem;
}

/// No two stages share a term of the inputs' cost.
bool isBesideFeedback(const ParametricProgram& program) {
  const Eigen::Index inputs = program.variableCount() - static_cast<Eigen::Index>(program.slacks.size());
  double shared = 0.0;
  for (Eigen::Index i = 0; i < inputs; ++i)
    for (Eigen::Index j = 0; j < inputs; ++j)
      if (i / 2 != j / 2) shared = std::max(shared, std::abs(program.H(i, j)));
  return shared == 0.0;
}

TEST(BesideAFeedback, AllRowsAndRolesAreThoseOfTheProblem) {
  int exceeded = 0;
  for (unsigned seed = 81; seed <= 84; ++seed) {
    Draw draw(seed);
    MpcProblem problem = unstableProblem(&draw);
    problem.changes = {{"change of u0", "1", -0.3, 0.4}, {"change of u1", "1", -kInfinity, 0.5}};
    problem.states[1].upper = 0.9;
    addStateReferences(&problem);
    problem.constraints = {bound("mixed", -1.0, 1.0), bound("peak", -0.1, 0.1)};
    problem.constraints[0].G_x << 1.0, 0.0, 0.5;
    problem.constraints[0].G_u << 0.0, 0.7;
    makeSoft(&problem.constraints[0], 5.0, 1.0);
    problem.constraints[1].G_x(2) = 1.0;
    makeSoft(&problem.constraints[1], 20.0, 1.0);
    problem.constraints[1].slack = StageConstraint::Slack::kPerHorizon;
    EXPECT_TRUE(isBesideFeedback(condense(problem)));
    const Tally tally = compare(problem, seed, 0.15);
    EXPECT_GT(tally.feasible, 10) << seed;
    exceeded += tally.exceeded;
  }
  EXPECT_GT(exceeded, 10);
}

TEST(BesideAFeedback, TheErrorsEndAtZero) {
  for (unsigned seed = 85; seed <= 87; ++seed) {
    Draw draw(seed);
    for (MpcProblem problem : {unstableProblem(&draw), randomProblem(&draw)}) {
      problem.terminal_equality = true;
      problem.P.resize(0, 0);
      const ParametricProgram program = condense(problem);
      EXPECT_EQ(program.equalities.size(), 3u);
      EXPECT_EQ(isBesideFeedback(program), problem.horizon == kUnstableHorizon);
      EXPECT_GT(compare(problem, seed, 0.05).feasible, 10);
    }
  }
}

TEST(BesideAFeedback, BlockedMovesStayInputs) {
  Draw draw(88);
  MpcProblem problem = unstableProblem(&draw);
  problem.horizon = 9;
  problem.P *= kHeavy;
  EXPECT_TRUE(isBesideFeedback(condense(problem)));
  problem.moves = {1, 1, 1, 1, 1, 1, 1, 2};
  EXPECT_FALSE(isBesideFeedback(condense(problem)));
}

/// Cost of the program and costAtZero() together against Eq. 4, under the inputs of the plan.
void expectWholeCost(MpcProblem problem, Draw* draw) {
  problem.fixed_parameters = {problem.parameters[3]};
  problem.fixed_parameters[0].signal.lower = problem.fixed_parameters[0].signal.upper = 0.4;
  problem.parameters.erase(problem.parameters.begin() + 3);
  InputPlan plan;
  const ParametricProgram program = condense(problem, &plan);
  const MatrixXd rest = costAtZero(problem);
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  const std::vector<int> blocks = blockLengths(problem);
  for (int trial = 0; trial < 20; ++trial) {
    const auto p = static_cast<Eigen::Index>(problem.parameters.size());
    VectorXd values(p + 1);
    values << draw->matrix(p, 1, 1.0), 0.4;
    const Situation at = situationAt(problem, model, values);
    const VectorXd z = draw->matrix(program.variableCount(), 1, 1.0);
    const VectorXd moves = plan.on_z * z + plan.on_theta * values.head(p) + plan.constant;
    double expected = 0.0;
    VectorXd x = at.x, before = at.u_previous;
    for (std::size_t block = 0; block < blocks.size(); ++block) {
      const VectorXd u = at.u_ref + moves.segment(2 * static_cast<Eigen::Index>(block), 2);
      for (int k = 0; k < blocks[block]; ++k) {
        expected += (x - at.x_ref).dot(problem.Q * (x - at.x_ref)) +
                    (u - at.u_ref).dot(problem.R * (u - at.u_ref)) +
                    (u - before).dot(problem.R_delta * (u - before));
        x = (model.A * x + model.B * u + at.w).eval();
        before = u;
      }
    }
    expected += (x - at.x_ref).dot(problem.P * (x - at.x_ref));
    VectorXd extended(p + 1);
    extended << values.head(p), 1.0;
    const double cost = 0.5 * z.dot(program.H * z) + (program.f + program.F * values.head(p)).dot(z) +
                        extended.dot(rest * extended);
    EXPECT_NEAR(cost, expected, kWholeCost * expected);
    EXPECT_LT(maxAbs(program.E * z + program.C * values.head(p) + program.c - at.u_ref - moves.head(2)),
              1e-12);
  }
}

TEST(Constraints, TheCostAtZeroCompletesTheCost) {
  Draw draw(71);
  MpcProblem problem = randomProblem(&draw);
  problem.moves = {2, 4};
  problem.parameters.push_back({{"d", "1", -1, 1}, ParameterRole::kDisturbance, 0});
  expectWholeCost(problem, &draw);
  problem = unstableProblem(&draw);
  problem.horizon = 9;
  problem.P *= kHeavy;
  EXPECT_TRUE(isBesideFeedback(condense(problem)));
  expectWholeCost(problem, &draw);
}

}  // namespace
