// How the comparison of maps leaves out pairs: against exact maxima.
#include <gtest/gtest.h>

#include <deque>
#include <random>
#include <vector>

#include "certify/farkas_proof.hpp"
#include "certify/reduction/tree_partition.hpp"
#include "diff/linear_maximum.hpp"

namespace polyfly {
namespace {

// The bound of a maximum that is reached: rounding of the linear program, and what is added for it.
constexpr double kLooseness = 1e-9;

/// Half-spaces with whole numbers of random size, the first ones around the origin where `around`.
std::deque<ExactRow> randomRows(std::size_t p, bool around, std::mt19937& random) {
  std::deque<ExactRow> rows;
  for (int i = 0; i < 6; ++i) {
    std::vector<Rational> value;
    for (std::size_t j = 0; j < p; ++j) value.emplace_back(static_cast<int>(random() % 21) - 10);
    if (value.front() == 0) value.front() = 1;
    value.emplace_back(static_cast<int>(random() % 12) - (around ? 0 : 8), 3);
    value.back().canonicalize();
    rows.push_back(wholeRow(value));
  }
  return rows;
}

TEST(UpperBound, IsNearTheExactMaximumAndNeverBelow) {
  std::mt19937 random(5);
  int empty = 0, bounded = 0;
  for (int round = 0; round < 400; ++round) {
    const std::size_t p = 1 + random() % 4;
    const std::deque<ExactRow> own = randomRows(p, round % 2 == 0, random);
    std::vector<const ExactRow*> rows;
    for (const ExactRow& row : own) rows.push_back(&row);
    const bool claims_empty = upperBound(rows, std::vector<double>(p)) < 0.0;
    if (!findInterior(rows, nullptr, static_cast<int>(p)).exists) {
      empty += claims_empty ? 1 : 0;
      continue;
    }
    EXPECT_FALSE(claims_empty);
    std::vector<Rational> function(p + 1);
    std::vector<double> direction(p);
    for (std::size_t j = 0; j < p; ++j) {
      direction[j] = static_cast<int>(random() % 9) - 4;
      function[j] = direction[j];
    }
    const Rational maximum = maximise(rows, function).value;
    const double bound = upperBound(rows, direction);
    EXPECT_GE(Rational(bound), maximum);
    EXPECT_NEAR(bound, maximum.get_d(), kLooseness);
    ++bounded;
  }
  EXPECT_GT(empty, 50);
  EXPECT_GT(bounded, 100);
}

// Sets that only touch are not empty.
TEST(UpperBound, TouchingHalfSpacesAreNotEmpty) {
  const ExactRow left = wholeRow({Rational(-3), Rational(1)}), right = wholeRow({Rational(3), Rational(-1)});
  EXPECT_GE(upperBound({&left, &right}, {0.0}), 0.0);
  const ExactRow beyond = wholeRow({Rational(3), Rational(-1001, 1000)});
  EXPECT_LT(upperBound({&left, &beyond}, {0.0}), 0.0);
}

// A constant far beyond doubles gives no bound, and does no harm.
TEST(UpperBound, RowsBeyondDoublesAreLeftOut) {
  const ExactRow row = wholeRow({Rational(1), Rational(Integer(1) << 2000)});
  const ExactRow upper = wholeRow({Rational(-2), Rational(1)});
  EXPECT_NEAR(upperBound({&row, &upper}, {1.0}), 0.5, kLooseness);
  EXPECT_LE(upperBound({&row}, {1.0}), 1.0 + kLooseness);
}

}  // namespace
}  // namespace polyfly
