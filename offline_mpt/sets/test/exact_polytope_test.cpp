// Exact set operations against closed forms, brute force and GLPK.
#include "polytope_sets/exact_polytope.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "../../test/exact_volume.hpp"
#include "../../test/glpk_lp.hpp"
#include "../../test/random.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

RationalVector vector(std::initializer_list<const char*> texts) {
  RationalVector result;
  for (const char* text : texts) {
    Rational value;
    EXPECT_TRUE(parseRational(text, value)) << text;
    result.push_back(value);
  }
  return result;
}

ExactPolytope cube(int dimension) {
  const auto size = static_cast<std::size_t>(dimension);
  return ExactPolytope::box(RationalVector(size, Rational(-1)), RationalVector(size, Rational(1)));
}

ExactPolytope simplex(int dimension) {  // x >= 0, sum x <= 1
  ExactPolytope result;
  result.dimension = dimension;
  const auto size = static_cast<std::size_t>(dimension);
  result.rows.push_back({RationalVector(size, Rational(1)), Rational(1)});
  for (std::size_t j = 0; j < size; ++j) {
    ExactHalfSpace row{RationalVector(size), Rational(0)};
    row.a[j] = -1;
    result.rows.push_back(row);
  }
  return result;
}

std::vector<RationalVector> crossPoints(int dimension) {
  std::vector<RationalVector> points;
  for (int j = 0; j < 2 * dimension; ++j) {
    RationalVector point(static_cast<std::size_t>(dimension));
    point[static_cast<std::size_t>(j / 2)] = j % 2 == 0 ? 1 : -1;
    points.push_back(point);
  }
  return points;
}

Rational factorial(int n) { return n < 2 ? Rational(1) : Rational(n * factorial(n - 1)); }

/// Small fractions: coincidences are frequent.
ExactPolytope randomSet(Random& random, int dimension, int rows) {
  ExactPolytope result = cube(dimension);
  for (int i = 0; i < rows; ++i) {
    ExactHalfSpace row;
    for (int j = 0; j < dimension; ++j) row.a.emplace_back(random.below(7) - 3);
    row.b = Rational(random.below(9) - 1, 2);
    row.b.canonicalize();
    result.rows.push_back(row);
  }
  return result;
}

TEST(Rational, ReadsDecimalsAsTheyAreWritten) {
  EXPECT_EQ(vector({"0.1", "-2.5e-3", "7/21", "+4", "1e2", ".5"}),
            (RationalVector{Rational(1, 10), Rational(-1, 400), Rational(1, 3), Rational(4), Rational(100),
                            Rational(1, 2)}));
  Rational value;
  for (const char* text : {"", "-", "1/0", "1/-2", "0x1", "1e", "1e999", "nan", "inf", "1.2.3", "1 2",
                           "1/2/3", ".", "010", "-08", "010/2", "1/02", "--5"})
    EXPECT_FALSE(parseRational(text, value)) << text;
}

TEST(Rational, RoundsToTheNearestDouble) {
  EXPECT_EQ(nearestDouble(Rational(1, 10)), 0.1);
  EXPECT_EQ(nearestDouble(Rational(-2, 3)), -2.0 / 3.0);
  EXPECT_EQ(nearestDouble(Rational(0)), 0.0);
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const double x = random.uniform(-3.0, 3.0);
    EXPECT_EQ(nearestDouble(Rational(x)), x);
  }
}

TEST(ExactPolytope, VolumesOfKnownBodies) {
  for (int n = 1; n <= 6; ++n) {
    Integer power;
    mpz_ui_pow_ui(power.get_mpz_t(), 2, static_cast<unsigned long>(n));
    EXPECT_EQ(volume(cube(n)), Rational(power)) << n;
    EXPECT_EQ(volume(simplex(n)), Rational(1) / factorial(n)) << n;
    EXPECT_EQ(volume(hull(n, crossPoints(n))), Rational(power) / factorial(n)) << n;
  }
}

TEST(ExactPolytope, CountsFacetsAndVerticesOfKnownBodies) {
  for (int n = 2; n <= 6; ++n) {
    EXPECT_EQ(vertices(cube(n)).size(), std::size_t{1} << n);
    const ExactPolytope cross = hull(n, crossPoints(n));
    EXPECT_EQ(cross.rows.size(), std::size_t{1} << n);
    EXPECT_EQ(vertices(cross).size(), static_cast<std::size_t>(2 * n));
    EXPECT_EQ(hull(n, vertices(cube(n))).rows.size(), static_cast<std::size_t>(2 * n));
  }
}

TEST(ExactPolytope, EightDimensions) {
  EXPECT_EQ(vertices(cube(8)).size(), 256u);
  EXPECT_EQ(volume(simplex(8)), Rational(1, 40320));
  const ExactPolytope shadow = project(cube(8), {7, 0, 3});
  EXPECT_TRUE(equal(shadow, cube(3)));
}

// Vertices by solving every choice of rows: no code in common.
std::vector<RationalVector> verticesOfPolygon(const ExactPolytope& set) {
  std::vector<RationalVector> found;
  for (std::size_t i = 0; i < set.rows.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto& [a, b] = set.rows[i];
      const auto& [c, d] = set.rows[j];
      const Rational determinant = a[0] * c[1] - a[1] * c[0];
      if (determinant == 0) continue;
      RationalVector point{Rational((b * c[1] - a[1] * d) / determinant),
                           Rational((a[0] * d - b * c[0]) / determinant)};
      const auto holds = [&](const ExactHalfSpace& row) {
        return row.a[0] * point[0] + row.a[1] * point[1] <= row.b;
      };
      if (std::all_of(set.rows.begin(), set.rows.end(), holds)) found.push_back(point);
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

TEST(ExactPolytope, PolygonsAgreeWithBruteForce) {
  Random random(11);
  int empty = 0, flat = 0;
  for (int k = 0; k < 200; ++k) {
    const ExactPolytope set = randomSet(random, 2, 1 + random.below(7));
    const std::vector<RationalVector> expected = verticesOfPolygon(set);
    EXPECT_EQ(vertices(set), expected);
    EXPECT_EQ(affineDimension(set) < 0, expected.empty());
    const ExactPolytope smallest = minimal(set);
    EXPECT_TRUE(equal(smallest, set));
    EXPECT_EQ(vertices(smallest), expected);
    EXPECT_EQ(vertices(hull(2, expected)), expected);
    if (expected.size() >= 3) {
      EXPECT_EQ(smallest.rows.size(), expected.size()) << k;  // a polygon
      EXPECT_TRUE(smallest.equalities.empty());
    }
    empty += expected.empty() ? 1 : 0;
    flat += expected.size() == 1 || expected.size() == 2 ? 1 : 0;
    EXPECT_EQ(affineDimension(set),
              expected.empty() ? -1 : std::min(2, static_cast<int>(expected.size()) - 1));
  }
  EXPECT_GT(empty, 3);
  EXPECT_GT(flat, 3);
}

TEST(ExactPolytope, GreatestVerticesAgreeWithGlpk) {
  Random random(5);
  for (int k = 0; k < 60; ++k) {
    const int n = 2 + random.below(4);
    const ExactPolytope set = randomSet(random, n, 6);
    Eigen::MatrixXd A(static_cast<int>(set.rows.size()), n);
    Eigen::VectorXd b(A.rows()), g(n);
    RationalVector direction;
    for (int j = 0; j < n; ++j) direction.emplace_back(random.below(11) - 5);
    for (int j = 0; j < n; ++j) g[j] = -direction[static_cast<std::size_t>(j)].get_d();
    for (int i = 0; i < A.rows(); ++i) {
      for (int j = 0; j < n; ++j)
        A(i, j) = set.rows[static_cast<std::size_t>(i)].a[static_cast<std::size_t>(j)].get_d();
      b[i] = set.rows[static_cast<std::size_t>(i)].b.get_d();
    }
    const LpAnswer glpk = solveByGlpk(g, A, b);
    if (vertices(set).empty()) {
      EXPECT_EQ(glpk.status, GLP_NOFEAS);
      continue;
    }
    Rational greatest = dot(direction, vertices(set)[0]);
    for (const RationalVector& vertex : vertices(set)) greatest = std::max(greatest, dot(direction, vertex));
    EXPECT_NEAR(greatest.get_d(), -glpk.objective, 1e-9);
  }
}

TEST(ExactPolytope, AProjectionIsTheHullOfTheProjectedVertices) {
  Random random(8);
  for (int k = 0; k < 40; ++k) {
    const int n = 3 + random.below(2);
    const ExactPolytope set = randomSet(random, n, 5);
    const std::vector<int> keep = random.below(2) == 0 ? std::vector<int>{2, 0} : std::vector<int>{1};
    std::vector<RationalVector> points;
    for (const RationalVector& vertex : vertices(set)) {
      points.emplace_back();
      for (const int j : keep) points.back().push_back(vertex[static_cast<std::size_t>(j)]);
    }
    const ExactPolytope one = project(set, keep), other = hull(static_cast<int>(keep.size()), points);
    EXPECT_TRUE(equal(one, other)) << k;
    EXPECT_EQ(one.rows.size(), other.rows.size());
    // A point is in the shadow exactly where the fibre over it is not empty.
    for (int t = 0; t < 5; ++t) {
      RationalVector point;
      ExactPolytope fibre = set;
      for (const int j : keep) {
        point.push_back(Rational(random.below(9) - 4) / 4);
        fibre.equalities.push_back({RationalVector(static_cast<std::size_t>(n)), point.back()});
        fibre.equalities.back().a[static_cast<std::size_t>(j)] = 1;
      }
      EXPECT_EQ(contains(one, point), affineDimension(fibre) >= 0);
    }
  }
}

// Each point of a cube is in one simplex of it, or on faces of some; they have the cube's volume together.
TEST(ExactPolytope, SimplicesMakeUpTheSet) {
  Random random(5);
  for (int n = 2; n <= 4; ++n) {
    const std::vector<RationalVector> corners = vertices(cube(n));
    std::vector<ExactPolytope> parts;
    Rational sum;
    for (const std::vector<std::size_t>& simplex : triangulate(cube(n), corners)) {
      ASSERT_EQ(simplex.size(), static_cast<std::size_t>(n) + 1);
      std::vector<RationalVector> points;
      for (const std::size_t k : simplex) points.push_back(corners[k]);
      parts.push_back(hull(n, points));
      sum += volume(parts.back());
    }
    EXPECT_EQ(sum, volume(cube(n))) << n;
    for (int k = 0; k < 50; ++k) {
      RationalVector point;
      for (int j = 0; j < n; ++j) point.emplace_back(random.below(2001) - 1000, 1000);
      for (Rational& value : point) value.canonicalize();
      EXPECT_TRUE(std::any_of(parts.begin(), parts.end(),
                              [&](const ExactPolytope& part) { return contains(part, point); }));
    }
  }
}

TEST(ExactPolytope, PreimagesAndFlatSets) {
  RationalMatrix M(2, 3);
  M(0, 0) = 1, M(0, 2) = Rational(1, 2), M(1, 1) = -2;
  const RationalVector m{Rational(1), Rational(0)};
  const ExactPolytope image = ExactPolytope::box(vector({"-1/2", "-2"}), vector({"5/2", "2"}));
  EXPECT_TRUE(contains(preimage(image, M, m), cube(3)));
  EXPECT_FALSE(isBounded(preimage(image, M, m)));
  const std::vector<RationalVector> ends = {vector({"-1", "-1"}), vector({"1", "1"})};
  const ExactPolytope segment = hull(2, ends);
  EXPECT_EQ(affineDimension(segment), 1);
  EXPECT_EQ(volume(segment), 0);
  EXPECT_EQ(vertices(segment), ends);
}

TEST(ExactPolytope, UnboundedSets) {
  ExactPolytope quadrant;
  quadrant.dimension = 2;
  quadrant.rows = {{vector({"-1", "0"}), Rational(0)}, {vector({"0", "-1"}), Rational(0)}};
  EXPECT_FALSE(isBounded(quadrant));
  EXPECT_THROW(vertices(quadrant), Error);
  EXPECT_EQ(generators(quadrant).rays.size(), 2u);
  EXPECT_TRUE(equal(hull(2, generators(quadrant)), quadrant));
  EXPECT_FALSE(contains(cube(2), quadrant));
  ExactPolytope redundant = quadrant;
  redundant.rows.push_back({vector({"-1", "-1"}), Rational(1)});
  redundant.rows.push_back({vector({"0", "0"}), Rational(3)});
  EXPECT_EQ(minimal(redundant).rows.size(), 2u);
  EXPECT_EQ(project(quadrant, {0}).rows.size(), 1u);
}

TEST(ExactPolytope, RefusesWhatDoesNotFit) {
  EXPECT_THROW(intersect(cube(2), cube(3)), Error);
  EXPECT_THROW(project(cube(2), {0, 0}), Error);
  EXPECT_THROW(project(cube(2), {2}), Error);
  EXPECT_THROW(hull(2, std::vector<RationalVector>{vector({"1"})}), Error);
  EXPECT_THROW(contains(cube(2), vector({"1"})), Error);
  EXPECT_TRUE(vertices(hull(3, std::vector<RationalVector>())).empty());
}

}  // namespace
}  // namespace polyfly
