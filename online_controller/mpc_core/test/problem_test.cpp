// Problem files: what is read, and that every broken rule is named with file, line and field.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/problem_type.hpp"
#include "mpc_core/read_problem.hpp"
#include "support.hpp"

namespace {

using namespace polyfly;
using namespace polyfly_test;

const char* const kBase = R"(# a cart
polyfly_problem: 1
name: cart
type: tracking_mpc
description: a cart on a rail
model:
  states:
    - {name: p, unit: m}
    - {name: v, unit: m/s, range: [-2, 3]}
  inputs:
    - {name: a, unit: m/s^2, range: [-1, 1.5]}
  disturbances:
    - {name: d, unit: m/s^2}
  A: [[0, 1],
      [0, -0.5]]
  B: [[0], [1]]
  B_d: [[0], [2]]
  C: [[1, 0]]
sampling_time: 0.1
horizon: 5
weights:
  Q: [4, 1]
  R: [[0.5]]
  R_delta: [0.25]
  terminal: riccati
parameters:
  - {name: a_ref, role: input_reference, of: a, unit: m/s^2, range: [-0.5, 0.75]}
  - {name: e_v, role: error, of: v, unit: m/s, range: [-4, 5]}
  - {name: a_prev, role: previous_input, of: a, unit: m/s^2, range: [-1, 1.5]}
  - {name: e_p, role: error, of: p, unit: m, range: [-6, 7]}
)";

TEST(ProblemFile, IsReadAsWritten) {
  const MpcProblem problem = parseProblem(kBase, "cart.yaml");
  EXPECT_EQ(problem.name, "cart");
  EXPECT_EQ(problem.description, "a cart on a rail");
  EXPECT_EQ(problem.source, "cart.yaml");
  EXPECT_EQ(problem.text, kBase);
  ASSERT_EQ(problem.states.size(), 2u);
  EXPECT_EQ(problem.states[0].name, "p");
  EXPECT_EQ(problem.states[0].upper, std::numeric_limits<double>::infinity());
  EXPECT_EQ(problem.states[0].lower, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(problem.states[1].unit, "m/s");
  EXPECT_EQ(problem.states[1].lower, -2.0);
  EXPECT_EQ(problem.states[1].upper, 3.0);
  ASSERT_EQ(problem.inputs.size(), 1u);
  EXPECT_EQ(problem.inputs[0].lower, -1.0);
  EXPECT_EQ(problem.inputs[0].upper, 1.5);
  ASSERT_EQ(problem.disturbances.size(), 1u);
  EXPECT_EQ(problem.disturbances[0].name, "d");
  EXPECT_EQ(problem.disturbances[0].upper, std::numeric_limits<double>::infinity());
  EXPECT_EQ(problem.A_c, (Eigen::Matrix2d() << 0, 1, 0, -0.5).finished());
  EXPECT_EQ(problem.B_c, Eigen::Vector2d(0, 1));
  EXPECT_EQ(problem.Bd_c, Eigen::Vector2d(0, 2));
  EXPECT_EQ(problem.C, Eigen::RowVector2d(1, 0));
  EXPECT_EQ(problem.sampling_time, 0.1);
  EXPECT_EQ(problem.horizon, 5);
  EXPECT_EQ(problem.Q, (Eigen::Matrix2d() << 4, 0, 0, 1).finished());
  EXPECT_EQ(problem.R(0, 0), 0.5);
  EXPECT_EQ(problem.R_delta(0, 0), 0.25);
  ASSERT_EQ(problem.parameters.size(), 4u);
  EXPECT_EQ(problem.parameters[0].role, ParameterRole::kInputReference);
  EXPECT_EQ(problem.parameters[1].role, ParameterRole::kError);
  EXPECT_EQ(problem.parameters[1].index, 1);
  EXPECT_EQ(problem.parameters[2].role, ParameterRole::kPreviousInput);
  EXPECT_EQ(problem.parameters[3].index, 0);
  EXPECT_EQ(problem.parameters[3].signal.name, "e_p");
  EXPECT_EQ(problem.parameters[3].signal.unit, "m");
  EXPECT_EQ(problem.parameters[3].signal.lower, -6.0);
  EXPECT_EQ(problem.parameters[3].signal.upper, 7.0);
}

TEST(ProblemFile, OptionalKeysMayBeAbsent) {
  std::string text = replaced(kBase, "description: a cart on a rail\n", "");
  text = replaced(text, "  disturbances:\n    - {name: d, unit: m/s^2}\n", "");
  text = replaced(text, "  B_d: [[0], [2]]\n", "");
  text = replaced(text, "  R_delta: [0.25]\n  terminal: riccati\n", "");
  const MpcProblem problem = parseProblem(text, "cart.yaml");
  EXPECT_EQ(problem.Bd_c.rows(), 2);
  EXPECT_EQ(problem.Bd_c.cols(), 0);
  EXPECT_EQ(problem.R_delta(0, 0), 0.0);
  EXPECT_TRUE(problem.description.empty());
}

TEST(ProblemFile, TheDelayIsTheControllersAlone) {
  const MpcProblem with = parseProblem(replaced(kBase, "model:\n", "model:\n  delay: 0.06\n"), "cart.yaml");
  EXPECT_EQ(with.delay, 0.06);
  const MpcProblem without = parseProblem(kBase, "cart.yaml");
  EXPECT_EQ(without.delay, 0.0);
  EXPECT_EQ(condense(with).F, condense(without).F);
}

TEST(ProblemFile, ErrorsMayEndAtZero) {
  const MpcProblem problem =
      parseProblem(replaced(kBase, "terminal: riccati", "terminal: equality"), "cart.yaml");
  EXPECT_TRUE(problem.terminal_equality);
  EXPECT_EQ(problem.P.size(), 0);
  EXPECT_FALSE(parseProblem(kBase, "cart.yaml").terminal_equality);
}

TEST(ProblemFile, WeightsMayBeFullMatrices) {
  const MpcProblem problem = parseProblem(replaced(kBase, "Q: [4, 1]", "Q: [[4, 1], [1, 1]]"), "cart.yaml");
  EXPECT_EQ(problem.Q, (Eigen::Matrix2d() << 4, 1, 1, 1).finished());
}

/// One change to the file above, and the complaint it must cause.
struct BadCase {
  std::string from, to;  ///< replace `from` by `to`
  std::string at;        ///< text of the changed file on whose line the complaint must point
  std::string field, rule;
};

std::ostream& operator<<(std::ostream& stream, const BadCase& bad) {
  return stream << bad.field << ": " << bad.rule;
}

class BadProblem : public testing::TestWithParam<BadCase> {};

TEST_P(BadProblem, NamesFileLineFieldAndRule) {
  const BadCase& bad = GetParam();
  const std::string text = replaced(kBase, bad.from, bad.to);
  const std::string message = errorOf([&] { parseProblem(text, "dir/cart.yaml"); });
  const std::string start = "dir/cart.yaml:" + std::to_string(lineOf(text, bad.at)) + ": " + bad.field + ": ";
  EXPECT_EQ(message.substr(0, start.size()), start) << message;
  EXPECT_NE(message.find(bad.rule, start.size()), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    Keys, BadProblem,
    testing::Values(BadCase{"horizon: 5", "horizon: 5\nhorizn: 6", "horizn", "horizn", "unknown key"},
                    BadCase{"horizon: 5", "horizon: 5\nhorizon: 6", "horizon: 6", "horizon", "duplicate key"},
                    BadCase{"  R: [[0.5]]", "  R: [[0.5]]\n  R: [1]", "R: [1]", "weights.R", "duplicate key"},
                    BadCase{"  R: [[0.5]]", "  R: [[0.5]]\n  S: [1]", "S: [1]", "weights.S", "unknown key"},
                    BadCase{"  C: [[1, 0]]", "  C: [[1, 0]]\n  delay: 0.6", "delay:", "model.delay",
                            "must be from 0 to 0.5 s"},
                    BadCase{"  C: [[1, 0]]", "  C: [[1, 0]]\n  delay: -1", "delay:", "model.delay",
                            "must be from 0 to 0.5 s"},
                    BadCase{"  C: [[1, 0]]", "  C: [[1, 0]]\n  D: [[1, 0]]", "D:", "model.D", "unknown key"},
                    BadCase{"{name: p, unit: m}", "{name: p, unit: m, rang: [0, 1]}",
                            "rang:", "model.states[0].rang", "unknown"},
                    BadCase{"{name: d, unit", "{rang: [0, 1], name: d, unit", "name: d",
                            "model.disturbances[0].rang", "unknown"},
                    BadCase{"{name: d, unit", "{range: [1, 0], name: d, unit", "name: d",
                            "model.disturbances[0].range", "lower end must be below"},
                    BadCase{"role: previous_input", "roll: previous_input", "roll:", "parameters[2].roll",
                            "unknown key"},
                    BadCase{"horizon: 5\n", "", "polyfly_problem", "horizon", "missing"},
                    BadCase{"sampling_time: 0.1\n", "", "polyfly_problem", "sampling_time", "missing"},
                    BadCase{"polyfly_problem: 1\n", "", "name: cart", "polyfly_problem", "missing"},
                    BadCase{"name: cart\n", "", "polyfly_problem", "name", "missing"},
                    BadCase{"type: tracking_mpc\n", "", "polyfly_problem", "type", "missing"},
                    BadCase{"  C: [[1, 0]]\n", "", "  states:", "model.C", "missing"},
                    BadCase{"  B_d: [[0], [2]]\n", "", "  states:", "model.B_d", "missing"},
                    BadCase{"  R: [[0.5]]\n", "", "  Q:", "weights.R", "missing"},
                    BadCase{", unit: m}", "}", "name: p", "model.states[0].unit", "missing"},
                    BadCase{", range: [-1, 1.5]}\n  disturbances", "}\n  disturbances", "name: a,",
                            "model.inputs[0].range", "missing"},
                    BadCase{"of: a, unit: m/s^2, range: [-0.5", "unit: m/s^2, range: [-0.5", "a_ref",
                            "parameters[0].of", "missing"},
                    BadCase{"horizon: 5", "? [1, 2]\n: 5", "[1, 2]", "file", "plain names"},
                    BadCase{"horizon: 5", "horizon:", "horizon:", "horizon", "must be a number"},
                    BadCase{"type: tracking_mpc", "type: robust", "robust", "type",
                            "must be tracking_mpc, robust_mpc or safety_filter, got 'robust'"},
                    BadCase{"type: tracking_mpc", "type: robust_mpc", "robust_mpc", "type",
                            "must be tracking_mpc here, got 'robust_mpc'"},
                    BadCase{"sampling_time: 0.1\n", "sampling_time: 0.1\ncalibration: a.yaml\n",
                            "calibration", "calibration", "only a problem file may have it"},
                    BadCase{"sampling_time: 0.1\n", "sampling_time: 0.1\ncalibrations: a.yaml\n",
                            "calibrations", "calibrations", "provenance, calibration"},
                    BadCase{"polyfly_problem: 1", "polyfly_problem: 2", "polyfly_problem", "polyfly_problem",
                            "from 1 to 1"},
                    BadCase{"terminal: riccati", "terminal: none", "none", "weights.terminal",
                            "must be riccati, equality or a weight"}));

INSTANTIATE_TEST_SUITE_P(
    Structure, BadProblem,
    testing::Values(
        BadCase{"  B: [[0], [1]]", "  B: 3", "B: 3", "model.B", "must be a list"},
        BadCase{"  B: [[0], [1]]", "  B: [0, 1]", "B: [0", "model.B[0]", "list of 1 numbers"},
        BadCase{"  B: [[0], [1]]", "  B: [[0]]", "B: [[0]]", "model.B", "2 rows of 1 numbers, got 1 rows"},
        BadCase{"      [0, -0.5]]", "      [0, -0.5, 1]]", "-0.5, 1", "model.A[1]",
                "must have 2 numbers, got 3"},
        BadCase{"[[0], [2]]", "[[0, 1], [2, 1]]", "B_d", "model.B_d[0]", "must have 1 numbers, got 2"},
        BadCase{"C: [[1, 0]]", "C: [[1, 0], [0, 1]]", "  C:", "model.C", "1 rows of 2 numbers, got 2 rows"},
        BadCase{"Q: [4, 1]", "Q: [4, 1, 1]", "Q:", "weights.Q", "2 diagonal entries or rows, got 3"},
        BadCase{"Q: [4, 1]", "Q: [[4, 1], [0, 1]]", "Q:", "weights.Q", "must be symmetric"},
        BadCase{"R_delta: [0.25]", "R_delta: []", "R_delta", "weights.R_delta",
                "1 diagonal entries or rows, got 0"},
        BadCase{"    - {name: p, unit: m}", "    - p", "- p", "model.states[0]", "must be a map"},
        BadCase{"range: [-2, 3]", "range: [-2]", "name: v", "model.states[1].range",
                "must be [lower, upper]"},
        BadCase{"range: [-2, 3]", "range: 3", "name: v", "model.states[1].range", "must be a list"},
        BadCase{"name: cart", "name: [cart]", "name: [", "name", "must be text"},
        BadCase{"name: cart", "name: \"\"", "name: \"", "name", "must not be empty"},
        BadCase{"name: cart", "name: 2cart", "2cart", "name", "not begin with a digit"},
        BadCase{"name: cart", "name: the cart", "the cart", "name", "letters, digits and _"},
        BadCase{"{name: p, unit: m}", "{name: p, unit: m m}", "m m", "model.states[0].unit",
                "without spaces"},
        BadCase{"    - {name: a, unit: m/s^2, range: [-1, 1.5]}\n", "    []\n", "    []", "model.inputs",
                "at least one"},
        BadCase{"  disturbances:\n    - {name: d, unit: m/s^2}\n", "", "  B_d", "model.B_d",
                "must be absent"}));

INSTANTIATE_TEST_SUITE_P(
    Values, BadProblem,
    testing::Values(
        BadCase{"horizon: 5", "horizon: 0", "horizon", "horizon", "from 1 to 200, got 0"},
        BadCase{"horizon: 5", "horizon: 201", "horizon", "horizon", "from 1 to 200, got 201"},
        BadCase{"horizon: 5", "horizon: 2.5", "horizon", "horizon", "whole number"},
        BadCase{"horizon: 5", "horizon: five", "horizon", "horizon", "must be a finite number, got 'five'"},
        BadCase{"horizon: 5", "horizon: 010", "horizon", "horizon",
                "got '010' (decimal digits, without leading zeros)"},
        BadCase{"horizon: 5", "horizon: 08", "horizon", "horizon", "got '08' (decimal"},
        BadCase{"horizon: 5", "horizon: 0x8", "horizon", "horizon", "got '0x8' (decimal"},
        BadCase{"horizon: 5", "horizon: '5'", "horizon", "horizon", "must be a number"},
        BadCase{"sampling_time: 0.1", "sampling_time: 0", "sampling_time", "sampling_time", "greater than 0"},
        BadCase{"sampling_time: 0.1", "sampling_time: -0.1", "sampling_time", "sampling_time",
                "greater than 0"},
        BadCase{"sampling_time: 0.1", "sampling_time: .nan", "sampling_time", "sampling_time", "finite"},
        BadCase{"sampling_time: 0.1", "sampling_time: 0.1s", "sampling_time", "sampling_time",
                "finite number"},
        BadCase{"sampling_time: 0.1", "sampling_time: 1e999", "sampling_time", "sampling_time", "finite"},
        BadCase{"[0, -0.5]", "[.inf, -0.5]", ".inf", "model.A[1][0]", "must be a finite number, got '.inf'"},
        BadCase{"R_delta: [0.25]", "R_delta: [.nan]", "R_delta", "weights.R_delta[0]", "finite"},
        BadCase{"R: [[0.5]]", "R: [0]", "R: [0]", "weights.R", "must be positive definite"},
        BadCase{"R: [[0.5]]", "R: [-1]", "R: [-1]", "weights.R", "must be positive definite"},
        BadCase{"R_delta: [0.25]", "R_delta: [-0.25]", "R_delta", "weights.R_delta", "positive semidefinite"},
        BadCase{"Q: [4, 1]", "Q: [4, -1]", "Q:", "weights.Q", "positive semidefinite"},
        BadCase{"Q: [4, 1]", "Q: [[1, 2], [2, 1]]", "Q:", "weights.Q", "positive semidefinite"},
        BadCase{"range: [-2, 3]", "range: [3, -2]", "name: v", "model.states[1].range", "below the upper"},
        BadCase{"range: [-2, 3]", "range: [1, 3]", "name: v", "model.states[1].range", "must hold 0"},
        BadCase{"range: [-0.5, 0.75]", "range: [1, 1]", "a_ref", "parameters[0].range", "below the upper"},
        BadCase{"range: [-6, 7]", "range: [-.inf, 7]", "e_p", "parameters[3].range[0]", "finite"},
        BadCase{"[-1, 1.5]}\n  dist", "[1.5, -1]}\n  dist", "1.5, -1", "model.inputs[0].range",
                "below the upper"}));

INSTANTIATE_TEST_SUITE_P(
    Meaning, BadProblem,
    testing::Values(
        BadCase{"{name: v, unit: m/s,", "{name: p, unit: m/s,", "unit: m/s,", "model.states[1].name",
                "duplicate name"},
        BadCase{"{name: d, unit", "{name: a, unit", "name: a, unit: m/s^2}", "model.disturbances[0].name",
                "duplicate"},
        BadCase{"name: e_v", "name: e_p", "of: p,", "parameters[3].name", "duplicate name"},
        BadCase{"of: v", "of: w", "of: w", "parameters[1].of", "must name a state, got 'w'"},
        BadCase{"of: v", "of: a", "e_v", "parameters[1].of", "must name a state, got 'a'"},
        BadCase{"role: previous_input, of: a", "role: previous_input, of: p", "a_prev", "parameters[2].of",
                "must name an input"},
        BadCase{"of: v, unit: m/s", "of: v, unit: km/h", "km/h", "parameters[1].unit",
                "must be m/s as for 'v'"},
        BadCase{"role: previous_input", "role: input_reference", "a_prev", "parameters[2].of",
                "another parameter"},
        BadCase{"role: previous_input", "role: input", "a_prev", "parameters[2].role", "got 'input'"},
        BadCase{"  - {name: e_p, role: error, of: p, unit: m, range: [-6, 7]}\n", "", "  - {name: a_ref",
                "parameters", "role error of state 'p'"},
        BadCase{"C: [[1, 0]]", "C: [[0, 1]]", "  C:", "model.C", "Eq. 6"},
        BadCase{"[0, -0.5]", "[0, 1e20]", "  A:", "model.A", "must not overflow"},
        BadCase{"[0, -0.5]", "[0, 1e300]", "[0, 1e300]", "model.A[1][1]", "must not exceed 1e+30"},
        BadCase{"B: [[0], [1]]", "B: [[0], [0]]", "  C:", "model.C", "Eq. 6"},
        BadCase{"Q: [4, 1]", "Q: [0, 1]", "  Q:", "weights.terminal", "detectable"}));

std::string nameOfFlightModel(const std::string& file) {
  return parseFlightModel(readProblem(problemFile(file)), file).name;
}

// What flies a type, and which of them are explored as a parametric program, is what the registry says.
TEST(ProblemTypes, EachHasWhatFliesIt) {
  ASSERT_EQ(problemTypes().size(), 3U);
  EXPECT_NE(errorOf([] {
              nameOfFlightModel("safety/fence_y.yaml");
            }).find("type: no controller flies a map of a safety_filter"),
            std::string::npos);
  EXPECT_EQ(nameOfFlightModel("multirotor_lateral.yaml"), "multirotor_lateral");
  EXPECT_EQ(nameOfFlightModel("robust/aslquad_lateral.yaml"), "aslquad_lateral");
  const std::string robust = readProblem(problemFile("robust/aslquad_lateral.yaml"));
  ASSERT_NE(problemTypeOf(robust, "robust"), nullptr);
  EXPECT_EQ(std::string(problemTypeOf(robust, "robust")->name), "robust_mpc");
  EXPECT_EQ(problemTypeOf("name: a\n", "none"), nullptr);
  EXPECT_EQ(problemTypeOf("type: other\n", "none"), nullptr);
  try {
    parseProgram(robust, "yaml", "robust.yaml");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("type: must be tracking_mpc here, got 'robust_mpc'"),
              std::string::npos)
        << error.what();
  }
}

TEST(BadProblemFile, MalformedYamlNamesTheLine) {
  const std::string unclosed = replaced(kBase, "C: [[1, 0]]", "C: [[1, 0]");
  const std::string message = errorOf([&] { parseProblem(unclosed, "cart.yaml"); });
  EXPECT_EQ(message.find("cart.yaml:" + std::to_string(lineOf(unclosed, "sampling_time"))), 0u) << message;
  EXPECT_NE(message.find(": file: is not valid YAML: "), std::string::npos) << message;

  const std::string tab = replaced(kBase, "horizon: 5", "\thorizon: 5");
  const std::string tab_message = errorOf([&] { parseProblem(tab, "cart.yaml"); });
  EXPECT_EQ(tab_message.find("cart.yaml:" + std::to_string(lineOf(tab, "\thorizon"))), 0u) << tab_message;
}

TEST(BadProblemFile, HoldsOneDocument) {
  const std::string text = std::string(kBase) + "---\nsecond: 1\n";
  const std::string message = errorOf([&] { parseProblem(text, "cart.yaml"); });
  const std::string start = "cart.yaml:" + std::to_string(lineOf(text, "---")) + ": file: ";
  EXPECT_EQ(message.find(start), 0u) << message;
}

TEST(BadProblemFile, IsNotAMap) {
  EXPECT_EQ(errorOf([] { parseProblem("- 1\n", "cart.yaml"); }).find("cart.yaml:1: file: must be a map"), 0u);
  EXPECT_EQ(errorOf([] { parseProblem("# nothing\n", "cart.yaml"); }),
            "cart.yaml:1: file: must not be empty");
}

TEST(BadProblemFile, NeverCausesAnotherException) {
  // Random damage: either it is still a problem, or the complaint is an Error that names the file.
  const std::string base = kBase;
  const std::string pieces = "[]{}:,-#&*!|>'\"%@`\n\t 0.e~<?\xff";
  std::mt19937 generator(1);
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::string text = base;
    for (int change = 0; change <= trial % 3; ++change) {
      const std::size_t place = generator() % text.size();
      const std::size_t length = generator() % 4;
      text.replace(place, length, 1, pieces[generator() % pieces.size()]);
    }
    if (trial % 10 == 0) text.resize(generator() % text.size());
    try {
      parseProblem(text, "cart.yaml");
    } catch (const Error& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).find("cart.yaml:"), 0u) << error.what();
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(BadProblemFile, AliasThatHoldsItselfIsRefused) {
  const std::string text = replaced(kBase, "C: [[1, 0]]", "C: &c [*c, *c]");
  const std::string start = "cart.yaml:" + std::to_string(lineOf(text, "&c")) + ": ";
  EXPECT_EQ(errorOf([&] { parseProblem(text, "cart.yaml"); }).find(start), 0u);
}

TEST(BadProblemFile, EndlessNestingIsRefused) {
  const std::string deep = "polyfly_problem: " + std::string(100000, '[');
  EXPECT_EQ(errorOf([&] { parseProblem(deep, "cart.yaml"); }).find("cart.yaml:1: file: "), 0u);
}

TEST(BadProblemFile, MissingDirectoryEmpty) {
  const std::string missing = testing::TempDir() + "polyfly_no_such_problem.yaml";
  EXPECT_EQ(errorOf([&] { loadProblem(missing); }).find(missing + ": file: cannot be opened: "), 0u);
  EXPECT_EQ(errorOf([&] { loadProgram(missing); }).find(missing + ": file: cannot be opened: "), 0u);
  EXPECT_EQ(errorOf([] { loadProblem(projectRoot()); }), projectRoot() + ": file: must not be a directory");
  const std::string empty = testing::TempDir() + "polyfly_empty_problem.yaml";
  std::ofstream(empty) << " \n";
  EXPECT_EQ(errorOf([&] { loadProblem(empty); }), empty + ":1: file: must not be empty");
  std::remove(empty.c_str());
}

TEST(BadProblemFile, UnknownEndingOrKind) {
  EXPECT_NE(errorOf([] { loadProgram("map.txt"); }).find("map.txt: file: name must end in"),
            std::string::npos);
  EXPECT_NE(errorOf([] { parseProgram("", "toml", "a.map"); }).find("a.map: text_kind: must be"),
            std::string::npos);
}

TEST(Multirotor, FilesHaveTheSignalsThatTheControllerBinds) {
  const std::vector<std::vector<std::string>> names = {
      {"e_p_x", "e_v_x", "e_theta", "theta_cmd_prev", "theta_cmd_ref"},
      {"e_p_y", "e_v_y", "e_phi", "phi_cmd_prev", "phi_cmd_ref"},
      {"e_p_z", "e_v_z", "T_cmd_prev", "T_cmd_ref"}};
  const char* const files[] = {"multirotor_longitudinal.yaml", "multirotor_lateral.yaml",
                               "multirotor_vertical.yaml"};
  const char* const inputs[] = {"theta_cmd", "phi_cmd", "T_cmd"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const ParametricProgram program = loadProgram(problemFile(files[axis]));
    EXPECT_EQ(program.period, 0.1);
    EXPECT_EQ(program.variableCount(), 20);
    ASSERT_EQ(program.parameters.size(), names[axis].size());
    for (std::size_t i = 0; i < names[axis].size(); ++i)
      EXPECT_EQ(program.parameters[i].name, names[axis][i]);
    ASSERT_EQ(program.inputs.size(), 1u);
    EXPECT_EQ(program.inputs[0].name, inputs[axis]);
  }
}

TEST(Multirotor, ModelsAreThoseOfTheNonlinearOneAtHover) {
  constexpr double kGravity = 9.8066;
  const MpcProblem x = loadProblem(problemFile("multirotor_longitudinal.yaml"));
  const MpcProblem y = loadProblem(problemFile("multirotor_lateral.yaml"));
  const MpcProblem z = loadProblem(problemFile("multirotor_vertical.yaml"));
  // Eq. 37 with yaw 0 and thrust g: R e_z T = T (sin(theta) cos(phi), -sin(phi), cos(theta) cos(phi)).
  const double step = 1e-6;
  EXPECT_NEAR(x.A_c(1, 2), kGravity * std::sin(step) / step, 1e-9);
  EXPECT_NEAR(y.A_c(1, 2), -kGravity * std::sin(step) / step, 1e-9);
  EXPECT_DOUBLE_EQ(x.A_c(1, 1), -0.01);
  EXPECT_DOUBLE_EQ(y.A_c(1, 1), -0.01);
  EXPECT_DOUBLE_EQ(x.A_c(2, 2), -1.0 / 0.255);
  EXPECT_DOUBLE_EQ(y.A_c(2, 2), -1.0 / 0.25);
  EXPECT_DOUBLE_EQ(x.B_c(2, 0), 0.9 / 0.255);
  EXPECT_DOUBLE_EQ(y.B_c(2, 0), 0.9 / 0.25);
  EXPECT_DOUBLE_EQ(z.B_c(1, 0), 1.0);
  EXPECT_DOUBLE_EQ(z.inputs[0].lower + kGravity, 5.0);
  EXPECT_DOUBLE_EQ(z.inputs[0].upper + kGravity, 20.0);
  EXPECT_NEAR(x.inputs[0].upper, 25.0 * M_PI / 180.0, 5e-8);
  EXPECT_NEAR(y.inputs[0].lower, -25.0 * M_PI / 180.0, 5e-8);
}

}  // namespace
