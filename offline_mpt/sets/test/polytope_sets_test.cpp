// Polytopes in floating point against the exact ones, closed forms and GLPK; set and model files.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../../test/exact_volume.hpp"
#include "../../test/glpk_lp.hpp"
#include "../../test/random.hpp"
#include "error_of.hpp"
#include "holds.hpp"
#include "polytope_sets/polytope.hpp"
#include "polytope_sets/set_model.hpp"

namespace polyfly {
namespace {

constexpr double kTolerance = 1e-9;

ExactPolytope randomSet(Random& random, int dimension, int rows) {
  const auto size = static_cast<std::size_t>(dimension);
  ExactPolytope result =
      ExactPolytope::box(RationalVector(size, Rational(-1)), RationalVector(size, Rational(1)));
  for (int i = 0; i < rows; ++i) {
    ExactHalfSpace row;
    for (int j = 0; j < dimension; ++j) row.a.emplace_back(random.uniform(-1.0, 1.0));
    row.b = Rational(random.uniform(0.2, 1.0));
    result.rows.push_back(row);
  }
  return result;
}

TEST(Polytope, MinimalRowsSupportAndEliminationAgreeWithTheExactOnes) {
  Random random(14);
  for (int k = 0; k < 20; ++k) {
    const int n = 2 + random.below(3);
    const ExactPolytope exact = randomSet(random, n, 6);
    const Polytope set = rounded(exact);
    EXPECT_EQ(minimal(set, kTolerance).rowCount(), static_cast<int>(minimal(exact).rows.size()));
    const Ball ball = chebyshevBall(set);
    const Eigen::VectorXd direction = random.matrix(n, 1);
    EXPECT_NEAR(support(set, ball.centre, direction), -solveByGlpk(-direction, set.A, set.b).objective, 1e-9);
    const Polytope shadow = eliminate(set, n - 1, kTolerance);
    std::vector<int> keep;
    for (int j = 0; j + 1 < n; ++j) keep.push_back(j);
    const ExactPolytope exact_shadow = project(exact, keep);
    EXPECT_EQ(shadow.rowCount(), static_cast<int>(exact_shadow.rows.size()));
    EXPECT_NEAR(volume(exactly(shadow)).get_d(), volume(exact_shadow).get_d(), 1e-9);
  }
}

TEST(Polytope, BallTouchesTheSides) {
  const Polytope box = rounded(ExactPolytope::box({Rational(0), Rational(0)}, {Rational(4), Rational(2)}));
  const Ball ball = chebyshevBall(box);
  EXPECT_NEAR(ball.radius, 1.0, 1e-12);
  EXPECT_NEAR(ball.centre[1], 1.0, 1e-12);
}

TEST(SetFile, ReadsEveryForm) {
  const ExactPolytope box = parseSet("{polyfly_set: 1, box: [[0, 0.1], [-1/3, 2]]}", "box");
  EXPECT_EQ(volume(box), Rational(7, 30));
  const ExactPolytope triangle = parseSet("polyfly_set: 1\nvertices: [[0, 0], [1, 0], [0, 1]]\n", "triangle");
  EXPECT_EQ(volume(triangle), Rational(1, 2));
  const ExactPolytope cut = parseSet(
      R"({"polyfly_set": 1, "vertices": [[0, 0], [1, 0], [0, 1]], "A": [["-1", 0]], "b": ["-1/2"]})", "cut");
  EXPECT_EQ(volume(cut), Rational(1, 8));
  const ExactPolytope segment =
      parseSet("{polyfly_set: 1, box: [[0, 1], [0, 1]], A_eq: [[1, -1]], b_eq: [0]}", "segment");
  EXPECT_EQ(affineDimension(segment), 1);
}

TEST(SetFile, WritesWhatItReads) {
  Random random(1);
  for (int k = 0; k < 5; ++k) {
    ExactPolytope set = minimal(randomSet(random, 3, 4));
    if (k == 1) set.equalities.push_back({{Rational(1), Rational(1, 3), Rational(0)}, Rational(1, 7)});
    const std::string text = setText(set);
    EXPECT_TRUE(equal(parseSet(text, "copy"), set));
    EXPECT_EQ(setText(parseSet(text, "copy")), text);
  }
}

void expectRefused(const std::string& text, const std::string& word) {
  const std::string error = errorOf([&] { parseSet(text, "bad.yaml"); });
  EXPECT_EQ(error.rfind("bad.yaml:", 0), 0u) << error;
  EXPECT_TRUE(holds(error, word));
}

TEST(SetFile, RefusesWhatBreaksARule) {
  expectRefused("{polyfly_set: 1}", "dimensions");
  expectRefused("{polyfly_set: 2, box: [[0, 1]]}", "polyfly_set");
  expectRefused("{polyfly_set: 1, box: [[1, 0]]}", "box");
  expectRefused("{polyfly_set: 1, box: [[0, 1]], colour: red}", "unknown key");
  expectRefused("{polyfly_set: 1, A: [[1, 0]]}", "b: missing");
  expectRefused("{polyfly_set: 1, A: [[1, 0], [1]], b: [1, 1]}", "A[1]");
  expectRefused("{polyfly_set: 1, A: [[1, x]], b: [1]}", "A[0][1]");
  expectRefused("{polyfly_set: 1, A: [[1, nan]], b: [1]}", "number");
  expectRefused("{polyfly_set: 1, vertices: []}", "dimensions");
  expectRefused("[1, 2]", "map");
}

TEST(ModelFile, RefusesWhatBreaksARule) {
  const std::string good =
      "polyfly_model: 1\nname: a\nstates: [{name: x, unit: m}]\ninputs: [{name: u, unit: m}]\nA: [[1]]\nB: "
      "[[1]]\n";
  EXPECT_NO_THROW(parseModel(good, "good"));
  const auto refused = [&](const std::string& text, const std::string& word) {
    EXPECT_TRUE(holds(errorOf([&] { parseModel(text, "bad.yaml"); }), word));
  };
  refused(good + "E: [[1]]\n", "E");
  refused(good + "disturbances: [{name: d, unit: m}]\nE: [[1]]\n", "range");
  refused(good + "disturbances: [{name: x, unit: m, range: [0, 1]}]\nE: [[1]]\n", "duplicate name");
  refused(good + "parameters: [{name: q, unit: m, next: y}]\n", "next");
  refused(good + "parameters: [{name: q, unit: s, next: u}]\n", "unit");
  refused(good + "sampling_time: 0\n", "sampling_time");
  refused(good + "X: {box: [[0, 1], [0, 1]]}\n", "X.box");
  refused(good + "D: {box: []}\nfoo: 1\n", "unknown key");
}

TEST(ModelFile, DiscretisesContinuousTime) {
  const SetModel model = parseModel(
      "polyfly_model: 1\nname: a\nstates: [{name: x, unit: m}, {name: v, unit: m/s}]\n"
      "disturbances: [{name: d, unit: m/s^2, range: [-1, 1]}]\n"
      "A: [[0, 1], [0, 0]]\nE: [[0], [1]]\nc: [0, -2]\nsampling_time: 0.5\n",
      "model");
  EXPECT_NEAR(model.A(0, 1).get_d(), 0.5, 1e-15);
  EXPECT_NEAR(model.E(0, 0).get_d(), 0.125, 1e-15);
  EXPECT_NEAR(model.c[0].get_d(), -0.25, 1e-15);
  EXPECT_NEAR(model.c[1].get_d(), -1.0, 1e-15);
}

}  // namespace
}  // namespace polyfly
