// The units of rows, variables, parameters, outputs and cost change nothing but the units of the answer.
#include "mpc_core/scaled_program.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "norm_cost_programs.hpp"
#include "offline_mpt/verify.hpp"
#include "random.hpp"
#include "random_program.hpp"
#include "solved_map.hpp"

namespace polyfly {
namespace {

constexpr double kSame = 1e-8;

/// One unit for all numbers of a kind, in units of the program as it was made.
struct Units {
  double rows = 1.0, variables = 1.0, parameters = 1.0, outputs = 1.0, cost = 1.0;
};

ParametricProgram inUnits(ParametricProgram program, const Units& units) {
  const double z = units.variables, theta = units.parameters;
  program.H *= units.cost * z * z;
  program.f *= units.cost * z;
  program.F *= units.cost * z * theta;
  program.A *= z / units.rows;
  program.b /= units.rows;
  program.S *= theta / units.rows;
  program.E *= z / units.outputs;
  program.C *= theta / units.outputs;
  program.c /= units.outputs;
  for (Signal& parameter : program.parameters) {
    parameter.lower /= theta;
    parameter.upper /= theta;
  }
  for (Signal& input : program.inputs) {
    if (std::abs(input.upper) > 1e100) continue;
    input.lower /= units.outputs;
    input.upper /= units.outputs;
  }
  return program;
}

// Where several active sets describe one region, rounding may choose among them.
void expectSameAnswers(const Partition& expected, const Partition& found, const Units& units) {
  ASSERT_EQ(found.status, expected.status);
  ASSERT_EQ(found.regions.size(), expected.regions.size());
  for (const CriticalRegion& region : expected.regions) {
    const Eigen::VectorXd u = region.K * region.centre + region.k;
    const Eigen::VectorXd theta = region.centre / units.parameters;
    const std::vector<CriticalRegion> held = holders(found, theta, 0.0);
    EXPECT_EQ(held.size(), 1u);
    for (const CriticalRegion& other : held) {
      const Eigen::VectorXd difference = (other.K * theta + other.k) * units.outputs - u;
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), kSame * std::max(1.0, u.cwiseAbs().maxCoeff()));
    }
  }
}

void expectSameInAllUnits(const ParametricProgram& program) {
  const Partition expected = explore(program);
  ASSERT_EQ(expected.status, ExploreStatus::kComplete);
  for (const double unit : {1e-9, 1e-4, 3e5, 1e9}) {
    for (double Units::*const kind :
         {&Units::rows, &Units::variables, &Units::parameters, &Units::outputs, &Units::cost}) {
      Units units;
      units.*kind = unit;
      SCOPED_TRACE(program.name + " in units of " + std::to_string(unit));
      expectSameAnswers(expected, explore(inUnits(program, units)), units);
    }
  }
}

TEST(Units, DoNotChangeALinearProgram) {
  expectSameInAllUnits(normCostMpc(integrators(2, 0.25), CostNorm::kOne, 2));
  expectSameInAllUnits(normCostMpc(integrators(2, 0.3), CostNorm::kInfinity, 2));
}

TEST(Units, DoNotChangeAQuadraticProgram) {
  for (unsigned seed = 1; seed <= 4; ++seed) expectSameInAllUnits(randomProgram(4, 8, 2, seed));
}

// Bounds, states and inputs shrink together.
TEST(Units, OfAllQuantitiesAtOnce) {
  for (const bool linear : {false, true}) {
    for (const double unit : {1e-9, 1e8}) {
      Units units;
      units.variables = units.parameters = units.outputs = units.rows = unit;
      units.cost = 1.0 / unit / unit;
      const ParametricProgram program =
          linear ? normCostMpc(integrators(2, 0.25), CostNorm::kInfinity, 2) : randomProgram(4, 8, 2, 5);
      const ParametricProgram other = inUnits(program, units);
      const Partition partition = explore(other);
      expectSameAnswers(explore(program), partition, units);
      const MapInMemory map(encode(other, partition));
      const CertifyReport proof = certify(map.map(), other);
      EXPECT_TRUE(linear || proof.passed()) << certifyText(proof);
      VerifyOptions options;
      options.samples = 500;
      const VerifyReport report = verify(map.map(), other, options);
      EXPECT_TRUE(report.passed()) << verifyText(report);
    }
  }
}

// A unit of its own for each variable and each row.
TEST(Units, OfEachVariable) {
  for (const bool linear : {false, true}) {
    ParametricProgram program =
        linear ? normCostMpc(integrators(2, 0.25), CostNorm::kOne, 2) : randomProgram(4, 8, 2, 6);
    const Partition expected = explore(program);
    for (Eigen::Index j = 0; j < program.H.cols(); ++j) {
      const double unit = j % 2 == 0 ? 0x1p20 : 0x1p-20;
      program.H.row(j) *= unit;
      program.H.col(j) *= unit;
      program.f(j) *= unit;
      program.F.row(j) *= unit;
      program.A.col(j) *= unit;
      program.E.col(j) *= unit;
    }
    for (Eigen::Index i = 0; i < program.A.rows(); ++i) {
      const double unit = i % 3 == 0 ? 0x1p-23 : 0x1p17;
      program.A.row(i) *= unit;
      program.S.row(i) *= unit;
      program.b(i) *= unit;
    }
    const Partition found = explore(program);
    expectSameAnswers(expected, found, Units());
    const CertifyReport report = certified(found, program);
    EXPECT_TRUE(linear || report.passed()) << certifyText(report);
  }
}

/// max sum of z, sum of z <= theta, 0 <= z <= most, theta in [0, 3 most]
ParametricProgram cappedSum(int n, double most) {
  ParametricProgram program = randomProgram(n, 0, 1, 1);
  program.name = "capped_sum";
  program.H.setZero();
  program.f.setConstant(-1.0);
  program.F.setZero();
  appendRow(program, Eigen::VectorXd::Ones(n), 0.0, Eigen::VectorXd::Ones(1));
  for (int j = 0; j < n; ++j) {
    appendRow(program, Eigen::VectorXd::Unit(n, j), most, Eigen::VectorXd::Zero(1));
    appendRow(program, -Eigen::VectorXd::Unit(n, j), 0.0, Eigen::VectorXd::Zero(1));
  }
  program.parameters[0].lower = 0.0;
  program.parameters[0].upper = 3.0 * most;
  outputAllVariables(program);
  return program;
}

TEST(Units, OfACappedSum) {
  for (const double most : {1e-9, 1e-3, 1e5, 1e9}) {
    for (const int n : {1, 2}) {
      const Partition partition = explore(cappedSum(n, most));
      ASSERT_EQ(partition.status, ExploreStatus::kComplete) << most;
      for (const double share : {0.3, 0.9, 1.7, 2.5, 2.9}) {
        const Eigen::VectorXd theta = Eigen::VectorXd::Constant(1, share * most);
        const std::vector<CriticalRegion> held = holders(partition, theta, 0.0);
        EXPECT_EQ(held.size(), 1u) << most << " " << share;
        for (const CriticalRegion& region : held) {
          const Eigen::VectorXd z = region.K * theta + region.k;
          EXPECT_NEAR(z.sum(), std::min(share, 1.0 * n) * most, 1e-12 * most);
        }
      }
    }
  }
}

TEST(Units, AreScaledWithoutRounding) {
  const ParametricProgram program = randomProgram(3, 5, 2, 9);
  const ScaledProgram scaled = scaleProgram(program);
  for (Eigen::Index i = 0; i < 5; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const double ratio = scaled.program.A(i, j) / program.A(i, j);
      EXPECT_EQ(std::ldexp(1.0, std::ilogb(ratio)), ratio);
    }
  }
}

// A law of the wrong sign of an input whose whole range is 1e-8.
TEST(Units, OfAnInputDecideWhatAnErrorIs) {
  const ParametricProgram program = inUnits(randomProgram(3, 6, 1, 3), {1.0, 1.0, 1.0, 1e9, 1.0});
  Partition partition = explore(program);
  VerifyOptions options;
  options.samples = 300;
  EXPECT_TRUE(verify(MapInMemory(encode(program, partition)).map(), program, options).passed());
  for (CriticalRegion& region : partition.regions) {
    region.K *= -1.0;
    region.k *= -1.0;
  }
  EXPECT_FALSE(verify(MapInMemory(encode(program, partition)).map(), program, options).passed());
}

}  // namespace
}  // namespace polyfly
