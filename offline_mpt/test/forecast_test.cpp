// What the progress line says of an exploration's speed and of the time that is left.
#include <gtest/gtest.h>

#include <cmath>

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

TEST(Forecast, CountsHalfOfWhatTurnsUpWhileItFalls) {
  Forecast forecast;
  for (int second = 0; second <= 50; ++second) {
    forecast.add(second, 100u * second, 200u * second, second < 15 ? 900u : 1000u - 10u * second);
  }
  EXPECT_FALSE(forecast.atLeast());
  EXPECT_NEAR(forecast.remaining(), 500.0 / 200.0 / (1.0 - 0.5 * 0.95), 1e-9);
}

// Open sets while `described` of all are: they rise and fall as those of large counts do.
using OpenSets = double (*)(double share);
double slowlyFalling(double share) { return 0.64 * share * (1.0 - share); }
double quicklyFound(double share) { return (1.0 - std::exp(-4.0 * share)) / (1.0 - std::exp(-4.0)) - share; }

class ForecastToTheEnd : public testing::TestWithParam<OpenSets> {};

TEST_P(ForecastToTheEnd, IsNeverFarOff) {
  constexpr double kSeconds = 60.0, kStep = 0.1, kSets = 600'000.0;
  Forecast forecast;
  bool about = false;
  for (int k = 0; k < 595; ++k) {
    const double now = k * kStep;
    const double described = kSets * now / kSeconds, open = kSets * GetParam()(now / kSeconds);
    forecast.add(now, 0, static_cast<std::uint64_t>(described), static_cast<std::uint64_t>(open));
    const double left = kSeconds - now;
    if (forecast.remaining() >= 0.0 && forecast.atLeast()) {
      EXPECT_LT(forecast.remaining(), 1.01 * left) << "at " << now;
    }
    if (now < 0.7 * kSeconds) continue;
    about = about || !forecast.atLeast();
    EXPECT_GT(forecast.remaining(), 0.65 * left) << "at " << now;
    EXPECT_LT(forecast.remaining(), 1.35 * left) << "at " << now;
  }
  EXPECT_TRUE(about);
}

INSTANTIATE_TEST_SUITE_P(Explorations, ForecastToTheEnd, testing::Values(slowlyFalling, quicklyFound));

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
