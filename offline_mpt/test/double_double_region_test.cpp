// Numbers of 32 digits, and active sets described with them, against rational arithmetic.
#include "explore/region/double_double_region.hpp"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "arithmetic/tolerances.hpp"
#include "exact_kkt/exact_description.hpp"
#include "made_program.hpp"
#include "random.hpp"

namespace polyfly {
namespace {

mpq_class exactly(const DoubleDouble& value) { return mpq_class(value.high) + mpq_class(value.low); }

/// Of 32 digits; some are doubles, some nearly cancel against others.
DoubleDouble longNumber(Random& random) {
  const double high = std::ldexp(random.uniform(-1.0, 1.0), random.below(9) - 4);
  return random.below(4) == 0 ? DoubleDouble(high)
                              : orderedSum(high, 0x1p-53 * high * random.uniform(-0.5, 0.5));
}

void expectNear(const DoubleDouble& found, const mpq_class& truth, const mpq_class& size) {
  const mpq_class error = exactly(found) - truth;
  EXPECT_LE(mpq_class(abs(error)), size * mpq_class(8.0 * tolerance::kDoubleDoubleRounding));
  EXPECT_LE(std::abs(found.low), std::abs(found.high) * 0x1p-53);
}

TEST(DoubleDouble, OperationsLoseNoMoreThanStated) {
  Random random(1);
  constexpr int kPairs = 20'000;
  for (int i = 0; i < kPairs; ++i) {
    const DoubleDouble a = longNumber(random);
    DoubleDouble b = longNumber(random);
    if (i % 3 == 0) b = DoubleDouble(-a.high, random.uniform(-1.0, 1.0) * 0x1p-54 * a.high);
    const mpq_class x = exactly(a), y = exactly(b);
    expectNear(a + b, x + y, abs(x) + abs(y));
    expectNear(a - b, x - y, abs(x) + abs(y));
    expectNear(a * b, x * y, abs(x * y));
    expectNear(a / b, x / y, abs(x / y));
  }
}

TEST(DoubleDouble, ARootSquaredIsTheNumber) {
  Random random(2);
  constexpr int kNumbers = 5'000;
  for (int i = 0; i < kNumbers; ++i) {
    DoubleDouble a = longNumber(random);
    if (a.high < 0.0) a = -a;
    const mpq_class root = exactly(sqrt(a)), x = exactly(a);
    EXPECT_LE(mpq_class(abs(root * root - x)), x * mpq_class(8.0 * tolerance::kDoubleDoubleRounding));
  }
  EXPECT_EQ(sqrt(DoubleDouble(0.0)).high, 0.0);
}

/// A program of which row 1 is row 0 but for `distance`, relative.
ParametricProgram nearlyDependent(std::uint64_t seed, double distance) {
  ParametricProgram program = madeProgram(seed, {5, 14, 3});
  Random random(seed + 1000);
  program.A.row(1) = program.A.row(0) + distance * random.matrix(1, program.variableCount());
  program.f = random.matrix(program.variableCount(), 1);
  program.parameters[0].lower = -0.7;
  program.C = random.matrix(program.inputCount(), program.parameterCount());
  program.c = random.matrix(program.inputCount(), 1);
  return program;
}

std::vector<std::uint16_t> activeSet(int rows, int most, Random& random) {
  std::vector<std::uint16_t> all(static_cast<std::size_t>(rows));
  std::iota(all.begin(), all.end(), std::uint16_t{0});
  for (std::size_t i = 2; i < all.size(); ++i)
    std::swap(all[i], all[2 + static_cast<std::size_t>(random.below(rows - 2))]);
  all.resize(2 + static_cast<std::size_t>(random.below(most - 1)));  // rows 0 and 1 among them
  std::sort(all.begin(), all.end());
  return all;
}

struct Compared {
  double size = 1.0;
  double error = 0.0;

  void add(const std::vector<double>& found, const std::vector<double>& truth) {
    for (std::size_t j = 0; j < truth.size(); ++j) {
      size = std::max(size, std::abs(truth[j]));
      error = std::max(error, std::abs(found[j] - truth[j]));
    }
  }
};

TEST(DoubleDoubleRegionSolver, AgreesWithRationalArithmeticWhereRowsAreNearlyDependent) {
  constexpr double kRoundedTwice = 1e-15;
  int described = 0;
  for (const double distance : {1.0, 1e-3, 1e-5, 1e-6}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const NormalisedProgram reduced = normalise(nearlyDependent(seed, distance));
      DoubleDoubleRegionSolver by_digits(reduced);
      ExactDescription exact(reduced);
      Random random(seed);
      const auto active = activeSet(reduced.m, reduced.n, random);
      if (!by_digits.solve(active)) continue;
      ASSERT_EQ(exact.solve(active), ExactStatus::kRegion);
      ++described;
      Compared multipliers, others;
      std::vector<double> found(static_cast<std::size_t>(reduced.p) + 1), truth(found.size());
      for (std::size_t r = 0; r < active.size(); ++r) {
        by_digits.multiplier(r, found.data());
        exact.multiplier(r, truth.data());
        multipliers.add(found, truth);
      }
      others.size = multipliers.size;
      for (int row = 0; row < reduced.m; ++row) {
        by_digits.slack(row, found.data());
        exact.slack(row, truth.data());
        others.add(found, truth);
      }
      by_digits.law(found);
      exact.law(truth);
      ASSERT_EQ(found.size(), truth.size());
      others.add(found, truth);
      EXPECT_LE(multipliers.error, kRoundedTwice * multipliers.size) << distance << ", seed " << seed;
      EXPECT_LE(others.error, kRoundedTwice * others.size) << distance << ", seed " << seed;
    }
  }
  EXPECT_GE(described, 60);
}

// Multipliers of 1e6 and slacks of order one come out with all digits of a double.
TEST(DoubleDoubleRegionSolver, SlacksAreRoundedOnce) {
  const NormalisedProgram reduced = normalise(nearlyDependent(3, 1e-5));
  DoubleDoubleRegionSolver by_digits(reduced);
  ExactDescription exact(reduced);
  ASSERT_TRUE(by_digits.solve({0, 1, 4}));
  ASSERT_EQ(exact.solve({0, 1, 4}), ExactStatus::kRegion);
  std::vector<double> found(4), truth(4);
  for (int row = 0; row < reduced.m; ++row) {
    by_digits.slack(row, found.data());
    exact.slack(row, truth.data());
    for (std::size_t j = 0; j < truth.size(); ++j)
      EXPECT_NEAR(found[j], truth[j], 4e-16 * std::max(1.0, std::abs(truth[j]))) << "row " << row;
  }
}

TEST(DoubleDoubleRegionSolver, LeavesToRationalArithmeticWhatItCannotDecide) {
  const std::vector<std::uint16_t> both = {0, 1};
  EXPECT_FALSE(DoubleDoubleRegionSolver(normalise(nearlyDependent(1, 1e-9))).solve(both));
  ParametricProgram program = madeProgram(1, {4, 8, 2});
  EXPECT_TRUE(DoubleDoubleRegionSolver(normalise(program)).solve(both));
  program.equalities = {7};
  EXPECT_FALSE(DoubleDoubleRegionSolver(normalise(program)).solve(both));
  program.equalities.clear();
  program.H.setZero();
  program.F.setZero();
  program.f.setOnes();
  EXPECT_FALSE(DoubleDoubleRegionSolver(normalise(program)).solve(both));
}

}  // namespace
}  // namespace polyfly
