// The small linear programs against GLPK.
#include "lp/polytope.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "glpk_lp.hpp"
#include "lp/rational_polytope.hpp"
#include "lp/tolerances.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kTolerance = 1e-9;  // facets must be violated by this much
constexpr double kAgreement = 1e-7;  // GLPK's own accuracy

/// Rows (a, b), |a| = 1, of a polytope in n dimensions.
struct Rows {
  int n = 0;
  std::vector<double> data;

  int count() const { return static_cast<int>(data.size()) / (n + 1); }
  const double* row(int i) const { return data.data() + static_cast<std::ptrdiff_t>(i) * (n + 1); }

  double slack(int i, const double* point) const {
    return row(i)[n] - std::inner_product(point, point + n, row(i), 0.0);
  }

  void add(const std::vector<double>& a, double b) {
    double squared = 0.0;
    for (const double value : a) squared += value * value;
    for (const double value : a) data.push_back(value / std::sqrt(squared));
    data.push_back(b / std::sqrt(squared));
  }
};

Rows box(int n, double half) {
  Rows rows{n, {}};
  for (int j = 0; j < n; ++j) {
    std::vector<double> a(n, 0.0);
    a[j] = 1.0;
    rows.add(a, half);
    a[j] = -1.0;
    rows.add(a, half);
  }
  return rows;
}

/// The greatest objective . t within the rows; with one number more in the objective that of (t, r), where r is added to each
/// row. The row `loosened` may be exceeded a little, so that the program stays bounded.
double glpkMaximum(const Rows& rows, const std::vector<double>& objective, int loosened = -1) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const RowMajor> all(rows.data.data(), rows.count(), rows.n + 1);
  RangedLp lp;
  lp.maximise = true;
  lp.tolerance = 1e-10;
  lp.c = Eigen::Map<const Eigen::VectorXd>(objective.data(), static_cast<Eigen::Index>(objective.size()));
  lp.A = Eigen::MatrixXd::Ones(all.rows(), lp.c.size());
  lp.A.leftCols(rows.n) = all.leftCols(rows.n);
  lp.columns.resize(objective.size());
  for (int i = 0; i < rows.count(); ++i)
    lp.rows.emplace_back().upper = all(i, rows.n) + (i == loosened ? 1.0 : 0.0);
  const LpAnswer answer = solveByGlpk(lp);
  EXPECT_EQ(answer.status, GLP_OPT);
  return answer.objective;
}

/// How far row i can be exceeded when the others hold.
double excess(const Rows& rows, int i) {
  return glpkMaximum(rows, {rows.row(i), rows.row(i) + rows.n}, i) - rows.row(i)[rows.n];
}

/// The box [-1, 1]^n with `cuts` more rows, which leave `least` to `most` between them and the origin.
Rows randomPolytope(int n, int cuts, std::mt19937_64& random, double least = 0.3, double most = 1.2) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(least, most);
  Rows rows = box(n, 1.0);
  for (int k = 0; k < cuts; ++k) {
    std::vector<double> a(n);
    double squared = 0.0;
    for (double& value : a) {
      value = normal(random);
      squared += value * value;
    }
    rows.add(a, uniform(random) * std::sqrt(squared));
  }
  return rows;
}

double largestRadius(const Rows& rows) {
  std::vector<double> objective(static_cast<std::size_t>(rows.n), 0.0);
  objective.push_back(1.0);
  return glpkMaximum(rows, objective);
}

class PolytopeOracle : public ::testing::TestWithParam<int> {};

TEST_P(PolytopeOracle, InscribedBallInTheBoxIsTheLargestOrHopeless) {
  const int n = GetParam();
  std::mt19937_64 random(100 + n);
  PolytopeSolver solver(n);
  int found = 0, hopeless = 0;
  for (int round = 0; round < 200; ++round) {
    Rows rows = randomPolytope(n, 1 + round % 40, random, -0.6, 1.2);
    if (round % 4 == 0) {  // flat: two opposite rows meet
      const std::vector<double> a(rows.row(rows.count() - 1), rows.row(rows.count() - 1) + n);
      std::vector<double> opposite(a);
      for (double& value : opposite) value = -value;
      rows.add(opposite, -rows.row(rows.count() - 1)[n]);
    }
    std::vector<double> centre(n, 0.0);
    double radius = 0.0;
    ASSERT_TRUE(solver.chebyshevInBox(rows.data.data(), rows.count(), centre.data(), radius));
    const double largest = largestRadius(rows);
    if (radius < -tolerance::kHopelessRadius) {  // a bound
      EXPECT_LE(largest, radius + kAgreement);
      ++hopeless;
      continue;
    }
    ++found;
    EXPECT_NEAR(radius, largest, kAgreement);
    for (int i = 0; i < rows.count(); ++i) EXPECT_GE(rows.slack(i, centre.data()), radius - 1e-12);
  }
  EXPECT_GT(found, 15);
  EXPECT_GT(hopeless, 15);
}

TEST_P(PolytopeOracle, InscribedBallIsTheLargest) {
  const int n = GetParam();
  std::mt19937_64 random(n);
  PolytopeSolver solver(n);
  for (int round = 0; round < 40; ++round) {
    const Rows rows = randomPolytope(n, 3 + round, random);
    std::vector<double> centre(n, 0.0);
    double radius = 0.0;
    ASSERT_TRUE(solver.chebyshev(rows.data.data(), rows.count(), centre.data(), radius));
    EXPECT_NEAR(radius, largestRadius(rows), kAgreement);
    for (int i = 0; i < rows.count(); ++i) EXPECT_GE(rows.slack(i, centre.data()), radius - 1e-12);
  }
}

/// Facets are the rows from `kept` on that can be exceeded alone.
void expectExceedable(const Rows& rows, int kept, const std::vector<int>& facets) {
  std::vector<char> facet(rows.count(), 0);
  for (const int i : facets) facet[i] = 1;
  for (int i = 0; i < rows.count(); ++i) {
    const double beyond = excess(rows, i);
    if (std::abs(beyond) < kAgreement) continue;  // too close for GLPK
    EXPECT_EQ(facet[i] != 0, i >= kept && beyond > 0.0) << "row " << i;
  }
}

TEST_P(PolytopeOracle, MinimalRowsAreThoseThatCanBeExceededAlone) {
  const int n = GetParam();
  std::mt19937_64 random(100 + n);
  PolytopeSolver solver(n);
  MinimalRows minimal;
  for (int round = 0; round < 25; ++round) {
    const Rows rows = randomPolytope(n, 4 + 2 * round, random);
    const std::vector<double> inside(n, 0.0);
    SCOPED_TRACE(::testing::Message() << "dimension " << n << " round " << round);
    ASSERT_TRUE(solver.minimal(rows.data.data(), rows.count(), inside.data(), kTolerance, minimal));
    expectExceedable(rows, 0, minimal.facets);
    for (std::size_t f = 0; f < minimal.facets.size(); ++f) {
      const double* point = minimal.beyond.data() + f * n;
      for (const int i : minimal.facets) {
        if (i == minimal.facets[f]) {
          EXPECT_LT(rows.slack(i, point), 0.0);
        } else {
          EXPECT_GE(rows.slack(i, point), -1e-10);
        }
      }
    }
  }
}

TEST_P(PolytopeOracle, RowsBesideOthersAreFoundFromTheInside) {
  const int n = GetParam();
  std::mt19937_64 random(400 + n);
  PolytopeSolver solver(n);
  MinimalRows minimal;
  for (int round = 0; round < 15; ++round) {
    const Rows rows = randomPolytope(n, 4 + 2 * round, random);
    const std::vector<double> inside(n, 0.0);
    for (const int kept : {0, n, rows.count() - 1}) {
      SCOPED_TRACE(::testing::Message() << "dimension " << n << " round " << round << " kept " << kept);
      ASSERT_TRUE(
          solver.minimalBeside(kept, rows.data.data(), rows.count(), inside.data(), kTolerance, minimal));
      expectExceedable(rows, kept, minimal.facets);
    }
  }
}

/// Box rows, and many more that touch corners or edges of the box, or cut some off.
Rows touchingRows(int n, int count, std::mt19937_64& random) {
  Rows rows = box(n, 1.0);
  std::uniform_int_distribution<int> entry(-2, 2);
  for (int k = 0; k < count; ++k) {
    std::vector<double> a(n, 0.0);
    double corner = 0.0;
    for (double& value : a) corner += std::abs(value = entry(random));
    if (corner == 0.0) continue;
    rows.add(a, k % 3 == 0 ? 0.8 * corner : k % 3 == 1 ? corner : corner + 0.02 * k);
  }
  return rows;
}

// What rows that were left out lose where loose rows are violated, beside GLPK's maximum of it.
TEST_P(PolytopeOracle, LeftOutRowsHoldWithinTheExcessOfLooseRows) {
  const int n = GetParam();
  constexpr double kAmount = 0.01, kMost = 5.0;
  std::mt19937_64 random(500 + n);
  PolytopeSolver solver(n);
  MinimalRows minimal;
  int left_out = 0, bounded = 0;
  for (int round = 0; round < 20; ++round) {
    const Rows rows = touchingRows(n, 3 + round, random);
    std::vector<char> is_asked(rows.count()), is_needed(rows.count(), 0);
    std::vector<double> amounts(rows.count());
    for (std::size_t i = 0; i < is_asked.size(); ++i) {
      const std::size_t kind = (i + round) % 4;
      is_asked[i] = kind < 2 ? 1 : 0;
      amounts[i] = kind < 2 ? kAmount : kind == 2 ? 1.5 * kAmount : 0.0;
    }
    const std::vector<double> inside(n, 0.0);
    ASSERT_TRUE(solver.minimalBeside(0, rows.data.data(), rows.count(), inside.data(), kTolerance, minimal,
                                     {amounts.data(), is_asked.data(), kAmount, kMost}));
    EXPECT_GE(minimal.excess, 1.0);
    for (const int i : minimal.facets) is_needed[i] = 1;
    if (minimal.excess > kMost) continue;
    ++bounded;
    Rows moved{n, {}};
    for (int i = 0; i < rows.count(); ++i) {
      if (is_asked[i] != 0 && is_needed[i] == 0) continue;
      moved.data.insert(moved.data.end(), rows.row(i), rows.row(i) + n + 1);
      moved.data.back() += amounts[i];
    }
    for (int i = 0; i < rows.count(); ++i) {
      if (is_asked[i] == 0 || is_needed[i] != 0) continue;
      ++left_out;
      const double beyond = glpkMaximum(moved, {rows.row(i), rows.row(i) + n}) - rows.row(i)[n];
      EXPECT_LE(beyond, minimal.excess * kAmount + kAgreement) << "round " << round << " row " << i;
    }
  }
  EXPECT_GE(bounded, 5);
  EXPECT_GE(left_out, n == 1 ? 1 : 10);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, PolytopeOracle, ::testing::Values(1, 2, 3, 4, 5, 6, 8));

TEST(Polytope, OneOfCoincidentRowsIsKept) {
  Rows rows = box(3, 1.0);
  for (int i = 0; i < 6; ++i) {
    const std::vector<double> a(rows.row(i), rows.row(i) + 3);
    rows.add(a, rows.row(i)[3]);
  }
  PolytopeSolver solver(3);
  MinimalRows minimal;
  const double inside[3] = {0.1, -0.2, 0.3};
  ASSERT_TRUE(solver.minimal(rows.data.data(), rows.count(), inside, kTolerance, minimal));
  EXPECT_EQ(minimal.facets.size(), 6u);
}

// At the apex of a many-sided pyramid all sides are tight at once: every pivot there is degenerate.
TEST(Polytope, PyramidKeepsAllItsSides) {
  constexpr int kSides = 24;
  Rows rows = box(3, 4.0);
  rows.add({0.0, 0.0, -1.0}, 0.0);
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2.0 * M_PI * k / kSides;
    rows.add({std::cos(angle), std::sin(angle), 1.0}, 1.0);
  }
  PolytopeSolver solver(3);
  MinimalRows minimal;
  const double inside[3] = {0.0, 0.0, 0.3};
  ASSERT_TRUE(solver.minimal(rows.data.data(), rows.count(), inside, kTolerance, minimal));
  EXPECT_EQ(minimal.facets.size(), kSides + 1u);
}

// Rows that only touch the polytope, at a vertex or along an edge, are not needed.
TEST(Polytope, TouchingRowsAreRedundant) {
  Rows rows = box(2, 1.0);
  rows.add({1.0, 1.0}, 2.0);
  rows.add({2.0, 1.0}, 3.0);
  PolytopeSolver solver(2);
  MinimalRows minimal;
  const double inside[2] = {0.0, 0.0};
  ASSERT_TRUE(solver.minimal(rows.data.data(), rows.count(), inside, kTolerance, minimal));
  EXPECT_EQ(minimal.facets, (std::vector<int>{0, 1, 2, 3}));
}

// What is left out may rest on what is left out later. Where all rows nearly meet in a point, the first ones were once violated
// by more than the tolerance.
TEST(Polytope, RowsThatAreLeftOutAreViolatedByTheToleranceAtMost) {
  constexpr double kLittle = 1e-10;
  int left_out = 0;
  for (const int n : {2, 3, 4}) {
    std::mt19937_64 random(40 + n);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    PolytopeSolver solver(n);
    for (int round = 0; round < 40; ++round) {
      Rows rows = box(n, 1.0);
      std::vector<double> a(n), interior(n, 0.0);
      for (int k = 0; k < 20; ++k) {
        for (double& entry : a) entry = uniform(random);
        a[0] = 1.0;
        rows.add(a, 0.3 + kLittle * uniform(random));  // about the point (0.3, 0, ...)
      }
      MinimalRows minimal;
      ASSERT_TRUE(solver.minimal(rows.data.data(), rows.count(), interior.data(), kLittle, minimal));
      Rows needed{n, {}};
      for (const int facet : minimal.facets)
        needed.data.insert(needed.data.end(), rows.row(facet), rows.row(facet) + n + 1);
      for (int i = 0; i < rows.count(); ++i) {
        std::vector<double> point(n);
        ASSERT_TRUE(maximiseRationally(n, needed.data.data(), needed.count(), interior.data(), rows.row(i),
                                       point.data()));
        const double violation = -rows.slack(i, point.data());
        EXPECT_LE(violation, 1.001 * kLittle) << n << " " << round << " " << i;
        left_out += violation > 0.1 * kLittle ? 1 : 0;
      }
      for (std::size_t k = 0; k < minimal.facets.size(); ++k) {
        const double* const point = minimal.beyond.data() + k * static_cast<std::size_t>(n);
        for (const int other : minimal.facets) {
          const double violation = -rows.slack(other, point);
          if (other == minimal.facets[k])
            EXPECT_GT(violation, kLittle) << n << " " << round << " " << other;
          else
            EXPECT_LE(violation, 10.0 * kLittle) << n << " " << round << " " << other;
        }
      }
    }
  }
  EXPECT_GT(left_out, 20);
}

TEST(Polytope, ThinSlabHasTheRadiusOfItsHalfThickness) {
  for (const double half : {1e-3, 1e-6, 1e-9}) {
    Rows rows = box(4, 1.0);
    rows.add({1.0, 2.0, -1.0, 0.5}, half * std::sqrt(6.25));
    rows.add({-1.0, -2.0, 1.0, -0.5}, half * std::sqrt(6.25));
    PolytopeSolver solver(4);
    std::vector<double> centre(4, 0.7);
    double radius = 0.0;
    ASSERT_TRUE(solver.chebyshev(rows.data.data(), rows.count(), centre.data(), radius));
    EXPECT_NEAR(radius, half, 1e-6 * half + 1e-15);
  }
}

TEST(Polytope, EmptyPolytopeHasNegativeRadius) {
  Rows rows = box(3, 1.0);
  rows.add({1.0, 0.0, 0.0}, -0.2);
  rows.add({-1.0, 0.0, 0.0}, -0.3);
  PolytopeSolver solver(3);
  std::vector<double> centre(3, 0.0);
  double radius = 0.0;
  ASSERT_TRUE(solver.chebyshev(rows.data.data(), rows.count(), centre.data(), radius));
  EXPECT_NEAR(radius, -0.25, 1e-12);
}

Furthest rationally(int dimension) {
  return [dimension](const double* rows, int count, const double* start, const double* direction,
                     double* point) {
    return maximiseRationally(dimension, rows, count, start, direction, point);
  };
}

// What PolytopeSolver falls back on, beside it: the same rows are needed, the same points furthest out.
TEST(RationalPolytope, AnswersAsTheSolverInDoubles) {
  for (const int n : {1, 2, 3, 4, 6}) {
    std::mt19937_64 random(300 + n);
    PolytopeSolver solver(n);
    const std::vector<double> inside(n, 0.0);
    for (int round = 0; round < 6; ++round) {
      const Rows rows = randomPolytope(n, 3 + 3 * round, random);
      MinimalRows expected, minimal;
      ASSERT_TRUE(solver.minimal(rows.data.data(), rows.count(), inside.data(), kTolerance, expected));
      ASSERT_TRUE(minimalOneByOne(0, n, rows.data.data(), rows.count(), inside.data(), kTolerance,
                                  rationally(n), minimal));
      EXPECT_EQ(minimal.facets, expected.facets) << "dimension " << n << " round " << round;
      std::vector<double> direction(n), furthest(n), point(n);
      for (double& entry : direction) entry = std::uniform_real_distribution<double>(-1.0, 1.0)(random);
      ASSERT_TRUE(
          solver.support(rows.data.data(), rows.count(), inside.data(), direction.data(), furthest.data()));
      ASSERT_TRUE(maximiseRationally(n, rows.data.data(), rows.count(), inside.data(), direction.data(),
                                     point.data()));
      double difference = 0.0;
      for (int j = 0; j < n; ++j) difference += direction[j] * (point[j] - furthest[j]);
      EXPECT_NEAR(difference, 0.0, 1e-12);
    }
  }
}

// Degenerate at every pivot, and with pairs of rows that differ by less than a double's last bits can tell.
TEST(RationalPolytope, EndsWhereRowsNearlyCoincide) {
  Rows rows = box(3, 1.0);
  for (int k = 0; k < 12; ++k) {
    rows.add({1.0, 1.0 + 1e-15 * k, 1.0}, 1.0);
    rows.add({1.0, 1.0, 1.0 - 1e-14 * k}, 1.0 + 1e-16 * k);
  }
  const double inside[3] = {0.0, 0.0, 0.0};
  const double direction[3] = {1.0, 1.0, 1.0};
  double point[3];
  ASSERT_TRUE(maximiseRationally(3, rows.data.data(), rows.count(), inside, direction, point));
  EXPECT_NEAR(point[0] + point[1] + point[2], 1.0, 1e-12);
  MinimalRows minimal;
  ASSERT_TRUE(
      minimalOneByOne(0, 3, rows.data.data(), rows.count(), inside, kTolerance, rationally(3), minimal));
  EXPECT_EQ(minimal.facets.size(), 7u);
}

TEST(RationalPolytope, SaysWhenThereIsNoEnd) {
  Rows rows{2, {}};
  rows.add({1.0, 0.0}, 1.0);
  rows.add({0.0, 1.0}, 1.0);
  const double inside[2] = {0.0, 0.0};
  const double up[2] = {1.0, 1.0};
  const double down[2] = {-1.0, 0.0};
  double point[2];
  EXPECT_TRUE(maximiseRationally(2, rows.data.data(), rows.count(), inside, up, point));
  EXPECT_FALSE(maximiseRationally(2, rows.data.data(), rows.count(), inside, down, point));
  rows.data.back() = std::nan("");
  EXPECT_FALSE(maximiseRationally(2, rows.data.data(), rows.count(), inside, up, point));
}

TEST(Polytope, RefusesDimensionsItHasNoKernelFor) {
  EXPECT_THROW(PolytopeSolver(0), Error);
  EXPECT_THROW(PolytopeSolver(PolytopeSolver::kMaxDimension + 1), Error);
}

}  // namespace
}  // namespace polyfly
