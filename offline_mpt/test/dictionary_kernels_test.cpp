// The simplex kernels, which work on lanes, against plain loops: every length and every place of a tail.
#include "lp/dictionary_kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "random.hpp"

namespace polyfly {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kThreshold = 1e-10;
constexpr double kTie = 1e-14;
constexpr std::size_t kMostPlaces = 40;
constexpr int kWidth = 5;

/// Numbers of which many are zero or equal, as those of degenerate polytopes are.
std::vector<double> numbers(std::size_t count, Random& random) {
  std::vector<double> result(count);
  for (double& value : result)
    value = random.below(3) == 0 ? random.below(3) - 1.0 : random.uniform(-1.0, 1.0);
  return result;
}

Blocking plainRatio(const std::vector<double>& value, const std::vector<double>& coefficient, double sign,
                    std::size_t except) {
  std::vector<double> quotient(value.size(), kInfinity);
  for (std::size_t i = 0; i < value.size(); ++i) {
    const double c = coefficient[i] * sign;
    if (i != except && c > kThreshold) quotient[i] = std::max(value[i], 0.0) / c;
  }
  Blocking found{*std::min_element(quotient.begin(), quotient.end()), -1};
  double greatest = 0.0;
  for (std::size_t i = 0; i < value.size() && found.step < kInfinity; ++i) {
    if (quotient[i] > found.step + kTie || std::abs(coefficient[i]) <= greatest) continue;
    greatest = std::abs(coefficient[i]);
    found.place = static_cast<int>(i);
  }
  return found;
}

TEST(DictionaryKernels, TheLeastRatioAndWhatBlocksFirst) {
  Random random(1);
  for (std::size_t count = kLanes; count <= kMostPlaces; count += kLanes) {
    std::vector<double> quotient(count);
    for (std::size_t except = 0; except <= count; ++except) {
      for (const double sign : {-1.0, 1.0}) {
        const std::vector<double> value = numbers(count, random), coefficient = numbers(count, random);
        const Blocking plain = plainRatio(value, coefficient, sign, except);
        const Blocking found = leastRatio(value.data(), coefficient.data(), sign, kThreshold, kTie, except,
                                          count, quotient.data());
        EXPECT_EQ(found.step, plain.step) << count << " places, but " << except;
        EXPECT_EQ(found.place, plain.place) << count << " places, but " << except;
      }
    }
  }
}

TEST(DictionaryKernels, NothingBlocksWhereNothingFalls) {
  const std::vector<double> value(8, 1.0), coefficient(8, 1.0);
  std::vector<double> quotient(8);
  const Blocking found =
      leastRatio(value.data(), coefficient.data(), -1.0, kThreshold, kTie, 8, 8, quotient.data());
  EXPECT_EQ(found.step, kInfinity);
  EXPECT_EQ(found.place, -1);
}

TEST(DictionaryKernels, PlacesWhoseColumnsAreAllAboveTheThreshold) {
  Random random(2);
  int some = 0;
  for (std::size_t count = kLanes; count <= kMostPlaces; count += kLanes) {
    // Numbers between the columns do not count.
    const std::size_t stride = count + kLanes;
    for (int width = 1; width <= kWidth; ++width) {
      const std::vector<double> columns = numbers(stride * static_cast<std::size_t>(width), random);
      std::vector<int> plain, found(count);
      for (std::size_t i = 0; i < count; ++i) {
        bool above = true;
        for (int k = 0; k < width; ++k)
          above = above && columns[static_cast<std::size_t>(k) * stride + i] >= -0.2;
        if (above) plain.push_back(static_cast<int>(i));
      }
      found.resize(
          placesAbove(columns.data(), stride, count, static_cast<std::size_t>(width), -0.2, found.data()));
      EXPECT_EQ(found, plain) << count << " places, " << width << " columns";
      some += static_cast<int>(plain.size());
    }
  }
  EXPECT_GT(some, 100);
}

TEST(DictionaryKernels, PivotingAddsMultiplesOfTheColumnAndScalesIt) {
  Random random(3);
  for (std::size_t count = kLanes; count <= kMostPlaces; count += kLanes) {
    for (int width = 1; width <= kWidth; ++width) {
      for (int j = 0; j < width; ++j) {
        std::vector<double> columns = numbers(count * static_cast<std::size_t>(width), random);
        const std::vector<double> replacement = numbers(static_cast<std::size_t>(width), random);
        std::vector<double> plain = columns;
        const auto at = [count](int k, std::size_t i) { return static_cast<std::size_t>(k) * count + i; };
        for (int k = 0; k < width; ++k) {
          const double factor = replacement[static_cast<std::size_t>(k)];
          for (std::size_t i = 0; i < count; ++i)
            plain[at(k, i)] =
                k == j ? columns[at(j, i)] * factor : columns[at(k, i)] + columns[at(j, i)] * factor;
        }
        pivotColumns(columns.data(), count, count, static_cast<std::size_t>(width), replacement.data(),
                     static_cast<std::size_t>(j));
        EXPECT_EQ(columns, plain) << count << " places, column " << j << " of " << width;
      }
    }
  }
}

// What planes leave on their sides, beside a loop over planes and points; with points on a plane and no other points.
TEST(DictionaryKernels, WeighSidesCountsEachSideOnce) {
  constexpr std::size_t kStride = 2 * kLanes, kP = 3;
  constexpr double kTolerance = 1e-3;
  Random random(5);
  for (int sample = 0; sample < 200; ++sample) {
    const std::size_t others = static_cast<std::size_t>(sample) % 6;
    const std::vector<double> planes = numbers((kP + 1) * kStride, random);
    const std::vector<double> points = numbers((others + 1) * kP, random);
    std::vector<double> below(kStride, 1.0), above(kStride, 2.0);
    weighSides(planes.data(), kStride, kP, points.data(), {points.data() + kP, others}, kTolerance, 7.0,
               below.data(), above.data());
    for (std::size_t i = 0; i < kStride; ++i) {
      bool is_below = false, is_above = false;
      for (std::size_t k = 0; k <= others; ++k) {
        double distance = -planes[kP * kStride + i];
        for (std::size_t j = 0; j < kP; ++j) distance += planes[j * kStride + i] * points[k * kP + j];
        is_below = is_below || distance < -kTolerance;
        is_above = is_above || distance > kTolerance;
      }
      EXPECT_EQ(below[i], is_below ? 8.0 : 1.0);
      EXPECT_EQ(above[i], is_above ? 9.0 : 2.0);
    }
  }
}

}  // namespace
}  // namespace polyfly
