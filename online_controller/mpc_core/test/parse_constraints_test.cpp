// What a problem file says beyond model, weights and ranges, and that each broken rule is named.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/program_json.hpp"
#include "support.hpp"

namespace {

using namespace polyfly;
using namespace polyfly_test;

const char* const kCart = R"(polyfly_problem: 1
name: cart
type: tracking_mpc
model:
  time: discrete
  states:
    - {name: p, unit: m}
    - {name: v, unit: m/s}
  inputs:
    - {name: a, unit: m/s^2, range: [-1, 1.5], change: [-0.5, 0.25]}
  disturbances:
    - {name: d, unit: m/s^2}
  A: [[1, 0.5], [0, 1]]
  B: [[0.125], [0.5]]
  B_d: [[0.125], [0.5]]
  C: [[1, 0]]
sampling_time: 0.5
horizon: 8
moves: [1, 3, 4]
weights:
  Q: [4, 1]
  R: [0.5]
  terminal: [[3, 1], [1, 2]]
constraints:
  - {of: v, range: [-2, 3], soft: {linear: 100, quadratic: 2}}
  - {name: braking, of: {p: 1, v: 0.5, a: -0.25}, unit: m, upper: 4, measured_from: reference}
  - {name: peak, of: p, lower: -5, soft: {quadratic: 7, slack: horizon}}
terminal_set:
  T: [[1, 0], [0, -1]]
  t: [2, 3]
parameters:
  - {name: e_p, role: error, of: p, unit: m, range: [-6, 7]}
  - {name: e_v, role: error, of: v, unit: m/s, range: [-4, 5]}
  - {name: v_ref, role: state_reference, of: v, unit: m/s, range: [-2, 2]}
  - {name: p_ref, role: state_reference, of: p, unit: m, value: 0}
  - {name: a_prev, role: previous_input, of: a, unit: m/s^2, range: [-1, 1.5]}
  - {name: a_ref, role: input_reference, of: a, unit: m/s^2, range: [-0.5, 0.5]}
  - {name: gust, role: disturbance, of: d, unit: m/s^2, range: [-1, 1]}
)";

TEST(ProblemConstraints, AreReadAsWritten) {
  const MpcProblem problem = parseProblem(kCart, "cart.yaml");
  EXPECT_TRUE(problem.discrete);
  EXPECT_EQ(problem.moves, (std::vector<int>{1, 3, 4}));
  ASSERT_EQ(problem.changes.size(), 1u);
  EXPECT_EQ(problem.changes[0].lower, -0.5);
  EXPECT_EQ(problem.changes[0].upper, 0.25);
  EXPECT_EQ(problem.P, (Eigen::Matrix2d() << 3, 1, 1, 2).finished());
  EXPECT_EQ(problem.T, (Eigen::Matrix2d() << 1, 0, 0, -1).finished());
  EXPECT_EQ(problem.t, Eigen::Vector2d(2, 3));
  ASSERT_EQ(problem.constraints.size(), 3u);
  const StageConstraint& speed = problem.constraints[0];
  EXPECT_EQ(speed.signal.name, "v");
  EXPECT_EQ(speed.signal.unit, "m/s");
  EXPECT_EQ(speed.signal.lower, -2.0);
  EXPECT_EQ(speed.signal.upper, 3.0);
  EXPECT_EQ(speed.G_x, Eigen::RowVector2d(0, 1));
  EXPECT_TRUE(speed.absolute);
  EXPECT_TRUE(speed.soft);
  EXPECT_EQ(speed.linear_weight, 100.0);
  EXPECT_EQ(speed.quadratic_weight, 2.0);
  EXPECT_EQ(speed.slack, StageConstraint::Slack::kPerStage);
  const StageConstraint& braking = problem.constraints[1];
  EXPECT_EQ(braking.G_x, Eigen::RowVector2d(1, 0.5));
  EXPECT_EQ(braking.G_u(0), -0.25);
  EXPECT_TRUE(std::isinf(braking.signal.lower));
  EXPECT_FALSE(braking.absolute);
  EXPECT_FALSE(braking.soft);
  EXPECT_EQ(problem.constraints[2].slack, StageConstraint::Slack::kPerHorizon);
  EXPECT_EQ(problem.constraints[2].linear_weight, 0.0);
  ASSERT_EQ(problem.fixed_parameters.size(), 1u);
  EXPECT_EQ(problem.fixed_parameters[0].signal.lower, 0.0);
  EXPECT_EQ(problem.parameters.size(), 6u);
  EXPECT_EQ(problem.outputs[0].name, "p");
}

TEST(ProblemConstraints, AControlHorizonIsALastBlock) {
  const std::string text = replaced(kCart, "moves: [1, 3, 4]", "control_horizon: 3");
  EXPECT_EQ(parseProblem(text, "cart.yaml").moves, (std::vector<int>{1, 1, 6}));
}

TEST(ProblemConstraints, ARegulatorNeedsNoStateReference) {
  std::string text =
      replaced(kCart, "  - {name: v_ref, role: state_reference, of: v, unit: m/s, range: [-2, 2]}\n", "");
  const std::string message = errorOf([&] { parseProblem(text, "cart.yaml"); });
  EXPECT_NE(message.find("constraints[0]: bounds v itself, while u_ref is a parameter: needs a parameter "
                         "with role state_reference of v"),
            std::string::npos)
      << message;
  text = replaced(text, "  - {name: a_ref, role: input_reference, of: a, unit: m/s^2, range: [-0.5, 0.5]}\n",
                  "");
  EXPECT_EQ(condense(parseProblem(text, "cart.yaml")).parameterCount(), 4);
}

TEST(ProblemConstraints, RowsAndSlacksHaveNames) {
  const ParametricProgram program = condense(parseProblem(kCart, "cart.yaml"));
  // Three blocks, a slack of v for each of eight stages, one of p.
  EXPECT_EQ(program.variableCount(), 3 + 8 + 1);
  ASSERT_EQ(program.slacks.size(), 9u);
  ASSERT_EQ(program.row_names.size(), static_cast<std::size_t>(program.rowCount()));
  const auto name_of = [&](int row) { return program.row_names[static_cast<std::size_t>(row)]; };
  EXPECT_EQ(name_of(program.slacks[1].rows.at(0)), "v at its upper bound, step 2");
  EXPECT_EQ(name_of(program.slacks[1].rows.at(1)), "v at its lower bound, step 2");
  EXPECT_EQ(name_of(program.slacks[1].floor), "v within its bounds");
  EXPECT_EQ(program.slacks[8].name, "peak");
  EXPECT_EQ(program.slacks[8].rows.size(), 8u);
  EXPECT_EQ(program.slacks[8].floor, -1);
}

TEST(ProgramJsonText, KeepsNumbersNamesUnitsAndPeriod) {
  for (const std::string& text : {std::string(kCart), fileText(problemFile("multirotor_lateral.yaml"))}) {
    const ParametricProgram program = condense(parseProblem(text, "cart.yaml"));
    const std::string json = programJson(program);
    const ParametricProgram again = parseProgramJson(json, "cart.json");
    EXPECT_EQ(programJson(again), json);
    EXPECT_EQ(again.name, program.name);
    EXPECT_EQ(again.period, program.period);
    for (const auto matrix :
         {&ParametricProgram::H, &ParametricProgram::F, &ParametricProgram::A, &ParametricProgram::S,
          &ParametricProgram::E, &ParametricProgram::C, &ParametricProgram::A_theta})
      EXPECT_EQ(again.*matrix, program.*matrix);
    for (const auto vector :
         {&ParametricProgram::f, &ParametricProgram::b, &ParametricProgram::c, &ParametricProgram::b_theta})
      EXPECT_EQ(again.*vector, program.*vector);
    EXPECT_EQ(again.row_names, program.row_names);
    EXPECT_EQ(again.inputs[0].name, program.inputs[0].name);
    EXPECT_EQ(again.inputs[0].upper, program.inputs[0].upper);
    for (std::size_t i = 0; i < program.parameters.size(); ++i) {
      EXPECT_EQ(again.parameters[i].name, program.parameters[i].name);
      EXPECT_EQ(again.parameters[i].unit, program.parameters[i].unit);
      EXPECT_EQ(again.parameters[i].lower, program.parameters[i].lower);
    }
    ASSERT_EQ(again.slacks.size(), program.slacks.size());
    for (std::size_t i = 0; i < program.slacks.size(); ++i) {
      EXPECT_EQ(again.slacks[i].variable, program.slacks[i].variable);
      EXPECT_EQ(again.slacks[i].rows, program.slacks[i].rows);
      EXPECT_EQ(again.slacks[i].floor, program.slacks[i].floor);
      EXPECT_EQ(again.slacks[i].name, program.slacks[i].name);
    }
  }
}

TEST(ProgramJsonText, RefusesWrongNamesAndSlacks) {
  const std::string base =
      R"({"name": "tiny", "period": 0.1, "H": [[2, 0], [0, 1]], "f": [0, 1], "F": [[1], [0]],
    "A": [[1, -1], [0, -1]], "b": [1, 0], "B": [[0], [0]], "lb": [-1], "ub": [1],
    "parameters": [{"name": "x", "unit": "m"}], "row_names": ["top", "floor"],
    "inputs": [{"name": "u", "unit": "N", "lower": null, "upper": 3}], "E": [[1, 0]], "C": [[0]], "c": [0],
    "slacks": [{"name": "x", "unit": "m", "variable": 1, "rows": [0], "floor": 1}]})";
  EXPECT_TRUE(std::isinf(parseProgramJson(base, "tiny.json").inputs[0].lower));
  const std::vector<std::array<std::string, 4>> cases = {
      {"\"period\": 0.1", "\"period\": -1", "period", "0 or more"},
      {"[{\"name\": \"x\", \"unit\": \"m\"}]", "[]", "parameters", "must have 1 entries"},
      {"{\"name\": \"x\", \"unit\": \"m\"}", "{\"name\": \"x\"}", "parameters[0].unit", "missing"},
      {"{\"name\": \"x\", \"unit\": \"m\"}", "{\"name\": \"\", \"unit\": \"m\"}", "parameters[0].name",
       "must be text"},
      {"{\"name\": \"x\", \"unit\": \"m\"}", "{\"name\": \"x\", \"unit\": \"m\", \"range\": 1}",
       "parameters[0].range", "unknown key"},
      {"[\"top\", \"floor\"]", "[\"top\"]", "row_names", "must have 2 entries"},
      {"\"upper\": 3", "\"upper\": \"3\"", "inputs[0].upper", "finite numbers"},
      {"\"E\": [[1, 0]]", "\"out\": [0]", "C", "needs E"},
      {"\"C\": [[0]], ", "", "C", "missing"},
      {"\"variable\": 1", "\"variable\": 2", "slacks[0].variable", "from 0 to 1"},
      {"\"rows\": [0]", "\"rows\": [5]", "slacks[0].rows", "from 0 to 1"},
      {"\"floor\": 1}", "\"floor\": 9}", "slacks[0].floor", "from 0 to 1"}};
  for (const auto& [from, to, field, rule] : cases) {
    const std::string text = replaced(base, from, to);
    const std::string message = errorOf([&] { parseProgramJson(text, "tiny.json"); });
    EXPECT_NE(message.find(field + ": "), std::string::npos) << message;
    EXPECT_NE(message.find(rule), std::string::npos) << message;
  }
}

struct BadConstraint {
  std::string from, to;
  std::string field, rule;
};

std::ostream& operator<<(std::ostream& stream, const BadConstraint& bad) { return stream << bad.to; }

class BadConstraints : public testing::TestWithParam<BadConstraint> {};

TEST_P(BadConstraints, NameFileFieldAndRule) {
  const BadConstraint& bad = GetParam();
  const std::string message = errorOf([&] { parseProblem(replaced(kCart, bad.from, bad.to), "cart.yaml"); });
  EXPECT_EQ(message.substr(0, 10), "cart.yaml:") << message;
  EXPECT_NE(message.find(": " + bad.field + ": "), std::string::npos) << message;
  EXPECT_NE(message.find(bad.rule), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadConstraints,
    testing::Values(
        BadConstraint{"time: discrete", "time: sampled", "model.time", "must be continuous or discrete"},
        BadConstraint{"change: [-0.5, 0.25]", "change: [0.1, 0.25]", "model.inputs[0].change", "must hold 0"},
        BadConstraint{"moves: [1, 3, 4]", "moves: [1, 3, 3]", "moves",
                      "must add up to the horizon 8, not to 7"},
        BadConstraint{"moves: [1, 3, 4]", "moves: [0, 4, 4]", "moves[0]", "whole number from 1"},
        BadConstraint{"moves: [1, 3, 4]", "moves: [1, 3, 4]\ncontrol_horizon: 2", "control_horizon",
                      "only one"},
        BadConstraint{"quadratic: 2}", "quadratic: 0}", "constraints[0].soft.quadratic", "must be above 0"},
        BadConstraint{", quadratic: 2}", "}", "constraints[0].soft.quadratic", "missing"},
        BadConstraint{"linear: 100", "linear: -1", "constraints[0].soft.linear", "0 or more"},
        BadConstraint{"slack: horizon", "slack: all", "constraints[2].soft.slack",
                      "must be stage or horizon"},
        BadConstraint{"of: v, range", "of: w, range", "constraints[0].of", "must name a state or an input"},
        BadConstraint{"v: 0.5,", "w: 0.5,", "constraints[1].of", "must name a state or an input"},
        BadConstraint{"v: 0.5,", "v: 0,", "constraints[1].of.v", "must not be 0"},
        BadConstraint{"v: 0.5,", "p: 0.5,", "constraints[1].of.p", "duplicate"},
        BadConstraint{"name: braking, ", "", "constraints[1].name", "missing"},
        BadConstraint{"name: braking", "name: v", "constraints[1].name", "duplicate name 'v'"},
        BadConstraint{"upper: 4", "upper: 4, range: [0, 1]", "constraints[1].range",
                      "one of lower and upper"},
        BadConstraint{"upper: 4", "upper: 4, lower: 1", "constraints[1].upper", "as a range"},
        BadConstraint{", upper: 4", "", "constraints[1].range", "must be given"},
        BadConstraint{"measured_from: reference", "measured_from: here", "constraints[1].measured_from",
                      "must be zero or reference"},
        BadConstraint{"t: [2, 3]", "t: [2, 0]", "terminal_set.t[1]", "must be above 0"},
        BadConstraint{"t: [2, 3]", "t: [2]", "terminal_set.t", "must have 2 numbers"},
        BadConstraint{"T: [[1, 0],", "T: [[0, 0],", "terminal_set.T[0]", "must not be zero"},
        BadConstraint{"[[3, 1], [1, 2]]", "[[3, 4], [4, 2]]", "weights.terminal", "positive semidefinite"},
        BadConstraint{"terminal: [[3, 1], [1, 2]]", "terminal: equality", "terminal_set", "must be absent"},
        BadConstraint{"unit: m, value: 0", "unit: m, value: 0, range: [0, 1]", "parameters[3].value",
                      "no range"},
        BadConstraint{"role: disturbance, of: d", "role: disturbance, of: v", "parameters[6].of",
                      "must name a disturbance"},
        BadConstraint{"role: error, of: p", "role: state, of: p", "parameters",
                      "does not go with role state"},
        BadConstraint{"{name: gust, role: disturbance, of: d, unit: m/s^2",
                      "{name: r, role: reference, of: p, unit: m", "parameters",
                      "needs the states themselves"},
        BadConstraint{"  - {name: a_prev, role: previous_input, of: a, unit: m/s^2, range: [-1, 1.5]}\n", "",
                      "model.inputs[0].change", "needs a parameter with role previous_input of a"}));

}  // namespace
