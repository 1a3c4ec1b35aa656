// What the progress line says of an exploration's speed and of the time that is left.
#include <gtest/gtest.h>

#include "progress.hpp"

namespace polyfly {
namespace {

TEST(Forecast, KnowsNothingAtFirst) {
  Forecast forecast;
  EXPECT_LT(forecast.remaining(), 0.0);
  EXPECT_EQ(forecast.regionsPerSecond(), 0.0);
  forecast.add(1.0, 10, 20, 5);
  EXPECT_LT(forecast.remaining(), 0.0);
  EXPECT_TRUE(forecast.atLeast());
}

TEST(Forecast, GivesALowerBoundWhileSetsTurnUp) {
  Forecast forecast;
  for (int second = 0; second <= 10; ++second) {
    forecast.add(second, 100u * second, 200u * second, 500u + 50u * second);
  }
  EXPECT_TRUE(forecast.atLeast());
  EXPECT_NEAR(forecast.regionsPerSecond(), 100.0, 1e-9);
  EXPECT_NEAR(forecast.remaining(), 1000.0 / 200.0, 1e-9);
}

TEST(Forecast, FollowsTheOpenSetsDown) {
  Forecast forecast;
  for (int second = 0; second <= 50; ++second) {
    forecast.add(second, 100u * second, 200u * second, second < 15 ? 900u : 1000u - 10u * second);
  }
  EXPECT_FALSE(forecast.atLeast());
  EXPECT_NEAR(forecast.remaining(), 500.0 / 10.0, 1e-9);
}

TEST(Forecast, DoesNotCountWhatACheckpointHeld) {
  Forecast forecast;
  forecast.add(0.1, 100000, 300000, 1000);
  forecast.add(1.1, 100050, 300100, 1000);
  EXPECT_NEAR(forecast.regionsPerSecond(), 50.0, 1e-9);
}

TEST(Forecast, KeepsFewOfManySamples) {
  Forecast forecast;
  for (int k = 0; k <= 100000; ++k) forecast.add(1e-4 * k, static_cast<std::uint64_t>(k), 0, 0);
  EXPECT_NEAR(forecast.regionsPerSecond(), 1e4, 1.0);
}

}  // namespace
}  // namespace polyfly
