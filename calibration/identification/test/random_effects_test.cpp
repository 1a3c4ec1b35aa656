#include "identification/random_effects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace polyfly {
namespace {

// Area of Student's density up to the factor, by the midpoint rule; shares nothing with the table.
double shareWithin(double factor, int degrees) {
  constexpr int kSteps = 200000;
  const double nu = degrees;
  const double scale =
      std::exp(std::lgamma(0.5 * (nu + 1.0)) - std::lgamma(0.5 * nu)) / std::sqrt(nu * std::acos(-1.0));
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double at = factor * (i + 0.5) / kSteps;
    sum += std::pow(1.0 + at * at / nu, -0.5 * (nu + 1.0));
  }
  return 2.0 * scale * sum * factor / kSteps;
}

TEST(RandomEffects, FactorsAreThoseOfStudent) {
  for (const int degrees : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 15, 30, 200})
    EXPECT_NEAR(shareWithin(studentFactor(degrees), degrees), 0.95, 2e-5) << degrees;
}

TEST(RandomEffects, EqualErrorsGiveMeanAndDeviation) {
  // Sample variance 0.01; without what the errors explain 0.0075.
  const PooledValue pooled = poolFlights({{0.9, 0.05}, {1.0, 0.05}, {1.1, 0.05}});
  EXPECT_NEAR(pooled.value, 1.0, 1e-12);
  EXPECT_NEAR(pooled.standard_error, 0.1 / std::sqrt(3.0), 1e-9);
  EXPECT_NEAR(pooled.half_width, 4.3027 * 0.1 / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(pooled.between_flights, std::sqrt(0.0075), 1e-9);
}

TEST(RandomEffects, WithoutSpreadTheWeightsAreThoseOfTheErrors) {
  const PooledValue pooled = poolFlights({{1.0, 0.1}, {1.05, 0.2}});
  EXPECT_EQ(pooled.between_flights, 0.0);
  EXPECT_NEAR(pooled.value, (1.0 / 0.01 + 1.05 / 0.04) / (1.0 / 0.01 + 1.0 / 0.04), 1e-12);
  EXPECT_NEAR(pooled.standard_error, 1.0 / std::sqrt(125.0), 1e-12);
}

// The variance solves its equation: the weighted deviations are as many as the degrees of freedom.
TEST(RandomEffects, VarianceSolvesItsEquation) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> error(0.01, 0.2);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<FlightValue> flights;
    const std::size_t count = 2 + random() % 7;
    for (std::size_t i = 0; i < count; ++i) flights.push_back({1.0 + 0.3 * normal(random), error(random)});
    const PooledValue pooled = poolFlights(flights);
    double weight = 0.0;
    double deviations = 0.0;
    for (const FlightValue& flight : flights) {
      const double one = 1.0 / (flight.standard_error * flight.standard_error +
                                pooled.between_flights * pooled.between_flights);
      weight += one;
      deviations += one * (flight.value - pooled.value) * (flight.value - pooled.value);
    }
    EXPECT_NEAR(pooled.standard_error, 1.0 / std::sqrt(weight), 1e-9);
    if (pooled.between_flights > 0.0) {
      EXPECT_NEAR(deviations, static_cast<double>(count - 1), 1e-6);
    } else {
      EXPECT_LE(deviations, static_cast<double>(count - 1));
    }
  }
}

TEST(RandomEffects, TakesValuesWithoutError) {
  const double nothing = std::nan("");
  const PooledValue mixed = poolFlights({{0.1, nothing}, {0.2, 0.02}});
  EXPECT_NEAR(mixed.value, 0.15, 1e-9);
  const PooledValue none = poolFlights({{0.1, nothing}, {0.2, nothing}});
  EXPECT_NEAR(none.value, 0.15, 1e-9);
  EXPECT_NEAR(none.half_width, 12.7062 * 0.05, 1e-4);
  const PooledValue zero = poolFlights({{0.0, nothing}, {0.0, nothing}});
  EXPECT_EQ(zero.value, 0.0);
  EXPECT_TRUE(std::isnan(zero.half_width));
  const PooledValue same = poolFlights({{0.3, 0.0}, {0.3, 0.0}});
  EXPECT_NEAR(same.value, 0.3, 1e-12);
  EXPECT_LT(same.half_width, 1e-6);
}

// Values drawn about one mean, with errors and a spread of any ratio.
TEST(RandomEffects, IntervalsHoldTheMean) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const double spread : {0.0, 0.03, 0.1, 1.0}) {
    for (const int count : {2, 3, 5, 10}) {
      int inside = 0;
      for (int trial = 0; trial < 1000; ++trial) {
        std::vector<FlightValue> flights;
        for (int i = 0; i < count; ++i) {
          const double error = 0.02 * (1 + i % 3);
          flights.push_back({5.0 + spread * normal(random) + error * normal(random), error});
        }
        const PooledValue pooled = poolFlights(flights);
        inside += std::abs(pooled.value - 5.0) <= pooled.half_width ? 1 : 0;
      }
      EXPECT_GE(inside, 930) << spread << " " << count;
    }
  }
}

}  // namespace
}  // namespace polyfly
