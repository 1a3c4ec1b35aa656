// Wind and scale of the airspeed from circles.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "identification/motion.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Circles through the air at 15 m/s that the airspeed sensor shows as 15 / scale.
FlightSignals makeCircles(double north, double east, double scale, double turns) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.2);
  FlightSignals signals;
  signals.source = "made circles";
  constexpr int kSamples = 1500;
  for (int i = 0; i < kSamples; ++i) {
    const double time = 0.1 * i;
    const double course = turns * 6.283185307 * i / kSamples;
    const double speed = 15.0 + std::sin(0.4 * time);
    const auto put = [&](const char* name, double value) {
      signals.series[name].time.push_back(time);
      signals.series[name].value.push_back(value + noise(random));
    };
    put("vn", speed * std::cos(course) + north);
    put("ve", speed * std::sin(course) + east);
    put("airspeed", speed / scale);
  }
  return signals;
}

TEST(Wind, FindsWindAndScaleOfTheAirspeed) {
  const WindFit found = fitWind(makeCircles(3.0, -5.0, 1.08, 3.0), {});
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_NEAR(found.parameters[0].value, 3.0, 0.1);
  EXPECT_NEAR(found.parameters[1].value, -5.0, 0.1);
  EXPECT_NEAR(found.parameters[2].value, 1.08, 0.01);
  for (const FittedParameter& parameter : found.parameters) EXPECT_GT(parameter.standard_error, 0.0);
  ASSERT_EQ(found.traces.size(), 1u);
  EXPECT_EQ(found.traces[0].measured.size(), found.north.size());
}

TEST(Wind, SaysWhereItTellsNothing) {
  const auto straight = fitWind(makeCircles(3.0, -5.0, 1.0, 0.2), {}).warnings;
  ASSERT_EQ(straight.size(), 1u);
  EXPECT_NE(straight[0].find("Fly circles"), std::string::npos);
  EXPECT_THROW(fitWind(makeCircles(0.0, 0.0, 1.0, 1.0), {{900.0, 901.0}}), Error);
  const auto knots = fitWind(makeCircles(3.0, -5.0, 0.514, 3.0), {}).warnings;
  ASSERT_EQ(knots.size(), 1u);
  EXPECT_NE(knots[0].find("another unit"), std::string::npos);
}

}  // namespace
}  // namespace polyfly
