// Partitions of generated programs: every parameter is answered, once, by the optimal law.
#include "offline_mpt/explore.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "error_of.hpp"
#include "glpk_lp.hpp"
#include "mpc_core/dense_qp.hpp"
#include "random_program.hpp"
#include "solved_map.hpp"

namespace polyfly {
namespace {

constexpr double kInside = 1e-9;  // scaled distance within which a region holds a parameter

Eigen::VectorXd randomTheta(int p, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return Eigen::VectorXd::NullaryExpr(p, [&] { return uniform(random); });
}

/// First move of the program at theta by its own QP; false where infeasible.
bool solveAt(const ParametricProgram& program, DenseQp& qp, const Eigen::VectorXd& theta, double& u) {
  const Eigen::VectorXd g = program.f + program.F * theta;
  const Eigen::VectorXd b = program.b + program.S * theta;
  if (qp.solve(g.data(), b.data()) != QpStatus::kOptimal) return false;
  u = (program.E * qp.z() + program.C * theta + program.c)(0);
  return true;
}

struct Size {
  int n, m, p;
};

class Generated : public ::testing::TestWithParam<Size> {};

TEST_P(Generated, EveryParameterHasItsOptimalLaw) {
  const Size size = GetParam();
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const ParametricProgram program = randomProgram(size.n, size.m, size.p, seed);
    const Partition partition = explore(program);
    ASSERT_EQ(partition.status, ExploreStatus::kComplete) << program.name;
    DenseQp qp(program.H, program.A);
    std::mt19937_64 random(seed);
    for (int k = 0; k < 500; ++k) {
      const Eigen::VectorXd theta = randomTheta(size.p, random);
      double expected = 0.0;
      const bool feasible = solveAt(program, qp, theta, expected);
      const std::vector<CriticalRegion> held = holders(partition, theta);
      EXPECT_EQ(held.size(), feasible ? 1u : 0u) << program.name << " sample " << k;
      for (const CriticalRegion& region : held)
        EXPECT_NEAR((region.K * theta + region.k)(0), expected, 1e-7 * (1.0 + std::abs(expected)));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Generated,
                         ::testing::Values(Size{2, 8, 1}, Size{3, 12, 2}, Size{5, 20, 3}, Size{4, 14, 4},
                                           Size{3, 10, 5}, Size{2, 8, 6}));

TEST(Explore, RegionsAreMinimalAndTheirCentresInside) {
  const Partition partition = explore(randomProgram(5, 20, 3, 11));
  for (const CriticalRegion& region : partition.regions) {
    const Eigen::VectorXd slack = region.g - region.G * region.centre;
    EXPECT_NEAR(slack.minCoeff(), region.radius, 1e-12);
    EXPECT_GT(region.radius, 0.0);
  }
}

TEST(Explore, ThreadsDoNotChangeTheBytes) {
  const ParametricProgram program = randomProgram(8, 24, 3, 5);
  ExploreOptions options;
  const std::vector<std::byte> one = layOut(encode(program, explore(program, options)));
  for (const int threads : {2, 3, 8}) {
    options.threads = threads;
    EXPECT_EQ(layOut(encode(program, explore(program, options))), one) << threads << " threads";
  }
}

TEST(Explore, InfeasibleProgramHasNoRegion) {
  ParametricProgram program = randomProgram(2, 6, 2, 3);
  program.A.row(1) = -program.A.row(0);
  program.b(0) = program.b(1) = -1.0;
  program.S.topRows(2).setZero();
  const Partition partition = explore(program);
  EXPECT_EQ(partition.status, ExploreStatus::kInfeasible);
  EXPECT_TRUE(partition.regions.empty());
}

TEST(Explore, DuplicateAndScaledRowsChangeNothing) {
  const ParametricProgram program = randomProgram(4, 14, 2, 9);
  ParametricProgram doubled = program;
  for (int row = 0; row < program.rowCount(); ++row) appendMultiple(doubled, row, 2.5);
  EXPECT_EQ(explore(doubled).regions.size(), explore(program).regions.size());
}

TEST(Explore, RefusesAnIndefiniteHessian) {
  ParametricProgram program = randomProgram(3, 10, 2, 4);
  program.H(0, 0) = -1.0;
  EXPECT_THROW(explore(program), Error);
}

TEST(Explore, RefusesParametersThatAreTiedToEachOther) {
  ParametricProgram program = randomProgram(3, 10, 2, 4);
  program.A.topRows(2).setZero();
  program.S.topRows(2) << 1.0, 1.0, -1.0, -1.0;  // theta_0 + theta_1 = 0.1
  program.b.head(2) << -0.1, 0.1;
  EXPECT_THROW(explore(program), Error);
}

/// Two of its rows nearly repeat each other.
ParametricProgram manyParameters(int p) {
  ParametricProgram program = randomProgram(2, 4, p, 1);
  program.A.row(3) = program.A.row(2) * (1.0 + 1e-7);
  program.S.row(3) = program.S.row(2) * (1.0 - 1e-7);
  return program;
}

TEST(Explore, NamesTheLimitOfParameters) {
  EXPECT_EQ(explore(manyParameters(12)).status, ExploreStatus::kComplete);
  for (const int p : {13, 17, 20}) {
    const ParametricProgram program = manyParameters(p);
    EXPECT_EQ(errorOf([&] { explore(program); }),
              program.name + ": parameters: must be at most 12, got " + std::to_string(p));
  }
}

TEST(Explore, RefusesAnUnboundedParameter) {
  ParametricProgram program = randomProgram(3, 10, 2, 4);
  program.parameters[1].upper = std::numeric_limits<double>::infinity();
  EXPECT_THROW(explore(program), Error);
}

TEST(Explore, TwoOppositeRowsAreAnEquality) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    ParametricProgram given = randomProgram(4, 5, 2, seed);
    given.b(4) = 0.3;
    ParametricProgram hidden = given;
    given.equalities = {4};
    appendMultiple(hidden, 4, -1.0);
    const Partition wanted = explore(given), found = explore(hidden);
    EXPECT_EQ(found.status, wanted.status) << seed;
    EXPECT_EQ(found.regions.size(), wanted.regions.size()) << seed;
  }
}

TEST(Explore, RowsThatSayNothingChangeNothing) {
  const ParametricProgram plain = randomProgram(3, 10, 2, 4);
  const Partition wanted = explore(plain);
  ParametricProgram program = plain;  // 0 . theta <= 0
  program.A_theta = Eigen::MatrixXd::Zero(1, 2);
  program.b_theta = Eigen::VectorXd::Zero(1);
  appendRow(program, Eigen::VectorXd::Zero(3), 0.0, Eigen::VectorXd::Zero(2));
  const Partition found = explore(program);
  EXPECT_EQ(found.status, ExploreStatus::kComplete);
  EXPECT_EQ(found.regions.size(), wanted.regions.size());
  program.b_theta(0) = -0.1;
  EXPECT_EQ(explore(program).status, ExploreStatus::kInfeasible);
}

// A start is looked for with a small weight on z, which must not hold back the z that a large box asks for.
TEST(Explore, FindsItsStartInBoxesOfAnySize) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    for (const double size : {1e3, 1e6, 1e8}) {
      ParametricProgram program = randomProgram(5, 9, 2, seed);  // feasible at theta = 0
      for (Signal& parameter : program.parameters) {
        parameter.lower = -size;
        parameter.upper = size;
      }
      const Partition partition = explore(program);
      EXPECT_EQ(partition.status, ExploreStatus::kComplete) << "seed " << seed << ", box of " << size;
      std::mt19937_64 random(seed);
      for (int k = 0; k < 20; ++k) {
        const Eigen::VectorXd theta = size * randomTheta(2, random);
        const bool held = !holders(partition, theta).empty();
        const LpAnswer answer =
            solveByGlpk(Eigen::VectorXd::Zero(5), program.A, program.b + program.S * theta);
        EXPECT_EQ(held, answer.status == GLP_OPT) << "seed " << seed << ", " << theta.transpose();
      }
    }
  }
}

// Equalities, given or hidden in inequalities, may leave nothing of z to choose.
TEST(Explore, EqualitiesMayFixAllOfZ) {
  for (const bool is_linear : {false, true}) {
    ParametricProgram given = randomProgram(2, 4, 3, 6);
    if (is_linear) given.H.setZero();
    given.A.topRows(2) << 1.0, 2.0, -1.0, 1.0;
    given.b.head(2).setZero();  // z = 0 at theta = 0
    given.equalities = {0, 1};
    given.b(3) = 0.1;
    ParametricProgram hidden = given;
    hidden.equalities.clear();
    for (const int row : {0, 1}) appendMultiple(hidden, row, -1.0);
    for (const ParametricProgram& program : {given, hidden}) {
      const Partition partition = explore(program);
      ASSERT_EQ(partition.status, ExploreStatus::kComplete);
      ASSERT_EQ(partition.regions.size(), 1u);
      const CriticalRegion& region = partition.regions.front();
      std::mt19937_64 random(1);
      for (int k = 0; k < 50; ++k) {
        const Eigen::VectorXd theta = randomTheta(3, random);
        const Eigen::VectorXd bound = given.b + given.S * theta;
        const Eigen::VectorXd z = Eigen::MatrixXd(given.A.topRows(2)).inverse() * bound.head(2);
        const bool is_feasible = ((given.A * z - bound).tail(2).array() <= 0.0).all();
        EXPECT_EQ((region.G * theta - region.g).maxCoeff() <= kInside, is_feasible);
        EXPECT_NEAR((region.K * theta + region.k)(0), z(0), 1e-12);
      }
    }
  }
}

// Rows that leave z = 0 alone: rounding takes their margin, zero, a little below zero.
TEST(Explore, AMarginOfZeroIsNotTakenForNone) {
  ParametricProgram program = randomProgram(4, 6, 1, 1);
  program.A << 0.327, 1.136, 0.824, 0.579, -0.379, -1.019, 0.376, -0.512, 0.827, 0.211, -0.745, 0.268, 0.709,
      0.178, -0.783, 0.262, 0.357, 0.824, 0.722, -0.908, -0.498, 0.606, -1.698, 0.777;
  program.b.setZero();
  program.S.setZero();
  const Partition partition = explore(program);
  ASSERT_EQ(partition.status, ExploreStatus::kComplete);
  ASSERT_EQ(partition.regions.size(), 1u);
  EXPECT_NEAR((partition.regions[0].K * Eigen::VectorXd::Ones(1) + partition.regions[0].k)(0), 0.0, 1e-12);
}

}  // namespace
}  // namespace polyfly
