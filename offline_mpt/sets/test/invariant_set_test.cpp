// Invariant sets against horizons long enough solved by GLPK, known sets, and each other.
#include "polytope_sets/invariant_set.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../../test/exact_volume.hpp"
#include "../../test/glpk_lp.hpp"
#include "../../test/random.hpp"
#include "../../test/reference_problems.hpp"
#include "polyfly_base/error.hpp"
#include "polytope_sets/polytope.hpp"

namespace polyfly {
namespace {

/// Double integrator, |x| <= 5, |u| <= 1, disturbance of the velocity up to `d`.
SetModel doubleIntegrator(const std::string& d) {
  return parseModel(R"(
polyfly_model: 1
name: double_integrator
states:
  - {name: p, unit: m, range: [-5, 5]}
  - {name: v, unit: m/s, range: [-5, 5]}
inputs:
  - {name: a, unit: m/s^2, range: [-1, 1]}
disturbances:
  - {name: w, unit: m/s, range: [-)" +
                        d + ", " + d + R"(]}
A: [[1, 1], [0, 1]]
B: [[0.5], [1]]
E: [[0], [1]]
)",
                    "double_integrator.yaml");
}

// Whether an open-loop input keeps x in the box for `steps` steps: a linear program over all inputs.
bool survives(double p, double v, int steps) {
  Eigen::MatrixXd A(6 * steps, steps);
  Eigen::VectorXd b(6 * steps);
  A.setZero();
  for (int k = 1; k <= steps; ++k) {
    Eigen::RowVectorXd position = Eigen::RowVectorXd::Zero(steps), velocity = position;
    for (int i = 0; i < k; ++i) {
      position[i] = 0.5 + (k - 1 - i);
      velocity[i] = 1.0;
    }
    const int row = 6 * (k - 1);
    A.row(row) = position, b[row] = 5.0 - p - k * v;
    A.row(row + 1) = -position, b[row + 1] = 5.0 + p + k * v;
    A.row(row + 2) = velocity, b[row + 2] = 5.0 - v;
    A.row(row + 3) = -velocity, b[row + 3] = 5.0 + v;
    A(row + 4, k - 1) = 1.0, b[row + 4] = 1.0;
    A(row + 5, k - 1) = -1.0, b[row + 5] = 1.0;
  }
  return solveByGlpk(Eigen::VectorXd::Zero(steps), A, b).status == GLP_OPT;
}

TEST(InvariantSet, DoubleIntegratorIsWhatSurvivesAllHorizons) {
  const SetModel model = doubleIntegrator("0");
  const InvariantSet result = maximalInvariantSet(model);
  ASSERT_EQ(result.status, InvariantSet::Status::kMaximal);
  EXPECT_TRUE(proveInvariant(model, result.set).holds);
  int inside = 0;
  for (int i = 0; i <= 10; ++i) {
    for (int j = 0; j <= 20; ++j) {  // half cells off: no point lies on a facet
      const double p = -4.9 + 0.97 * i, v = -4.43 + 0.431 * j;
      const bool expected = survives(p, v, result.iterations + 4);
      EXPECT_EQ(contains(result.set, {Rational(p), Rational(v)}), expected) << p << " " << v;
      inside += expected ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 50);
  EXPECT_LT(inside, 200);
}

TEST(InvariantSet, FloatAgreesWithExact) {
  for (const char* d : {"0", "0.1", "1/4"}) {
    const SetModel model = doubleIntegrator(d);
    const InvariantSet exact = maximalInvariantSet(model);
    InvariantOptions options;
    options.exact = false;
    const InvariantSet rounded_set = maximalInvariantSet(model, options);
    ASSERT_EQ(exact.status, InvariantSet::Status::kMaximal) << d;
    ASSERT_EQ(rounded_set.status, InvariantSet::Status::kMaximal) << d;
    EXPECT_EQ(exact.set.rows.size(), rounded_set.set.rows.size()) << d;
    EXPECT_NEAR(volume(exact.set).get_d(), volume(rounded_set.set).get_d(), 1e-6) << d;
    EXPECT_TRUE(proveInvariant(model, exact.set).holds) << d;
  }
}

TEST(InvariantSet, LargerSetsAreNotInvariant) {
  const SetModel model = doubleIntegrator("0.1");
  const InvariantSet result = maximalInvariantSet(model);
  ASSERT_EQ(result.status, InvariantSet::Status::kMaximal);
  for (std::size_t k = 0; k < result.set.rows.size();
       ++k) {  // each facet moved out: maximal, so it must fail
    ExactPolytope larger = result.set;
    larger.rows[k].b += Rational(1, 1000000);
    const InvarianceProof proof = proveInvariant(model, larger);
    EXPECT_FALSE(proof.holds) << k;
    ASSERT_TRUE(proof.counterexample.has_value());
    EXPECT_TRUE(contains(larger, *proof.counterexample));
    EXPECT_FALSE(contains(predecessor(model, larger), *proof.counterexample));
  }
}

TEST(InvariantSet, NothingIsLeftUnderTooMuchDisturbance) {
  const SetModel model = doubleIntegrator("1.1");
  EXPECT_EQ(maximalInvariantSet(model).status, InvariantSet::Status::kEmpty);
  InvariantOptions options;
  options.exact = false;
  EXPECT_EQ(maximalInvariantSet(model, options).status, InvariantSet::Status::kEmpty);
}

TEST(InvariantSet, LimitSaysSo) {
  InvariantOptions options;
  options.max_iterations = 1;
  const InvariantSet result = maximalInvariantSet(doubleIntegrator("0"), options);
  EXPECT_EQ(result.status, InvariantSet::Status::kLimit);
  EXPECT_TRUE(contains(result.set, maximalInvariantSet(doubleIntegrator("0")).set));
}

// A rotation by a right angle that shrinks by 9/10: the box turned is the box, so all of it stays.
TEST(InvariantSet, AutonomousRotation) {
  const SetModel model = parseModel(R"(
polyfly_model: 1
name: rotation
states: [{name: x, unit: m, range: [-1, 1]}, {name: y, unit: m, range: [-2, 2]}]
A: [[0, -0.9], [0.9, 0]]
)",
                                    "rotation.yaml");
  const InvariantSet result = maximalInvariantSet(model);
  ASSERT_EQ(result.status, InvariantSet::Status::kMaximal);
  // |x| <= 1, |y| <= 2, |0.9 y| <= 1, and no more after two steps, since 0.81 < 1.
  EXPECT_TRUE(equal(result.set,
                    ExactPolytope::box({Rational(-1), Rational(-10, 9)}, {Rational(1), Rational(10, 9)})));
}

TEST(InvariantSet, RefusesUnboundedSets) {
  SetModel model = doubleIntegrator("0");
  model.U.rows.clear();
  EXPECT_THROW(maximalInvariantSet(model), Error);
}

// A published set: 34 half-spaces, of a multirotor axis with bounded position.
TEST(InvariantSet, AgreesWithTheReference) {
  const auto problems = referenceProblems();
  if (problems.empty()) GTEST_SKIP() << "reference data are absent";
  const auto reference = readJson(problems.parent_path() / "rmpc" / "rci3_p1.5_w0.5.json");
  const SetModel model = parseModel(R"(
polyfly_model: 1
name: axis
states:
  - {name: p, unit: m, range: [-1.5, 1.5]}
  - {name: v, unit: m/s, range: [-1.5, 1.5]}
  - {name: phi, unit: rad, range: [-0.35, 0.35]}
inputs: [{name: u, unit: rad, range: [-0.35, 0.35]}]
disturbances: [{name: w, unit: m/s^2, range: [-0.5, 0.5]}]
sampling_time: 0.08
A: [[0, 1, 0], [0, -0.01, 9.81], [0, 0, -5]]
B: [[0], [0], [4.5]]
E: [[0], [1], [0]]
)",
                                    "axis.yaml");
  InvariantOptions options;
  options.exact = false;
  const InvariantSet result = maximalInvariantSet(model, options);
  ASSERT_EQ(result.status, InvariantSet::Status::kMaximal);
  EXPECT_EQ(result.set.rows.size(), reference["H"].size());
  EXPECT_NEAR(volume(result.set).get_d(), 5.45997, 1e-5);
  const Polytope set = rounded(result.set);
  for (const auto& row : reference["H"]) {  // every half-space of theirs is one of ours
    const Eigen::Vector3d h(row[0], row[1], row[2]);
    double nearest = 1.0;
    for (int i = 0; i < set.rowCount(); ++i)
      nearest = std::min(nearest, (set.A.row(i).transpose() / set.b[i] - h).cwiseAbs().maxCoeff());
    EXPECT_LT(nearest, 1e-6);
  }
}

}  // namespace
}  // namespace polyfly
