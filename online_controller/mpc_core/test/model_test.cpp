// Discretisation, Riccati equation and steady state, against series, iteration and integration.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "mpc_core/mpc_problem.hpp"
#include "support.hpp"

namespace {

using namespace polyfly;
using namespace polyfly_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kCases = 50;

MatrixXd randomMatrix(std::mt19937* generator, Eigen::Index rows, Eigen::Index cols) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(*generator); });
}

MpcProblem randomProblem(std::mt19937* generator, Eigen::Index nx, Eigen::Index nu, Eigen::Index nd) {
  MpcProblem problem;
  problem.A_c = randomMatrix(generator, nx, nx);
  problem.B_c = randomMatrix(generator, nx, nu);
  problem.Bd_c = randomMatrix(generator, nx, nd);
  return problem;
}

TEST(Discretise, EqualsTheExponentialSeries) {
  std::mt19937 generator(1);
  for (int i = 0; i < kCases; ++i) {
    const Eigen::Index nx = 1 + i % 4;
    const Eigen::Index nu = 1 + i % 2;
    const Eigen::Index nd = i % 3;
    const MpcProblem problem = randomProblem(&generator, nx, nu, nd);
    const double period = 0.01 + 0.05 * (i % 10);
    const DiscreteModel model = discretise(problem, period);
    MatrixXd augmented = MatrixXd::Zero(nx + nu + nd, nx + nu + nd);
    augmented.topRows(nx) << problem.A_c, problem.B_c, problem.Bd_c;
    const MatrixXd oracle = exponentialSeries(augmented * period);
    EXPECT_LT(maxAbs(model.A - oracle.topLeftCorner(nx, nx)), 1e-12);
    EXPECT_LT(maxAbs(model.B - oracle.block(0, nx, nx, nu)), 1e-12);
    EXPECT_LT(maxAbs(model.Bd - oracle.block(0, nx + nu, nx, nd)), 1e-12);
    EXPECT_EQ(model.period, period);
  }
}

TEST(Discretise, EqualsFineIntegrationUnderHeldInput) {
  const MpcProblem problem = loadProblem(problemFile("multirotor_lateral.yaml"));
  const DiscreteModel model = discretise(problem, 0.1);
  const VectorXd start = (VectorXd(3) << 0.3, -1.1, 0.2).finished();
  const VectorXd u = VectorXd::Constant(1, -0.31);
  const VectorXd d = VectorXd::Constant(1, 0.7);
  const auto rate = [&](const VectorXd& x) {
    return VectorXd(problem.A_c * x + problem.B_c * u + problem.Bd_c * d);
  };
  constexpr int kSteps = 2000;
  const double h = 0.1 / kSteps;
  VectorXd x = start;
  for (int i = 0; i < kSteps; ++i) {
    const VectorXd k1 = rate(x);
    const VectorXd k2 = rate(x + 0.5 * h * k1);
    const VectorXd k3 = rate(x + 0.5 * h * k2);
    const VectorXd k4 = rate(x + h * k3);
    x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  EXPECT_LT(maxAbs(model.A * start + model.B * u + model.Bd * d - x), 1e-12);
}

TEST(Discretise, OfADoubleIntegratorIsExact) {
  const DiscreteModel model = discretise(loadProblem(problemFile("multirotor_vertical.yaml")), 0.1);
  EXPECT_LT(maxAbs(model.A - (MatrixXd(2, 2) << 1, 0.1, 0, 1).finished()), 1e-15);
  EXPECT_LT(maxAbs(model.B - (MatrixXd(2, 1) << 0.005, 0.1).finished()), 1e-15);
}

TEST(DiscreteModels, AreTakenAsTheyAreAndGoBackToContinuousTime) {
  std::mt19937 generator(7);
  for (int i = 0; i < kCases; ++i) {
    MpcProblem continuous = randomProblem(&generator, 1 + i % 4, 1 + i % 2, i % 3);
    continuous.sampling_time = 0.05 + 0.02 * (i % 10);
    const DiscreteModel model = discretise(continuous, continuous.sampling_time);
    MpcProblem problem = continuous;
    problem.discrete = true;
    problem.A_c = model.A;
    problem.B_c = model.B;
    problem.Bd_c = model.Bd;
    EXPECT_EQ(discretise(problem, problem.sampling_time).A, model.A);
    EXPECT_EQ(discretise(problem, problem.sampling_time).B, model.B);
    const MpcProblem back = continuousModel(problem);
    EXPECT_FALSE(back.discrete);
    EXPECT_LT(maxAbs(back.A_c - continuous.A_c), 1e-9);
    EXPECT_LT(maxAbs(back.B_c - continuous.B_c), 1e-9);
    EXPECT_LT(maxAbs(back.Bd_c - continuous.Bd_c), 1e-9);
    EXPECT_LT(maxAbs(discretise(problem, 0.02).A - discretise(continuous, 0.02).A), 1e-10);
  }
}

TEST(DiscreteModels, WithoutAContinuousCounterpartServeTheirOwnPeriodOnly) {
  MpcProblem problem;
  problem.source = "delay.yaml";
  problem.discrete = true;
  problem.sampling_time = 0.1;
  problem.B_c = MatrixXd::Ones(2, 1);
  problem.Bd_c = MatrixXd::Zero(2, 0);
  for (const double corner : {0.0, -0.5}) {
    problem.A_c = (MatrixXd(2, 2) << 1.0, 0.3, 0.0, corner).finished();
    EXPECT_EQ(discretise(problem, 0.1).A, problem.A_c);
    const std::string message = errorOf([&] { discretise(problem, 0.05); });
    EXPECT_NE(message.find("delay.yaml: model.A: must have no eigenvalue that is 0 or negative"),
              std::string::npos)
        << message;
  }
}

TEST(Discretise, RefusesAPeriodThatIsNotPositive) {
  const MpcProblem problem = loadProblem(problemFile("multirotor_vertical.yaml"));
  EXPECT_THROW(discretise(problem, 0.0), Error);
  EXPECT_THROW(discretise(problem, std::nan("")), Error);
}

double riccatiResidual(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Q, const MatrixXd& R,
                       const MatrixXd& P) {
  const MatrixXd inner = (R + B.transpose() * P * B).inverse();
  return maxAbs(P - (A.transpose() * P * A - A.transpose() * P * B * inner * B.transpose() * P * A + Q)) /
         maxAbs(P);
}

double closedLoopRadius(const MatrixXd& A, const MatrixXd& B, const MatrixXd& R, const MatrixXd& P) {
  const MatrixXd K = (R + B.transpose() * P * B).inverse() * B.transpose() * P * A;
  return spectralRadius(A - B * K);
}

TEST(Riccati, SolvesTheEquationAndStabilises) {
  std::mt19937 generator(2);
  for (int i = 0; i < kCases; ++i) {
    const Eigen::Index nx = 1 + i % 5;
    const Eigen::Index nu = 1 + i % 3;
    const MatrixXd A = randomMatrix(&generator, nx, nx);
    const MatrixXd B = randomMatrix(&generator, nx, nu);
    const MatrixXd root = randomMatrix(&generator, nx, nx);
    const MatrixXd Q = root.transpose() * root;
    const MatrixXd R = MatrixXd::Identity(nu, nu) * (0.1 + 0.1 * (i % 7));
    const MatrixXd P = solveRiccati(A, B, Q, R);
    EXPECT_LT(riccatiResidual(A, B, Q, R, P), 1e-9);
    EXPECT_LT(closedLoopRadius(A, B, R, P), 1.0);
    EXPECT_EQ(maxAbs(P - P.transpose()), 0.0);
  }
}

TEST(Riccati, EqualsTheLimitOfTheRecursion) {
  const MpcProblem problem = loadProblem(problemFile("multirotor_longitudinal.yaml"));
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  MatrixXd P = problem.Q;
  for (int i = 0; i < 20000; ++i) {
    const MatrixXd K =
        (problem.R + model.B.transpose() * P * model.B).inverse() * model.B.transpose() * P * model.A;
    P = (problem.Q + model.A.transpose() * P * (model.A - model.B * K)).eval();
  }
  const MatrixXd solved = solveRiccati(model.A, model.B, problem.Q, problem.R);
  EXPECT_LT(maxAbs(solved - P) / maxAbs(P), 1e-11);
}

TEST(Riccati, OfAScalarIsTheRootOfItsQuadratic) {
  // a = 2, b = q = r = 1: P^2 - 4 P - 1 = 0.
  const MatrixXd one = MatrixXd::Ones(1, 1);
  EXPECT_NEAR(solveRiccati(2.0 * one, one, one, one)(0, 0), 2.0 + std::sqrt(5.0), 1e-13);
}

TEST(Riccati, RefusesWhatHasNoStabilisingSolution) {
  const MatrixXd one = MatrixXd::Ones(1, 1);
  const MatrixXd zero = MatrixXd::Zero(1, 1);
  EXPECT_THROW(solveRiccati(2.0 * one, zero, one, one), Error);  // unstable and out of reach
  EXPECT_THROW(solveRiccati(one, zero, one, one), Error);        // an integrator out of reach
  EXPECT_THROW(solveRiccati(one, one, zero, one), Error);        // an integrator without weight
  EXPECT_THROW(solveRiccati(2.0 * one, one, zero, one), Error);  // unstable without weight
  EXPECT_THROW(solveRiccati(one, one, MatrixXd::Ones(2, 2), one), Error);
  EXPECT_THROW(solveRiccati(one * std::nan(""), one, one, one), Error);
}

TEST(SteadyStateTarget, HoldsTheOutputUnderTheDisturbance) {
  std::mt19937 generator(3);
  for (int i = 0; i < kCases; ++i) {
    const Eigen::Index nx = 2 + i % 3;
    const Eigen::Index nu = 1 + i % 2;
    const MpcProblem problem = randomProblem(&generator, nx, nu, 2);
    const DiscreteModel model = discretise(problem, 0.1);
    const MatrixXd C = randomMatrix(&generator, nu, nx);
    const VectorXd d = randomMatrix(&generator, 2, 1);
    const VectorXd r = randomMatrix(&generator, nu, 1);
    const SteadyState steady = steadyState(model, C, d, r);
    const double size = 1.0 + maxAbs(steady.x) + maxAbs(steady.u);
    EXPECT_LT(maxAbs(model.A * steady.x + model.B * steady.u + model.Bd * d - steady.x) / size, 1e-9);
    EXPECT_LT(maxAbs(C * steady.x - r) / size, 1e-9);
  }
}

TEST(SteadyStateTarget, OfTheLateralAxisTiltsIntoTheWind) {
  const MpcProblem problem = loadProblem(problemFile("multirotor_lateral.yaml"));
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  const SteadyState steady =
      steadyState(model, problem.C, VectorXd::Constant(1, 1.5), VectorXd::Constant(1, 4.0));
  EXPECT_NEAR(steady.x(0), 4.0, 1e-12);
  EXPECT_NEAR(steady.x(1), 0.0, 1e-12);
  EXPECT_NEAR(steady.x(2), 1.5 / 9.8066, 1e-12);  // 0 = -g phi + d
  EXPECT_NEAR(steady.u(0), 1.5 / 9.8066 / 0.9, 1e-12);
}

TEST(SteadyStateTarget, DoesNotDependOnUnits) {
  const MpcProblem problem = loadProblem(problemFile("multirotor_lateral.yaml"));
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  const VectorXd d = VectorXd::Constant(1, 1.5), r = VectorXd::Constant(1, 4.0);
  const SteadyState steady = steadyState(model, problem.C, d, r);
  const Eigen::Vector3d units(1e9, 1e-10, 1e4);
  constexpr double kInputUnit = 1e-9;
  DiscreteModel other = model;
  other.A = units.asDiagonal() * model.A * units.cwiseInverse().asDiagonal();
  other.B = units.asDiagonal() * model.B / kInputUnit;
  other.Bd = units.asDiagonal() * model.Bd;
  const SteadyState scaled = steadyState(other, problem.C * units.cwiseInverse().asDiagonal(), d, r);
  EXPECT_LT(maxAbs(units.cwiseInverse().cwiseProduct(scaled.x) - steady.x), 1e-12);
  EXPECT_NEAR(scaled.u(0) / kInputUnit, steady.u(0), 1e-12);
}

TEST(SteadyStateTarget, RefusesASingularSystemAndWrongSizes) {
  const MpcProblem problem = loadProblem(problemFile("multirotor_vertical.yaml"));
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  const VectorXd one = VectorXd::Ones(1);
  EXPECT_THROW(steadyState(model, (MatrixXd(1, 2) << 0, 1).finished(), one, one), Error);
  EXPECT_THROW(steadyState(model, problem.C, VectorXd::Ones(2), one), Error);
  EXPECT_THROW(steadyState(model, MatrixXd::Identity(2, 2), one, VectorXd::Ones(2)), Error);
}

}  // namespace
