// Linear programs in doubles against exact ones.
#include "lp/float_lp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "lp/box_maximum.hpp"

namespace polyfly {
namespace {

using Rows = std::vector<std::vector<double>>;

Rows unitRows(std::size_t dimension, double least_bound, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share;
  Rows rows(3 + random() % 20);
  for (std::vector<double>& row : rows) {
    double length = 0.0;
    for (std::size_t j = 0; j < dimension; ++j) {
      row.push_back(normal(random));
      length = std::hypot(length, row.back());
    }
    for (double& value : row) value /= length;
    row.push_back(least_bound + 0.5 * share(random));
  }
  return rows;
}

void addNearRows(int count, Rows& rows, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> digits(6.0, 13.0);
  for (int k = 0; k < count; ++k) {
    std::vector<double> row = rows[random() % rows.size()];
    const double noise = std::pow(10.0, -digits(random));
    for (double& value : row) value += noise * normal(random);
    rows.push_back(std::move(row));
  }
}

/// The sum of weights times rows and sides of the box.
std::vector<double> combination(const FloatLp& solver, const Rows& rows) {
  const std::size_t dimension = rows.front().size() - 1;
  std::vector<double> sum(dimension + 1);
  for (const auto& [row, weight] : solver.weights()) {
    EXPECT_GT(weight, 0.0);
    std::vector<double> side(dimension + 1);
    if (row >= solver.boxIndex(0)) {
      const int index = row - solver.boxIndex(0);
      side[static_cast<std::size_t>(index / 2)] = index % 2 == 0 ? 1.0 : -1.0;
      side.back() = 1.0;
    }
    const std::vector<double>& a_b = row < solver.boxIndex(0) ? rows[static_cast<std::size_t>(row)] : side;
    for (std::size_t j = 0; j <= dimension; ++j) sum[j] += weight * a_b[j];
  }
  return sum;
}

/// The answer in doubles beside the exact one: also among rows that nearly repeat each other, where the direction is
/// that of one of them. Weights combine to the direction, or to a contradiction.
TEST(FloatLp, AgreesWithTheExactProgram) {
  std::mt19937_64 random(17);
  constexpr double kError = 1e-9;
  constexpr int kBits = 80;
  int seen[2][2] = {};
  for (int k = 0; k < 600 && !::testing::Test::HasFailure(); ++k) {
    SCOPED_TRACE(k);
    const std::size_t dimension = 1 + random() % 6;
    const bool near = k % 2 == 1;
    Rows rows = unitRows(dimension, k % 4 < 2 ? 0.0 : -0.15, random);
    if (near) addNearRows(4, rows, random);
    const std::vector<double> direction(rows.back().begin(), rows.back().end() - 1);
    FloatLp solver(static_cast<int>(dimension));
    std::vector<std::vector<Integer>> whole;
    for (const std::vector<double>& row : rows) {
      solver.add(row);
      whole.emplace_back();
      for (const double value : row) whole.back().emplace_back(std::ldexp(value, kBits));
    }
    const FloatLp::Status status = solver.maximise(direction);
    const BoxMaximum maximum =
        maximiseInBox(whole, {whole.back().begin(), whole.back().end() - 1}, std::vector<int>());
    ++seen[near ? 1 : 0][maximum.exists ? 1 : 0];
    ASSERT_EQ(status, maximum.exists ? FloatLp::Status::kOptimal : FloatLp::Status::kInfeasible);
    EXPECT_EQ(solver.basis().size(), dimension);
    const double best = Rational(maximum.objective / Rational(Integer(1) << kBits)).get_d();
    if (maximum.exists) {
      EXPECT_NEAR(solver.objective(), best, kError);
    }
    if (near) continue;
    const std::vector<double> sum = combination(solver, rows);
    for (std::size_t j = 0; j < dimension; ++j)
      EXPECT_NEAR(sum[j], maximum.exists ? direction[j] : 0.0, kError);
    if (maximum.exists) {
      EXPECT_NEAR(sum.back(), best, kError);
    } else {
      EXPECT_LT(sum.back(), 0.0);
    }
  }
  for (const auto& [infeasible, feasible] : seen) {
    EXPECT_GT(infeasible, 50);
    EXPECT_GT(feasible, 50);
  }
}

// Rows beyond doubles occur in proofs: nothing of an earlier program may be taken for the answer.
TEST(FloatLp, NothingIsLeftWhereItFails) {
  FloatLp solver(2);
  for (const double bound : {0.5, 0.25}) solver.add({1.0, 0.0, bound});
  ASSERT_EQ(solver.maximise({1.0, 1.0}), FloatLp::Status::kOptimal);
  EXPECT_EQ(solver.basis().size(), 2u);
  solver.clear();
  solver.add({std::sqrt(0.5), std::sqrt(0.5), -std::numeric_limits<double>::infinity()});
  EXPECT_EQ(solver.maximise({1.0, 1.0}), FloatLp::Status::kFailed);
  EXPECT_TRUE(solver.basis().empty());
  EXPECT_TRUE(solver.weights().empty());
}

}  // namespace
}  // namespace polyfly
