#include "cell_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "glpk_lp.hpp"

namespace checker {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A random box with random half-spaces.
struct RandomCell {
  Box box;
  std::vector<std::vector<double>> normals;
  std::vector<double> limits;
  std::vector<double> function;

  RandomCell(std::mt19937_64& random, std::size_t p, std::size_t rows) {
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < p; ++i) {
      const double centre = normal(random);
      const double half = std::exp(normal(random));
      box.lower.push_back(centre - half);
      box.upper.push_back(centre + half);
      function.push_back(normal(random));
    }
    for (std::size_t k = 0; k < rows; ++k) {
      normals.emplace_back();
      for (std::size_t i = 0; i < p; ++i) normals.back().push_back(normal(random));
      limits.push_back(normal(random) + 0.5);
    }
  }

  Cell cell() const {
    Cell result(box);
    for (std::size_t k = 0; k < limits.size(); ++k) result.add({normals[k].data(), 1.0, limits[k]});
    return result;
  }

  /// The greatest value by GLPK; minus infinity where it finds no point.
  double greatestByGlpk() const {
    polyfly::RangedLp lp;
    lp.maximise = true;
    const auto p = static_cast<Eigen::Index>(box.size());
    lp.c = Eigen::Map<const Eigen::VectorXd>(function.data(), p);
    lp.A.resize(static_cast<Eigen::Index>(limits.size()), p);
    for (std::size_t i = 0; i < box.size(); ++i) lp.columns.push_back({box.lower[i], box.upper[i]});
    for (std::size_t k = 0; k < limits.size(); ++k) {
      lp.A.row(static_cast<Eigen::Index>(k)) = Eigen::Map<const Eigen::RowVectorXd>(normals[k].data(), p);
      lp.rows.push_back({-kInfinity, limits[k]});
    }
    const polyfly::LpAnswer answer = polyfly::solveByGlpk(lp);
    return answer.status == GLP_OPT ? answer.objective : -kInfinity;
  }
};

TEST(CellBound, IsTheGreatestValueThatGlpkFinds) {
  std::mt19937_64 random(3);
  int empty = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const RandomCell made(random, 1 + trial % 6, random() % 25);
    Cell cell = made.cell();
    const double expected = made.greatestByGlpk();
    const double bound = cell.upperBound(made.function, 0.0);
    EXPECT_EQ(cell.isEmpty(), expected == -kInfinity) << trial;
    if (expected == -kInfinity) {
      ++empty;
      EXPECT_EQ(bound, -kInfinity) << trial;
    } else {
      EXPECT_NEAR(bound, expected, 1e-7 * (1.0 + std::abs(expected))) << trial;
    }
  }
  EXPECT_GT(empty, 200);
  EXPECT_LT(empty, 1800);
}

// The bound holds at every point of the cell without any tolerance.
TEST(CellBound, NoPointExceedsIt) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 300; ++trial) {
    const RandomCell made(random, 3, 4);
    Cell cell = made.cell();
    const double bound = cell.upperBound(made.function, 0.25);
    for (int i = 0; i < 200; ++i) {
      std::vector<double> theta;
      for (std::size_t k = 0; k < 3; ++k)
        theta.push_back(std::uniform_real_distribution<double>(made.box.lower[k], made.box.upper[k])(random));
      const auto product = [&theta](const std::vector<double>& a) {
        return a[0] * theta[0] + a[1] * theta[1] + a[2] * theta[2];
      };
      bool is_inside = true;
      for (std::size_t k = 0; k < made.limits.size(); ++k)
        is_inside = is_inside && product(made.normals[k]) <= made.limits[k];
      if (!is_inside) continue;
      ASSERT_LE(product(made.function) + 0.25, bound);
    }
  }
}

// Layers as thin as rounding are found, and layers that miss one another by as little.
TEST(CellBound, ThinLayersAreToldFromEmptyOnes) {
  const Box box = {{-1.0, -2.0}, {3.0, 2.0}};
  const std::vector<double> normal = {0.6, 0.8};
  for (const double gap : {1e-6, 1e-9, 1e-12}) {
    Cell layer(box);
    layer.add({normal.data(), 1.0, 0.5});
    layer.add({normal.data(), -1.0, -(0.5 - gap)});
    EXPECT_FALSE(layer.isEmpty()) << gap;
    Cell missed(box);
    missed.add({normal.data(), 1.0, 0.5});
    missed.add({normal.data(), -1.0, -(0.5 + gap)});
    EXPECT_TRUE(missed.isEmpty()) << gap;
  }
}

TEST(CellBound, ABoxWithoutWidthHasAPoint) {
  const Box box = {{1.0, 2.0}, {1.0, 2.0}};
  Cell cell(box);
  EXPECT_FALSE(cell.isEmpty());
  EXPECT_NEAR(cell.upperBound({1.0, 10.0}, 0.5), 21.5, 1e-12);
}

}  // namespace
}  // namespace checker
