// H that is positive definite is solved however great its condition is. One that is singular is refused, decided exactly.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "error_of.hpp"
#include "mpc_core/online_program.hpp"
#include "mutation.hpp"
#include "random_program.hpp"

namespace polyfly {
namespace {

ParametricProgram parsed(const std::string& text) { return parseProgramJson(text, "test.json"); }

std::string errorOfExploring(const ParametricProgram& program) {
  return errorOf([&] { explore(program); });
}

/// The map's answer, which is proven and confirmed, and that of the online solver.
void expectAnswer(const ParametricProgram& program, const Eigen::VectorXd& theta,
                  const Eigen::VectorXd& expected) {
  proven(program);
  const MapInMemory map(solved(program));
  Eigen::VectorXd u(program.inputCount());
  ASSERT_EQ(map.map().evaluate(theta.data(), u.data()).status, LookupStatus::kInside);
  EXPECT_LT((u - expected).cwiseAbs().maxCoeff(), 1e-9) << u.transpose();
  if (!program.equalities.empty()) return;
  OnlineProgram online(program);
  u.setZero();
  ASSERT_EQ(online.solve(theta.data(), u.data()), QpStatus::kOptimal);
  EXPECT_LT((u - expected).cwiseAbs().maxCoeff(), 1e-8) << "online " << u.transpose();
}

// z_i = -theta_i, cut to [-1, 1].
TEST(DefiniteHessian, OfTwoVariablesInVeryDifferentUnits) {
  for (int k = 1; k <= 20; ++k) {
    ParametricProgram program = parsed(
        R"({"H": [[1, 0], [0, 1]], "f": [0, 0], "F": [[1, 0], [0, 1]], "A": [[1, 0], [-1, 0], [0, 1], [0, -1]],
            "b": [1, 1, 1, 1], "B": [[0, 0], [0, 0], [0, 0], [0, 0]], "lb": [-2, -2], "ub": [2, 2], "out": [0, 1]})");
    program.H(1, 1) = program.F(1, 1) = std::pow(10.0, -k);
    expectAnswer(program, Eigen::Vector2d(0.3, 0.4), Eigen::Vector2d(-0.3, -0.4));
    expectAnswer(program, Eigen::Vector2d(0.3, 1.5), Eigen::Vector2d(-0.3, -1.0));
  }
}

// The determinant is 3000000000002, and z_0 = -(2e12 + 1) / 3000000000002 theta.
TEST(DefiniteHessian, OfWholeNumbersWhoseDifferencesDecide) {
  const ParametricProgram program = parsed(
      R"({"H": [[1000000000002, 1000000000000], [1000000000000, 1000000000001]], "f": [0, 0],
          "F": [[1000000000001], [1000000000000]], "A": [[1, 0], [-1, 0], [0, 1], [0, -1]], "b": [2, 2, 2, 2],
          "B": [[0], [0], [0], [0]], "lb": [-1], "ub": [1], "out": [0]})");
  expectAnswer(program, Eigen::VectorXd::Ones(1),
               Eigen::VectorXd::Constant(1, -2000000000001.0 / 3000000000002.0));
}

// Its least eigenvalue is 2^-53.
TEST(DefiniteHessian, ByTheLastBit) {
  ParametricProgram program = parsed(
      R"({"H": [[1, 1], [1, 1]], "f": [0, 0], "F": [[1], [1]], "A": [[1, 0], [-1, 0], [0, 1], [0, -1]],
          "b": [2, 2, 2, 2], "B": [[0], [0], [0], [0]], "lb": [-1], "ub": [1], "out": [0, 1]})");
  EXPECT_TRUE(holds(errorOfExploring(program), "H: is singular, and not zero"));
  program.H(1, 1) += 0x1p-52;
  expectAnswer(program, Eigen::VectorXd::Ones(1), Eigen::Vector2d(-1.0, 0.0));
}

TEST(SingularHessian, IsJudgedWhereTheEqualitiesLeaveZFree) {
  ParametricProgram program = parsed(
      R"({"H": [[1, 0], [0, 0]], "f": [0, 0], "F": [[1], [0]], "A": [[1, 0], [-1, 0], [0, 1], [0, -1], [0, 1]],
          "b": [2, 2, 2, 2, 0], "B": [[0], [0], [0], [0], [1]], "lb": [-1], "ub": [1], "out": [0, 1], "eq_ids": [4]})");
  expectAnswer(program, Eigen::VectorXd::Constant(1, 0.5), Eigen::Vector2d(-0.5, 0.5));
  program.A.row(4) << 1, 0;
  EXPECT_TRUE(holds(errorOfExploring(program), "H: is singular where the equalities leave z free"));
  program.A.row(4) << 0, 1;
  program.H(0, 0) = -1e-13;
  EXPECT_NE(errorOfExploring(program), "no error");
}

// Rows that say 0 = 0, and one that says something.
TEST(EqualitiesThatSayNothing, AreNoneInSolutionAndProof) {
  for (int zeros = 1; zeros <= 3; ++zeros) {
    ParametricProgram program = parsed(
        R"({"H": [[1, 0], [0, 1]], "f": [0, 0], "F": [[1], [0]], "A": [[1, 0], [-1, 0], [1, -1]],
            "b": [1, 1, 0], "B": [[0], [0], [0]], "lb": [-3], "ub": [3], "out": [0, 1]})");
    for (const bool tied : {false, true}) {
      ParametricProgram zero = program;
      if (tied) zero.equalities = {2};
      for (int k = 0; k < zeros; ++k) {
        zero.equalities.push_back(zero.rowCount());
        appendRow(zero, Eigen::Vector2d::Zero(), 0.0, Eigen::VectorXd::Zero(1));
      }
      if (!tied) expectAnswer(zero, Eigen::VectorXd::Constant(1, 0.5), Eigen::Vector2d(-0.5, 0.0));
      // z_0 = z_1 = -theta / 2
      if (tied) expectAnswer(zero, Eigen::VectorXd::Constant(1, 0.5), Eigen::Vector2d(-0.25, -0.25));
    }
  }
}

}  // namespace
}  // namespace polyfly
