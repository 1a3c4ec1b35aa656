// The parts beneath: dual simplex against GLPK, whole-number elimination, cuts by exact linear programs.
#include <gtest/gtest.h>

#include "../../test/glpk_lp.hpp"
#include "../../test/random.hpp"
#include "../src/integer_program.hpp"
#include "made_robust.hpp"

namespace polyfly {
namespace {

TEST(DualSimplex, AgreesWithGlpkWhileRowsAndParametersChange) {
  Random random(1);
  int infeasible = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 2 + random.below(8), h = 1 + random.below(3), rows = n + random.below(25);
    DualSimplex simplex(n, h);
    Eigen::MatrixXd A(0, n), E(0, h);
    for (int i = 0; i < rows; ++i) {
      const Eigen::VectorXd a = random.matrix(n, 1), e = random.matrix(h, 1);
      simplex.addRow(i, a.data(), e.data());
      A.conservativeResize(i + 1, n);
      E.conservativeResize(i + 1, h);
      A.row(i) = a;
      E.row(i) = e;
      if (i < n - 1 || i % 4 != 0) continue;
      const Eigen::VectorXd eta = random.matrix(h, 1);
      simplex.setParameters(eta.data());
      const DualSimplex::Status status = simplex.solve();
      Eigen::MatrixXd all(i + 2, n);
      all << A, -Eigen::RowVectorXd::Unit(n, n - 1);
      Eigen::VectorXd right(i + 2);
      right << E * eta, 0.0;
      const LpAnswer glpk = solveByGlpk(Eigen::VectorXd::Unit(n, n - 1), all, right);
      ASSERT_EQ(status == DualSimplex::Status::kOptimal, glpk.status == GLP_OPT) << trial << " " << i;
      if (status != DualSimplex::Status::kOptimal) {
        ++infeasible;
        continue;
      }
      ASSERT_NEAR(simplex.objective(), glpk.objective, 1e-7);
      // strong duality: the multipliers of tight rows make the bound
      double dual = 0.0;
      for (const DualSimplex::TightRow& row : simplex.tight()) {
        EXPECT_GE(row.multiplier, 0.0);
        dual -= row.multiplier * E.row(row.tag).dot(eta);
      }
      EXPECT_NEAR(dual, simplex.objective(), 1e-7);
    }
  }
  EXPECT_GT(infeasible, 5);
}

TEST(DualSimplex, ForgetsSlackRowsOnly) {
  Random random(2);
  const int n = 5;
  DualSimplex simplex(n, 1);
  for (int i = 0; i < 80; ++i) {
    Eigen::VectorXd a = random.matrix(n, 1);
    a[n - 1] = -std::abs(a[n - 1]) - 0.5;  // feasible where the last variable is large
    const double e = random.uniform(-1.0, 1.0);
    simplex.addRow(i, a.data(), &e);
  }
  const double one = 1.0;
  simplex.setParameters(&one);
  ASSERT_EQ(simplex.solve(), DualSimplex::Status::kOptimal);
  const double objective = simplex.objective();
  EXPECT_GT(objective, 0.01);
  ASSERT_TRUE(simplex.dropSlackest(20));
  EXPECT_EQ(simplex.rowCount(), 20);
  ASSERT_EQ(simplex.solve(), DualSimplex::Status::kOptimal);
  EXPECT_NEAR(simplex.objective(), objective, 1e-10);
}

TEST(WholeElimination, SolvesChecksAndTellsWhatIsFree) {
  using Rows = std::vector<std::vector<Integer>>;
  IntegerSolution solution = solveIntegers(Rows{{2, 1, 5}, {1, -3, -8}}, 2);
  EXPECT_TRUE(solution.consistent && solution.unique);
  EXPECT_EQ(solution.x.numerators[0], solution.x.denominator);
  EXPECT_EQ(solution.x.numerators[1], 3 * solution.x.denominator);
  solution = solveIntegers(Rows{{2, 1, 5}, {4, 2, 10}, {0, 0, 0}}, 2);
  EXPECT_TRUE(solution.consistent);
  EXPECT_FALSE(solution.unique);
  solution = solveIntegers(Rows{{2, 1, 5}, {4, 2, 11}}, 2);
  EXPECT_FALSE(solution.consistent);
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const int n = 1 + random.below(6);
    std::vector<Integer> x;
    for (int j = 0; j < n; ++j) x.emplace_back(random.below(21) - 10);
    Rows rows;
    for (int i = 0; i < n + 2; ++i) {
      std::vector<Integer> row;
      Integer sum;
      for (int j = 0; j < n; ++j) {
        row.emplace_back(random.below(5) - 2);
        sum += row.back() * x[static_cast<std::size_t>(j)];
      }
      row.push_back(sum);
      rows.push_back(row);
    }
    solution = solveIntegers(rows, n);
    ASSERT_TRUE(solution.consistent);
    for (const std::vector<Integer>& row : rows) {
      Integer sum;
      for (std::size_t j = 0; j < x.size(); ++j) sum += row[j] * solution.x.numerators[j];
      EXPECT_EQ(sum, row.back() * solution.x.denominator);
    }
  }
}

// Without any help from floating point: what the exact program cuts off is infeasible, what it leaves has a
// plan.
TEST(ExactCut, DecidesAnyPoint) {
  MadeRobust made;
  made.horizon = 4;
  made.stack = "shift";
  const RobustProgram program = buildRobustProgram(made.problem());
  const IntegerProgram whole(program);
  const FeasibleSet set = projectFeasibleSet(program);
  Random random(9);
  int cut = 0, left = 0;
  for (int k = 0; k < 60; ++k) {
    // between two vertices, perhaps beyond the second
    const auto pick = [&] {
      return set.vertices[static_cast<std::size_t>(random.below(static_cast<int>(set.vertices.size())))].y;
    };
    const RationalVector from = pick(), to = pick();
    const Rational share(random.below(13), 10);
    RationalVector y;
    for (std::size_t j = 0; j < from.size(); ++j) y.push_back(from[j] + share * (to[j] - from[j]));
    bool inside = true;
    for (const FeasibleSet::Facet& facet : set.facets)
      inside = inside && dot(facet.half_space.a, y) <= facet.half_space.b;
    RationalVector homogeneous{Rational(1)};
    homogeneous.insert(homogeneous.end(), y.begin(), y.end());
    const HomogeneousPoint point = wholeNumbers(homogeneous);
    // rows without predictions belong to every program
    std::vector<Scenario> start;
    for (std::size_t i = 0; i < program.rows.size(); ++i) {
      if (!program.rows[i].hasPredictions()) start.push_back({static_cast<int>(i), {}});
    }
    CommonFraction prediction;
    const std::optional<FeasibleSet::Facet> facet = exactCut(whole, point, start, prediction);
    ASSERT_EQ(!facet, inside);
    if (!facet) {
      EXPECT_TRUE(whole.holds(point, prediction));
      ++left;
      continue;
    }
    ++cut;
    EXPECT_GT(dot(facet->half_space.a, y), facet->half_space.b);
    for (const FeasibleSet::Vertex& vertex : set.vertices)
      EXPECT_LE(dot(facet->half_space.a, vertex.y), facet->half_space.b);
  }
  EXPECT_GT(cut, 5);
  EXPECT_GT(left, 5);
}

}  // namespace
}  // namespace polyfly
