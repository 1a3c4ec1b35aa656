// The generic JSON form and the check of a program.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/parametric_program.hpp"
#include "support.hpp"

namespace {

using namespace polyfly;
using namespace polyfly_test;

const char* const kBase = R"({
 "name": "tiny", "tags": ["ignored"], "n": 2, "m": 3, "n_theta": 1,
 "H": [[2, 1], [1, 3]], "f": [4, 5], "F": [[6], [7]],
 "A": [[1, 0], [0, 1], [1, 1]], "b": [8, 9, 10], "B": [[11], [12], [13]], "eq_ids": [2],
 "lb": [-1], "ub": [2], "A_theta": [[3]], "b_theta": [4], "out": [1]
})";

TEST(ProgramJson, IsReadAsWritten) {
  const ParametricProgram program = parseProgramJson(kBase, "tiny.json");
  EXPECT_EQ(program.name, "tiny");
  EXPECT_EQ(program.text, kBase);
  EXPECT_EQ(program.text_kind, "json");
  EXPECT_EQ(program.period, 0.0);
  EXPECT_EQ(program.H, (Eigen::Matrix2d() << 2, 1, 1, 3).finished());
  EXPECT_EQ(program.f, Eigen::Vector2d(4, 5));
  EXPECT_EQ(program.F, Eigen::Vector2d(6, 7));
  EXPECT_EQ(program.A, (Eigen::Matrix<double, 3, 2>() << 1, 0, 0, 1, 1, 1).finished());
  EXPECT_EQ(program.b, Eigen::Vector3d(8, 9, 10));
  EXPECT_EQ(program.S, Eigen::Vector3d(11, 12, 13));
  EXPECT_EQ(program.equalities, std::vector<int>{2});
  ASSERT_EQ(program.parameters.size(), 1u);
  EXPECT_EQ(program.parameters[0].name, "theta_0");
  EXPECT_EQ(program.parameters[0].lower, -1.0);
  EXPECT_EQ(program.parameters[0].upper, 2.0);
  EXPECT_EQ(program.A_theta(0, 0), 3.0);
  EXPECT_EQ(program.b_theta(0), 4.0);
  ASSERT_EQ(program.inputs.size(), 1u);
  EXPECT_EQ(program.inputs[0].name, "u_0");
  EXPECT_EQ(program.inputs[0].upper, std::numeric_limits<double>::infinity());
  EXPECT_EQ(program.E, Eigen::RowVector2d(0, 1));
  EXPECT_EQ(maxAbs(program.C), 0.0);
  EXPECT_EQ(maxAbs(program.c), 0.0);
}

TEST(ProgramJson, OptionalKeysMayBeAbsent) {
  std::string text =
      replaced(kBase, R"("name": "tiny", "tags": ["ignored"], "n": 2, "m": 3, "n_theta": 1,)", "");
  text = replaced(text, R"(, "eq_ids": [2])", "");
  text = replaced(text, R"(, "A_theta": [[3]], "b_theta": [4], "out": [1])", "");
  const ParametricProgram program = parseProgramJson(text, "dir.d/tiny.json");
  EXPECT_EQ(program.name, "tiny");
  EXPECT_TRUE(program.equalities.empty());
  EXPECT_EQ(program.A_theta.rows(), 0);
  EXPECT_EQ(program.A_theta.cols(), 1);
  EXPECT_EQ(program.E, Eigen::Matrix2d::Identity());
}

TEST(ProgramJson, HessianMayBeZero) {
  const ParametricProgram program =
      parseProgramJson(replaced(kBase, "[[2, 1], [1, 3]]", "[[0, 0], [0, 0]]"), "lp.json");
  EXPECT_EQ(maxAbs(program.H), 0.0);
}

TEST(ProgramJson, MayHaveNoRows) {
  std::string text = replaced(kBase, "[[1, 0], [0, 1], [1, 1]]", "[]");
  text = replaced(text, "[8, 9, 10]", "[]");
  text = replaced(text, "[[11], [12], [13]]", "[]");
  text = replaced(replaced(text, "\"eq_ids\": [2]", "\"eq_ids\": []"), "\"m\": 3", "\"m\": 0");
  const ParametricProgram program = parseProgramJson(text, "free.json");
  EXPECT_EQ(program.rowCount(), 0);
  EXPECT_EQ(program.A.cols(), 2);
}

struct BadCase {
  std::string from, to, field, rule;
};

std::ostream& operator<<(std::ostream& stream, const BadCase& bad) {
  return stream << bad.field << ": " << bad.rule;
}

class BadProgramJson : public testing::TestWithParam<BadCase> {};

TEST_P(BadProgramJson, NamesFileFieldAndRule) {
  const BadCase& bad = GetParam();
  const std::string text = replaced(kBase, bad.from, bad.to);
  const std::string message = errorOf([&] { parseProgramJson(text, "tiny.json"); });
  EXPECT_EQ(message.find("tiny.json: " + bad.field + ": "), 0u) << message;
  EXPECT_NE(message.find(bad.rule), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadProgramJson,
    testing::Values(BadCase{"\"H\"", "\"G\"", "H", "missing"}, BadCase{"\"lb\"", "\"low\"", "lb", "missing"},
                    BadCase{"\"ub\"", "\"up\"", "ub", "missing"}, BadCase{"\"B\"", "\"W\"", "B", "missing"},
                    BadCase{"[[2, 1], [1, 3]]", "[[2, 1]]", "H", "2 rows, got 1"},
                    BadCase{"[[2, 1], [1, 3]]", "[[2, 1], [1]]", "H[1]", "2 numbers, got 1"},
                    BadCase{"[[2, 1], [1, 3]]", "[[2, 1], [2, 3]]", "H", "symmetric"},
                    BadCase{"[[2, 1], [1, 3]]", "[[1, 2], [2, 1]]", "H", "semidefinite"},
                    BadCase{"[[2, 1], [1, 3]]", "[[2, 1], [1, null]]", "H[1]", "finite numbers"},
                    BadCase{"[[2, 1], [1, 3]]", "[[2, 1], [1, \"3\"]]", "H[1]", "finite numbers"},
                    BadCase{"[[2, 1], [1, 3]]", "[[2, 1], [1, 1e999]]", "file", "not valid JSON"},
                    BadCase{"[[2, 1], [1, 3]]", "5", "H", "must be a list"},
                    BadCase{"[8, 9, 10]", "[8, 9]", "b", "3 numbers, got 2"},
                    BadCase{"[8, 9, 10]", "[8, 9, 10, 11]", "b", "3 numbers, got 4"},
                    BadCase{"[[1, 0], [0, 1], [1, 1]]", "[[1, 0], [0, 1]]", "A", "3 rows, got 2"},
                    BadCase{"[[11], [12], [13]]", "[[11]]", "B", "3 rows, got 1"},
                    BadCase{"[4, 5]", "[4]", "f", "2 numbers, got 1"},
                    BadCase{"[[6], [7]]", "[[6]]", "F", "2 rows, got 1"},
                    BadCase{"\"A_theta\": [[3]]", "\"A_theta\": [[3], [4]]", "b_theta", "2 numbers, got 1"},
                    BadCase{"\"A_theta\"", "\"A_thet\"", "A_thet", "unknown key; known are name, H, "},
                    BadCase{"\"eq_ids\"", "\"eqids\"", "eqids", "and keys that begin with _"},
                    BadCase{"\"out\"", "\"Out\"", "Out", "unknown key"},
                    BadCase{"\"tags\"", "\"\"", "", "unknown key"},
                    BadCase{"\"lb\": [-1]", "\"lb\": [-1e308]", "lb[0]",
                            "must not exceed 1e+30 in size, got -1e+308"},
                    BadCase{"[[2, 1], [1, 3]]", "[[2, 1], [1, 3e40]]", "H[1][1]", "must not exceed 1e+30"},
                    BadCase{"\"b_theta\": [4]", "\"b_theta\": [1e31]", "b_theta[0]", "must not exceed 1e+30"},
                    BadCase{"\"lb\": [-1]", "\"lb\": []", "lb", "must not be empty"},
                    BadCase{"\"lb\": [-1]", "\"lb\": [2]", "lb", "below ub, entry 0"},
                    BadCase{"\"lb\": [-1]", "\"lb\": [-1, -1]", "ub", "2 numbers, got 1"},
                    BadCase{"\"eq_ids\": [2]", "\"eq_ids\": [3]", "eq_ids", "from 0 to 2"},
                    BadCase{"\"eq_ids\": [2]", "\"eq_ids\": [-1]", "eq_ids", "from 0 to 2"},
                    BadCase{"\"eq_ids\": [2]", "\"eq_ids\": [1.5]", "eq_ids", "whole numbers"},
                    BadCase{"\"eq_ids\": [2]", "\"eq_ids\": [2, 2]", "eq_ids", "must not repeat 2"},
                    BadCase{"\"out\": [1]", "\"out\": [2]", "out", "from 0 to 1"},
                    BadCase{"\"out\": [1]", "\"out\": []", "out", "must not be empty"},
                    BadCase{"\"b_theta\": [4]", "\"b_theta\": [4, 5]", "b_theta", "1 numbers, got 2"},
                    BadCase{", \"b_theta\": [4]", "", "b_theta", "missing"},
                    BadCase{"\"n\": 2", "\"n\": 3", "n", "must be 2"},
                    BadCase{"\"n_theta\": 1", "\"n_theta\": 2", "n_theta", "must be 1"},
                    BadCase{"\"name\": \"tiny\"", "\"name\": 3", "name", "must be text"},
                    BadCase{"\"n\": 2", "\"n\": 2, \"n\": 2", "n", "duplicate key"}));

TEST(ProgramJson, KeysThatBeginWithAnUnderscoreAreFree) {
  const std::string text =
      replaced(kBase, "\"tags\": [\"ignored\"]", "\"_made_by\": \"hand\", \"_\": {\"H\": 1}");
  EXPECT_EQ(parseProgramJson(text, "tiny.json").rowCount(), 3);
}

TEST(BadProgramFile, MalformedMissingDirectoryEmpty) {
  const std::string broken = replaced(kBase, "[8, 9, 10]", "[8, 9 10]");
  const std::string message = errorOf([&] { parseProgramJson(broken, "tiny.json"); });
  EXPECT_EQ(message.find("tiny.json:4: file: is not valid JSON: column "), 0u) << message;
  EXPECT_NE(message.find(" has what does not belong there"), std::string::npos) << message;
  EXPECT_EQ(errorOf([] { parseProgramJson("{\n \"H\": x}", "tiny.json"); }),
            "tiny.json:2: file: is not valid JSON: column 7 has what does not belong there");
  EXPECT_EQ(errorOf([] { parseProgramJson("{\"H\": [1", "tiny.json"); }),
            "tiny.json:1: file: is not valid JSON: column 8 ends too early");
  EXPECT_EQ(errorOf([] { parseProgramJson("[1e999]", "tiny.json"); }),
            "tiny.json: file: is not valid JSON: a number is beyond the range of doubles");
  EXPECT_EQ(errorOf([] { parseProgramJson("", "tiny.json"); }).find("tiny.json:1: file: "), 0u);
  EXPECT_EQ(errorOf([] { parseProgramJson("[1]", "tiny.json"); }), "tiny.json: file: must be an object");
  EXPECT_EQ(errorOf([] { loadProgramJson("no/such.json"); }).find("no/such.json: file: cannot be opened: "),
            0u);
  EXPECT_EQ(errorOf([] { loadProgramJson(projectRoot()); }),
            projectRoot() + ": file: must not be a directory");
}

TEST(BadProgramFile, NeverCausesAnotherException) {
  const std::string base = kBase;
  const std::string pieces = "[]{}:,-\"\n 0.e1\xff";
  std::mt19937 generator(1);
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::string text = base;
    text.replace(generator() % text.size(), generator() % 4, 1, pieces[generator() % pieces.size()]);
    try {
      parseProgramJson(text, "tiny.json");
    } catch (const Error& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).find("tiny.json:"), 0u) << error.what();
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(ProgramJson, ReferenceSamplesAreOptimalForTheProgramRead) {
  // KKT conditions at the stored solutions: a transposed or misnamed matrix would not satisfy them.
  const std::vector<std::string> names = {"bemporad2002", "di_N5", "di_N5_xf0_eq", "multirotor_N5",
                                          "rnd_n5_m40_t3"};
  int checked = 0;
  for (const std::string& name : names) {
    const std::string path = referenceData("mp_problems/" + name + ".json");
    if (path.empty()) GTEST_SKIP() << "the reference data are absent";
    const ParametricProgram program = loadProgram(path);
    EXPECT_EQ(program.name, name);
    const nlohmann::json file = nlohmann::json::parse(fileText(path));
    for (const nlohmann::json& sample : file.at("samples")) {
      if (!sample.at("feasible").get<bool>() || sample.at("kkt").get<double>() > 1e-8) continue;
      const auto read = [&](const char* key) {
        const auto values = sample.at(key).get<std::vector<double>>();
        return Eigen::VectorXd(
            Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
      };
      const Eigen::VectorXd theta = read("theta");
      const Eigen::VectorXd z = read("z");
      const Eigen::VectorXd slack = program.b + program.S * theta - program.A * z;
      const double size = 1.0 + maxAbs(program.b);
      EXPECT_GT(slack.minCoeff(), -1e-7 * size);
      for (const int row : program.equalities) EXPECT_NEAR(slack(row), 0.0, 1e-7 * size);
      const Eigen::VectorXd gradient = program.H * z + program.f + program.F * theta;
      const double objective = 0.5 * z.dot(program.H * z) + (program.f + program.F * theta).dot(z);
      EXPECT_NEAR(objective, sample.at("obj").get<double>(), 1e-7 * (1.0 + std::abs(objective)));
      EXPECT_LT(maxAbs(program.E * z + program.C * theta + program.c - read("u")), 1e-12);
      // No feasible direction within the active rows descends: the gradient lies in their span.
      auto active = sample.at("active").get<std::vector<int>>();
      active.insert(active.end(), program.equalities.begin(), program.equalities.end());
      Eigen::MatrixXd rows(static_cast<Eigen::Index>(active.size()), program.variableCount());
      for (std::size_t i = 0; i < active.size(); ++i)
        rows.row(static_cast<Eigen::Index>(i)) = program.A.row(active[i]);
      Eigen::VectorXd residual = gradient;
      if (rows.rows() > 0) {
        const Eigen::MatrixXd normal = rows * rows.transpose();
        residual -= rows.transpose() * normal.fullPivLu().solve(rows * gradient);
      }
      EXPECT_LT(maxAbs(residual), 1e-6 * (1.0 + maxAbs(gradient))) << name;
      ++checked;
    }
  }
  EXPECT_GT(checked, 100);
}

ParametricProgram tiny() { return parseProgramJson(kBase, "tiny.json"); }

TEST(CheckProgram, AcceptsAGoodOne) { EXPECT_NO_THROW(checkProgram(tiny())); }

/// checkProgram must complain `tiny: field: ...rule...` after `change`.
template <typename Change>
void expectRefused(const Change& change, const std::string& field, const std::string& rule) {
  ParametricProgram program = tiny();
  change(&program);
  const std::string message = errorOf([&] { checkProgram(program); });
  EXPECT_EQ(message.find("tiny: " + field + ": "), 0u) << message;
  EXPECT_NE(message.find(rule), std::string::npos) << message;
}

TEST(CheckProgram, RefusesWrongSizes) {
  using Program = ParametricProgram;
  expectRefused([](Program* p) { p->H.resize(0, 0); }, "H", "must not be empty");
  expectRefused([](Program* p) { p->H = Eigen::MatrixXd::Zero(2, 3); }, "H", "must be 2 x 2, got 2 x 3");
  expectRefused([](Program* p) { p->f = Eigen::VectorXd::Zero(3); }, "f", "must be 2 x 1, got 3 x 1");
  expectRefused([](Program* p) { p->F = Eigen::MatrixXd::Zero(2, 2); }, "F", "must be 2 x 1");
  expectRefused([](Program* p) { p->A = Eigen::MatrixXd::Zero(3, 3); }, "A", "must be 3 x 2");
  expectRefused([](Program* p) { p->b = Eigen::VectorXd::Zero(2); }, "b", "must be 3 x 1");
  expectRefused([](Program* p) { p->S = Eigen::MatrixXd::Zero(3, 2); }, "S", "must be 3 x 1");
  expectRefused([](Program* p) { p->A_theta = Eigen::MatrixXd::Zero(1, 2); }, "A_theta", "must be 1 x 1");
  expectRefused([](Program* p) { p->b_theta = Eigen::VectorXd::Zero(2); }, "b_theta", "must be 1 x 1");
  expectRefused([](Program* p) { p->E = Eigen::MatrixXd::Zero(1, 3); }, "E", "must be 1 x 2");
  expectRefused([](Program* p) { p->C = Eigen::MatrixXd::Zero(2, 1); }, "C", "must be 1 x 1");
  expectRefused([](Program* p) { p->c = Eigen::VectorXd::Zero(2); }, "c", "must be 1 x 1");
  expectRefused([](Program* p) { p->parameters.clear(); }, "parameters", "must not be empty");
  expectRefused([](Program* p) { p->inputs.clear(); }, "inputs", "must not be empty");
}

TEST(CheckProgram, RefusesWrongValues) {
  using Program = ParametricProgram;
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  expectRefused([&](Program* p) { p->H(0, 0) = nan; }, "H", "finite");
  expectRefused([&](Program* p) { p->b(1) = infinity; }, "b", "finite");
  expectRefused([&](Program* p) { p->c(0) = nan; }, "c", "finite");
  expectRefused([](Program* p) { p->H(0, 1) = 0.5; }, "H", "symmetric");
  expectRefused([](Program* p) { p->H(0, 0) = -1.0; }, "H", "semidefinite");
  expectRefused([](Program* p) { p->equalities = {3}; }, "equalities", "got 3");
  expectRefused([](Program* p) { p->equalities = {-1}; }, "equalities", "got -1");
  expectRefused([](Program* p) { p->equalities = {1, 1}; }, "equalities", "repeat");
  expectRefused([](Program* p) { p->parameters[0].upper = -1.0; }, "parameters.theta_0", "below");
  expectRefused([&](Program* p) { p->parameters[0].upper = infinity; }, "parameters.theta_0", "bounded");
  expectRefused([&](Program* p) { p->parameters[0].lower = nan; }, "parameters.theta_0", "bounded");
  expectRefused([](Program* p) { p->inputs[0].upper = p->inputs[0].lower; }, "inputs.u_0", "below");
  expectRefused([](Program* p) { p->period = -1.0; }, "period", "0 or more");
}

}  // namespace
