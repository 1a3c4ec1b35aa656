// Programs whose cost falls without end at all, some or none of their parameters: the partition says so, with
// a parameter where it does, and holds all others. The oracle is GLPK, parameter by parameter.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "glpk_lp.hpp"
#include "offline_mpt/verify.hpp"
#include "random.hpp"
#include "random_program.hpp"
#include "solved_map.hpp"

namespace polyfly {
namespace {

enum class Family {
  /// H = 0, and the cost depends on theta: all kinds.
  kLinear,
  /// H = 0, and the cost does not depend on theta: unbounded nowhere or everywhere.
  kConstantCost,
  /// H = 0, with one open direction along which the cost falls in a part of the box.
  kTilted,
  /// As kTilted, but that part of the box has no solution, so the partition is complete.
  kOutsideAnyway,
  /// H = 0, with an equality.
  kEqualities,
  kCount
};

/// z_0 >= -1 is open above; all others lie between -1 and 1. Its cost is offset + theta_0.
void tilt(ParametricProgram& program, double offset) {
  const int n = program.variableCount(), p = program.parameterCount();
  program.A.resize(0, n);
  program.b.resize(0);
  program.S.resize(0, p);
  for (int i = 0; i < n; ++i) {
    appendRow(program, -Eigen::VectorXd::Unit(n, i), 1.0, Eigen::VectorXd::Zero(p));
    if (i > 0) appendRow(program, Eigen::VectorXd::Unit(n, i), 1.0, 0.2 * Eigen::VectorXd::Ones(p));
  }
  program.F.row(0) = Eigen::RowVectorXd::Unit(p, 0);
  program.f(0) = offset;
}

ParametricProgram makeProgram(Family family, unsigned seed) {
  Random random(100u * static_cast<unsigned>(family) + seed);
  const int n = 2 + random.below(3), p = 1 + random.below(3), m = n + random.below(4);
  ParametricProgram program = randomProgram(n, m, p, 1000u * static_cast<unsigned>(family) + seed);
  program.name = "unbounded_" + std::to_string(static_cast<int>(family)) + "_" + std::to_string(seed);
  program.H.setZero();
  const double offset = 0.8 * random.matrix(1, 1)(0, 0);
  switch (family) {
    case Family::kConstantCost:
      program.F.setZero();
      break;
    case Family::kTilted:
      tilt(program, offset);
      break;
    case Family::kOutsideAnyway: {
      tilt(program, 0.5);
      const Eigen::VectorXd first = Eigen::VectorXd::Unit(p, 0);
      appendRow(program, Eigen::VectorXd::Unit(n, 1), -0.6, first);  // theta_0 >= -0.4: above the tilt's edge
      break;
    }
    case Family::kEqualities:
      program.equalities = {m};
      appendRow(program, random.matrix(n, 1), 0.1, 0.1 * random.matrix(p, 1));
      break;
    default:
      break;
  }
  outputAllVariables(program);
  return program;
}

/// GLP_OPT, GLP_NOFEAS or GLP_UNBND.
int glpkStatus(const ParametricProgram& program, const Eigen::VectorXd& theta) {
  return solveByGlpk(program.f + program.F * theta, program.A, program.b + program.S * theta,
                     program.equalities)
      .status;
}

struct Seen {
  int finite = 0, unbounded = 0;
};

/// Regions hold the parameters with a finite optimum, and no others.
Seen expectRightPlaces(const ParametricProgram& program, const Partition& partition, unsigned seed) {
  Random random(seed);
  Seen seen;
  for (int k = 0; k < 60; ++k) {
    const Eigen::VectorXd theta = random.matrix(program.parameterCount(), 1);
    const int status = glpkStatus(program, theta);
    seen.finite += status == GLP_OPT;
    seen.unbounded += status == GLP_UNBND;
    EXPECT_EQ(holders(partition, theta, 1e-8).empty(), status != GLP_OPT)
        << program.name << " at " << theta.transpose() << ", GLPK says " << status;
  }
  return seen;
}

/// `verify` and `certify` say of the map what the partition does.
void expectSameVerdicts(const ParametricProgram& program, const Partition& partition) {
  const bool complete = partition.status == ExploreStatus::kComplete;
  const MapInMemory map(encode(program, partition));
  EXPECT_EQ(map.map().solverStatus(), toString(partition.status));
  EXPECT_EQ(map.map().solverNotes().find("unbounded_at: (") != std::string_view::npos, !complete);
  const CertifyReport exact = certify(map.map(), program);
  EXPECT_EQ(exact.passed(), complete) << program.name << "\n" << certifyText(exact);
  const bool named = std::any_of(exact.defects.begin(), exact.defects.end(), [](const Defect& defect) {
    return defect.kind == Defect::Kind::kUnbounded;
  });
  EXPECT_EQ(named, !complete) << program.name << "\n" << certifyText(exact);
  EXPECT_EQ(exact.certificate.empty(), !complete);
  VerifyOptions options;
  options.samples = 100;
  const VerifyReport sampled = verify(map.map(), program, options);
  EXPECT_EQ(sampled.passed(), complete) << program.name << "\n" << verifyText(sampled);
}

class UnboundedBelow : public testing::TestWithParam<int> {};

TEST_P(UnboundedBelow, IsStatedWithAWitness) {
  const auto family = static_cast<Family>(GetParam());
  int none = 0, part = 0, whole = 0;
  for (unsigned seed = 1; seed <= 25; ++seed) {
    const ParametricProgram program = makeProgram(family, seed);
    const Partition partition = explore(program);
    const Seen seen = expectRightPlaces(program, partition, seed);
    if (seen.unbounded > 0) {
      EXPECT_EQ(partition.status, ExploreStatus::kUnbounded) << program.name;
    }
    if (partition.status == ExploreStatus::kUnbounded) {
      ASSERT_EQ(partition.unbounded_at.size(), program.parameterCount());
      EXPECT_EQ(glpkStatus(program, partition.unbounded_at), GLP_UNBND) << program.name;
      EXPECT_LE(partition.unbounded_at.cwiseAbs().maxCoeff(), 1.0);
    } else {
      EXPECT_EQ(partition.status, ExploreStatus::kComplete) << program.name << toString(partition.status);
    }
    const bool unbounded = partition.status == ExploreStatus::kUnbounded;
    ++(!unbounded ? none : partition.regions.empty() ? whole : part);
    if (!partition.regions.empty()) expectSameVerdicts(program, partition);
  }
  EXPECT_EQ(none == 25, family == Family::kOutsideAnyway);
  EXPECT_EQ(part > 0, family != Family::kConstantCost && family != Family::kOutsideAnyway);
  if (family == Family::kConstantCost) {
    EXPECT_GT(whole, 0);
  }
}

// An exploration that is cut off asks as well, at its start and at corners of the box: enough here.
TEST_P(UnboundedBelow, IsStatedBeforeTheEnd) {
  const auto family = static_cast<Family>(GetParam());
  int cut = 0, stated = 0;
  for (unsigned seed = 1; seed <= 25; ++seed) {
    const ParametricProgram program = makeProgram(family, seed);
    const Partition whole = explore(program);
    if (whole.regions.size() < 2) continue;
    ++cut;
    ExploreOptions options;
    options.region_limit = 1;
    const Partition part = explore(program, options);
    EXPECT_EQ(part.status, ExploreStatus::kLimited) << program.name;
    const bool unbounded = part.unbounded_at.size() > 0;
    EXPECT_EQ(unbounded, whole.status == ExploreStatus::kUnbounded) << program.name;
    if (unbounded) {
      ++stated;
      EXPECT_EQ(glpkStatus(program, part.unbounded_at), GLP_UNBND) << program.name;
    }
    const MapInMemory map(encode(program, part));
    EXPECT_EQ(map.map().solverStatus(), "limited");
    EXPECT_EQ(map.map().solverNotes().find("unbounded_at: (") != std::string_view::npos, unbounded);
  }
  EXPECT_GT(cut, 0);
  EXPECT_EQ(stated > 0, family != Family::kConstantCost && family != Family::kOutsideAnyway);
}

// So many parameters that not all corners are asked.
TEST(UnboundedBelowInManyParameters, IsStatedBeforeTheEnd) {
  for (const double offset : {0.5, -0.5}) {
    ParametricProgram program = randomProgram(3, 1, 12, 1);
    program.H.setZero();
    tilt(program, offset);
    outputAllVariables(program);
    ExploreOptions options;
    options.region_limit = 1;
    const Partition partition = explore(program, options);
    ASSERT_EQ(partition.status, ExploreStatus::kLimited);
    ASSERT_EQ(partition.unbounded_at.size(), 12);
    EXPECT_EQ(glpkStatus(program, partition.unbounded_at), GLP_UNBND);
  }
}

TEST(UnboundedBelowInterrupted, IsStatedBeforeTheFirstRegion) {
  const ParametricProgram program = makeProgram(Family::kTilted, 1);
  const std::atomic<bool> stop{true};
  ExploreOptions options;
  options.stop = &stop;
  const Partition partition = explore(program, options);
  EXPECT_EQ(partition.status, ExploreStatus::kInterrupted);
  EXPECT_TRUE(partition.regions.empty());
  ASSERT_EQ(partition.unbounded_at.size(), program.parameterCount());
  EXPECT_EQ(glpkStatus(program, partition.unbounded_at), GLP_UNBND);
}

// With all of z among the outputs, rounded, an equality of z could not be met: a right map was called wrong.
TEST(OutputsThatAreAllOfZ, DoNotContradictAnEquality) {
  const ParametricProgram program = makeProgram(Family::kEqualities, 256);
  const Partition partition = explore(program);
  ASSERT_EQ(partition.status, ExploreStatus::kComplete);
  expectSameVerdicts(program, partition);
}

INSTANTIATE_TEST_SUITE_P(Families, UnboundedBelow, testing::Range(0, static_cast<int>(Family::kCount)));

}  // namespace
}  // namespace polyfly
