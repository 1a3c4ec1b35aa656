// check_problem: the program of a certificate against the problem file, by arithmetic of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "holds.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/read_text.hpp"
#include "problem/program_match.hpp"
#include "problem/signals.hpp"
#include "program_matrices.hpp"
#include "project_root.hpp"
#include "refusal_of.hpp"

namespace polyfly {
namespace {

using checker::Ball;
using checker::BallMatrix;

const mpq_class kTolerance(1, 1000000000000);

/// Empty: the program is that of the problem. Else why it is not.
std::string refusal(const checker::Matrices& program, const std::string& problem_text,
                    const std::set<std::size_t>& equalities = {}) {
  return refusalOf([&] {
    const checker::TrackingProblem problem = checker::readTrackingProblem(problem_text);
    checker::matchProgram(program, equalities, problem, kTolerance);
  });
}

/// A problem of two inputs and three states, with numbers that depend on the seed; every key of the schema occurs.
std::string madeProblem(unsigned seed, int horizon = 4) {
  std::mt19937 random(seed);
  const auto number = [&](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  const auto row = [&](double a, double b, double c) {
    std::ostringstream text;
    text.precision(17);
    text << "[" << a << ", " << b << ", " << c << "]";
    return text.str();
  };
  std::ostringstream text;
  text.precision(17);
  text << "polyfly_problem: 1\nname: made\ntype: tracking_mpc\nmodel:\n"
       << "  states:\n    - {name: x1, unit: m, range: [-4, 3]}\n    - {name: x2, unit: m/s}\n"
       << "    - {name: x3, unit: rad, range: [-1, 1]}\n"
       << "  inputs:\n    - {name: u1, unit: rad, range: [-0.5, 0.4]}\n    - {name: u2, unit: N, range: [-2, "
          "2]}\n"
       << "  A:\n    - " << row(0, 1, number(-0.3, 0.3)) << "\n    - "
       << row(0, number(-1, 0.2), number(-9, 9)) << "\n    - " << row(number(-0.2, 0.2), 0, number(-5, -1))
       << "\n"
       << "  B:\n    - [0, " << number(0.5, 1) << "]\n    - [" << number(-0.2, 0.2) << ", " << number(0.1, 1)
       << "]\n    - [" << number(2, 5) << ", 0]\n"
       << "  C:\n    - [1, 0, 0]\n    - [0, 1, 0]\n"
       << "sampling_time: " << number(0.05, 0.3) << "\nhorizon: " << horizon << "\nweights:\n"
       << "  Q: [" << number(1, 50) << ", " << number(1, 20) << ", " << number(0.1, 5) << "]\n"
       << "  R:\n    - [" << number(5, 9) << ", 0.5]\n    - [0.5, " << number(1, 4) << "]\n"
       << "  R_delta: [" << number(0, 1) << ", 0.3]\n"
       << "parameters:\n"
       << "  - {name: e1, role: error, of: x1, unit: m, range: [-3, 3]}\n"
       << "  - {name: r1, role: input_reference, of: u1, unit: rad, range: [-0.2, 0.25]}\n"
       << "  - {name: e2, role: error, of: x2, unit: m/s, range: [-3, 3]}\n"
       << "  - {name: e3, role: error, of: x3, unit: rad, range: [-0.5, 0.6]}\n"
       << "  - {name: before2, role: previous_input, of: u2, unit: N, range: [-2, 2]}\n";
  return text.str();
}

TEST(ProblemChecker, ConfirmsWhatCondenseMakes) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::string text = madeProblem(seed, 1 + static_cast<int>(seed) % 6);
    EXPECT_EQ(refusal(matricesOf(condense(parseProblem(text, "made"))), text), "") << seed;
  }
}

/// The same with what a problem file may state besides.
std::string fullProblem(unsigned seed) {
  std::string text = madeProblem(seed, 5);
  const auto change = [&](const std::string& from, const std::string& to) {
    text = replaced(text, from, to);
  };
  const bool discrete = seed % 2 == 1;
  change("model:\n", discrete ? "model:\n  time: discrete\n" : "model:\n  delay: 0.03\n");
  change("range: [-2, 2]}\n", "range: [-2, 2], change: [-0.7, 0.9]}\n");
  change("  A:\n",
         "  disturbances:\n    - {name: d1, unit: m}\n  B_d:\n    - [0.1]\n    - [1]\n    - [-0.3]\n  A:\n");
  change("horizon: 5\n",
         seed % 3 == 0 ? "horizon: 5\nmoves: [1, 2, 2]\n" : "horizon: 5\ncontrol_horizon: 3\n");
  change("parameters:\n", R"(  terminal:
    - [30, 1, 0]
    - [1, 20, 0.5]
    - [0, 0.5, 9]
terminal_set:
  T:
    - [1, 0.5, 0]
    - [-1, 0, 0.25]
  t: [2, 1.5]
constraints:
  - {of: x2, range: [-2.5, 2], soft: {linear: 40, quadratic: 3}}
  - {of: x3, upper: 0.8, soft: {quadratic: 3, slack: horizon}, measured_from: reference}
  - {name: sum, of: {u1: 1, x2: -0.05}, unit: rad, range: [-0.6, 0.45], soft: {linear: 2, quadratic: 1, slack: horizon}}
  - {name: hard, of: {u2: 1, u1: 0.5}, unit: N, lower: -2.2, measured_from: reference}
parameters:
)");
  if (seed % 4 < 2) {
    text += R"(  - {name: x1_ref, role: state_reference, of: x1, unit: m, value: 0.5}
  - {name: x2_ref, role: state_reference, of: x2, unit: m/s, range: [-1, 1]}
  - {name: x3_ref, role: state_reference, of: x3, unit: rad, value: 0}
  - {name: d, role: disturbance, of: d1, unit: m, range: [-0.1, 0.2]}
)";
    return text;
  }
  for (const char* state : {"x1", "x2", "x3"})
    change(std::string("role: error, of: ") + state, std::string("role: state, of: ") + state);
  change("  - {name: r1, role: input_reference, of: u1, unit: rad, range: [-0.2, 0.25]}\n", "");
  return text + R"(  - {name: r_x1, role: reference, of: x1, unit: m, range: [-1, 1]}
  - {name: r_x2, role: reference, of: x2, unit: m/s, value: 0.3}
  - {name: d, role: disturbance, of: d1, unit: m, value: 0.05}
)";
}

TEST(ProblemChecker, ConfirmsConstraintsAndRoles) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const std::string text = fullProblem(seed);
    EXPECT_EQ(refusal(matricesOf(condense(parseProblem(text, "made"))), text), "") << seed;
  }
}

TEST(ProblemChecker, RefusesOtherConstraints) {
  const std::string text = fullProblem(2);
  const checker::Matrices program = matricesOf(condense(parseProblem(text, "made")));
  ASSERT_EQ(refusal(program, text), "");
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"linear: 40", "linear: 41"},
                                                        {"quadratic: 3}", "quadratic: 3.1}"},
                                                        {"slack: horizon", "slack: stage"},
                                                        {"upper: 0.8", "lower: -0.8"},
                                                        {"-0.7, 0.9", "-0.7, 0.91"},
                                                        {"x2: -0.05", "x2: 0.05"},
                                                        {"t: [2, 1.5]", "t: [2, 1.6]"},
                                                        {"[30, 1, 0]", "[31, 1, 0]"},
                                                        {"value: 0.05", "value: 0.06"},
                                                        {", measured_from: reference", ""},
                                                        {"control_horizon: 3", "control_horizon: 4"}}) {
    EXPECT_NE(refusal(program, replaced(text, from, to)), "") << from;
  }
}

/// A plant that is unstable enough for the prediction beside a feedback.
std::string unstableProblem(unsigned seed, const std::string& terminal) {
  std::string text = fullProblem(seed);
  const auto change = [&](const std::string& from, const std::string& to) {
    text = replaced(text, from, to);
  };
  change("time: discrete\n", "time: continuous\n");
  change("horizon: 5\n" + text.substr(text.find("horizon: 5\n") + 11,
                                      text.find("weights:") - text.find("horizon: 5\n") - 11),
         "horizon: 7\n");
  change("  A:\n    - [0, 1,", "  A:\n    - [12, 1,");
  if (terminal == "equality") {
    const std::size_t at = text.find("  terminal:\n");
    text.replace(at, text.find("constraints:") - at, "  terminal: equality\n");
  }
  return text;
}

std::set<std::size_t> equalitiesOf(const ParametricProgram& program) {
  return {program.equalities.begin(), program.equalities.end()};
}

TEST(ProblemChecker, ConfirmsThePredictionBesideAFeedback) {
  for (unsigned seed = 1; seed < 8; seed += 2) {
    for (const std::string terminal : {"given", "equality"}) {
      const std::string text = unstableProblem(seed, terminal);
      const ParametricProgram program = condense(parseProblem(text, "made"));
      const checker::Matrices right = matricesOf(program);
      const std::set<std::size_t> equalities = equalitiesOf(program);
      EXPECT_EQ(equalities.size(), terminal == "equality" ? 3u : 0u);
      ASSERT_EQ(refusal(right, text, equalities), "") << seed;
      const checker::ProgramMatch match =
          checker::matchProgram(right, equalities, checker::readTrackingProblem(text), kTolerance);
      EXPECT_EQ(match.variables, checker::Variables::kBesideFeedback);
      std::set<std::size_t> other = equalities;
      if (other.erase(*other.begin()) == 0) other.insert(0);
      EXPECT_NE(refusal(right, text, other), "");
    }
  }
}

TEST(ProblemChecker, RefusesAChangedPredictionBesideAFeedback) {
  const std::string text = unstableProblem(1, "equality");
  const ParametricProgram program = condense(parseProblem(text, "made"));
  const checker::TrackingProblem problem = checker::readTrackingProblem(text);
  const checker::ExpectedProgram expected =
      checker::expectedProgram(problem, checker::Variables::kBesideFeedback);
  const checker::Matrices right = matricesOf(program);
  const std::set<std::size_t> equalities = equalitiesOf(program);
  ASSERT_NO_THROW(checker::matchProgram(right, equalities, problem, expected, kTolerance));
  std::mt19937 random(7);
  for (const char* const name : {"H", "F", "A", "S", "b", "E", "C"}) {
    for (int tried = 0; tried < 5; ++tried) {
      const checker::Matrix& matrix = right.at(name);
      const std::size_t k = random() % matrix.entries.size();
      checker::Matrices changed = right;
      mpq_class size(1);
      for (const mpq_class& entry : matrix.entries) size = std::max(size, mpq_class(abs(entry)));
      changed.at(name).entries[k] += size / 1000000000;
      EXPECT_THROW(checker::matchProgram(changed, equalities, problem, expected, kTolerance),
                   checker::Refused)
          << name << " " << k;
    }
  }
}

/// Each nonzero number of the program matters, and so does each of the first rows.
TEST(ProblemChecker, RefusesAChangedProgram) {
  const std::string text = madeProblem(7, 2);
  const checker::Matrices right = matricesOf(condense(parseProblem(text, "made")));
  ASSERT_EQ(refusal(right, text), "");
  for (const auto& [name, matrix] : right) {
    for (std::size_t k = 0; k < matrix.entries.size(); ++k) {
      checker::Matrices changed = right;
      mpq_class& entry = changed.at(name).entries[k];
      // 1e-9 of the greatest entry of the matrix.
      mpq_class size;
      for (const mpq_class& other : matrix.entries) size = std::max(size, mpq_class(abs(other)));
      entry += (size == 0 ? mpq_class(1) : size) / 1000000000;
      EXPECT_NE(refusal(changed, text), "") << name << " " << k;
    }
  }
  checker::Matrices shorter = right;
  for (const char* name : {"A", "S", "b"}) {
    checker::Matrix& matrix = shorter.at(name);
    --matrix.rows;
    matrix.entries.resize(matrix.rows * matrix.columns);
  }
  EXPECT_NE(refusal(shorter, text), "");
}

/// Of each problem that flies, entries that are off by 1e-9 of the greatest in their row: of their own matrix, of constants
/// also of those beside it.
TEST(ProblemChecker, RefusesAChangedProgramOfEachFile) {
  const std::map<std::string, std::vector<std::string>> sizedBy = {{"box", {"box"}},
                                                                   {"H", {"H"}},
                                                                   {"F", {"F"}},
                                                                   {"f", {"F", "f"}},
                                                                   {"A", {"A"}},
                                                                   {"S", {"A", "S"}},
                                                                   {"b", {"A", "S", "b"}},
                                                                   {"A_theta", {"A_theta"}},
                                                                   {"b_theta", {"A_theta", "b_theta"}},
                                                                   {"E", {"E"}},
                                                                   {"C", {"C", "c"}},
                                                                   {"c", {"C", "c"}}};
  std::mt19937 random(5);
  for (const char* const name : {"multirotor_lateral", "multirotor_vertical", "lateral_speed_limit",
                                 "look_ahead/vertical", "look_ahead/lateral", "reference/lateral_asl"}) {
    const std::string path = problemFile(std::string(name) + ".yaml"), text = readText(path);
    const checker::TrackingProblem problem = checker::readTrackingProblem(text);
    const checker::ExpectedProgram expected = checker::expectedProgram(problem);
    const checker::Matrices right = matricesOf(condense(parseProblem(text, path)));
    ASSERT_NO_THROW(checker::matchProgram(right, {}, problem, expected, kTolerance)) << name;
    for (std::size_t tried = 0; tried < 3 * right.size(); ++tried) {
      const auto& [key, matrix] = *std::next(right.begin(), static_cast<std::ptrdiff_t>(tried / 3));
      if (matrix.entries.empty()) continue;
      const std::size_t k = random() % matrix.entries.size(), row = k / matrix.columns;
      mpq_class size;
      for (const std::string& part : sizedBy.at(key)) {
        const checker::Matrix& beside = right.at(part);
        for (std::size_t j = 0; j < beside.columns; ++j)
          size = std::max(size, mpq_class(abs(beside.at(row, j))));
      }
      checker::Matrices changed = right;
      changed.at(key).entries[k] += (size == 0 ? mpq_class(1) : size) / 1000000000;
      EXPECT_THROW(checker::matchProgram(changed, {}, problem, expected, kTolerance), checker::Refused)
          << name << " " << key << " " << k;
    }
  }
}

TEST(ProblemChecker, RefusesAnotherProblem) {
  const std::string text = madeProblem(3);
  const checker::Matrices program = matricesOf(condense(parseProblem(text, "made")));
  const auto with = [&](const std::string& from, const std::string& to) { return replaced(text, from, to); };
  EXPECT_EQ(refusal(program, text), "");
  EXPECT_NE(refusal(program, with("range: [-4, 3]", "range: [-4, 3.000001]")), "");
  EXPECT_NE(refusal(program, with("range: [-0.5, 0.4]", "range: [-0.5, 0.41]")), "");
  EXPECT_NE(refusal(program, with("horizon: 4", "horizon: 5")), "");
  for (const char* const four : {"4.0", "+4", "0.4e1"})
    EXPECT_EQ(refusal(program, with("horizon: 4", std::string("horizon: ") + four)), "") << four;
  for (const char* const other : {"04", "0x4", "0o4", "'4'", "4.5", "-4", "1e99", ".inf", "", "[4]"})
    EXPECT_NE(refusal(program, with("horizon: 4", std::string("horizon: ") + other)), "") << other;
  EXPECT_TRUE(holds(refusal(program, with("range: [-4, 3]", "range: [-04, 3]")), "leading zeros"));
  EXPECT_NE(refusal(program, with("0.5]\n    - [0.5", "0.50001]\n    - [0.50001")), "");
  EXPECT_NE(refusal(program, with("0.3]\nparameters", "0.31]\nparameters")), "");
  EXPECT_NE(refusal(program, with("range: [-0.2, 0.25]", "range: [-0.2, 0.2]")), "");
  EXPECT_NE(refusal(program, with("role: previous_input, of: u2", "role: previous_input, of: u1")), "");
  EXPECT_TRUE(holds(refusal(program, with("horizon", "look_ahead: 1\nhorizon")), "look_ahead"));
  EXPECT_TRUE(holds(refusal(program, R"({"H": [[1]]})"), "JSON"));
  EXPECT_TRUE(holds(refusal(program, "- 1"), "keys"));
  EXPECT_TRUE(holds(refusal(program, with("  Q: [", "  Q: [[")), "problem"));
}

/// exp of a nilpotent matrix is a polynomial.
TEST(ProblemChecker, DiscretisesADoubleIntegratorExactly) {
  checker::TrackingProblem problem;
  problem.A = BallMatrix(2, 2);
  problem.A.at(0, 1) = Ball(1);
  problem.B = BallMatrix(2, 1);
  problem.B.at(1, 0) = Ball(3);
  problem.B_d = BallMatrix(2, 0);
  problem.sampling_time = mpq_class(1, 10);
  const checker::DiscreteSystem system = checker::discretised(problem);
  const mpq_class tiny(mpz_class(1), mpz_class(1) << 400);
  EXPECT_LT(system.A.at(0, 1).distance(mpq_class(1, 10)), tiny);
  EXPECT_LT(system.A.at(0, 0).distance(1), tiny);
  EXPECT_LT(system.B.at(0, 0).distance(mpq_class(3, 200)), tiny);
  EXPECT_LT(system.B.at(1, 0).distance(mpq_class(3, 10)), tiny);
}

/// P = q + a^2 P - (a b P)^2 / (r + b^2 P) is quadratic in P.
TEST(ProblemChecker, SolvesAScalarRiccatiEquation) {
  for (const double a : {0.3, 1.0, 1.7}) {
    const double b = 0.4, q = 2.0, r = 0.7;
    BallMatrix A(1, 1), B(1, 1), Q(1, 1), R(1, 1);
    A.at(0, 0) = Ball(mpq_class(a));
    B.at(0, 0) = Ball(mpq_class(b));
    Q.at(0, 0) = Ball(mpq_class(q));
    R.at(0, 0) = Ball(mpq_class(r));
    const checker::TerminalWeight terminal = checker::terminalWeight({A, B, BallMatrix(1, 0)}, Q, R);
    const double half = (r - a * a * r - q * b * b) / (2.0 * b * b);
    const double P = -half + std::sqrt(half * half + q * r / (b * b));
    EXPECT_NEAR(terminal.P.greatest().get_d(), P, 1e-13 * P);
    EXPECT_LT(terminal.residual, mpq_class(mpz_class(1), mpz_class(1) << 300));
  }
}

/// Sums, products and quotients of random fractions lie within their bounds.
TEST(ProblemChecker, BallsHoldTheExactNumber) {
  std::mt19937 random(1);
  std::uniform_int_distribution<long> whole(-1000000, 1000000);
  for (int k = 0; k < 200; ++k) {
    mpq_class exact(whole(random), 1 + std::abs(whole(random)));
    exact.canonicalize();
    Ball ball(exact);
    for (int step = 0; step < 6; ++step) {
      mpq_class other(1 + std::abs(whole(random)), 1 + std::abs(whole(random)));
      other.canonicalize();
      exact = (exact + other) * other / (other + 1) - exact;
      ball = (ball + Ball(other)) * Ball(other) / Ball(other + 1) - ball;
    }
    // The distance of a ball that holds the number is at most twice its radius, which stays tiny.
    EXPECT_LT(ball.distance(exact), mpq_class(mpz_class(1), mpz_class(1) << 400));
    EXPECT_GE((ball - ball.middle()).greatest() * 2, ball.distance(exact));
  }
  EXPECT_THROW(Ball(1) / (Ball(1) - Ball(1)), checker::Refused);
}

// yaml-cpp 0.6 grows without end on the first three, and each version ends at a control character.
TEST(ProblemChecker, TextsOnWhichAParserNeverEndsAreRefused) {
  for (const char* const text : {"[a:]", "type: [b:", "{a: b, c:", "type: a\n\4odd: 1\n"})
    EXPECT_TRUE(holds(refusalOf([&] { checker::problemType(text); }), "problem: has ")) << text;
  EXPECT_EQ(checker::problemType("type: a\n"), "a");
}

}  // namespace
}  // namespace polyfly
