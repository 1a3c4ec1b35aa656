#include "polyfly_test/flight_figure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kDifference = 1e-5;  // step of the difference quotients [s]
constexpr double kQuotient = 1e-6;    // their error [SI]
constexpr double kRest = 1e-12;

TEST(FlightFigure, DerivativesMatchDifferenceQuotients) {
  const FlightFigure figure{FigureOptions()};
  for (double t = 0.05; t < figure.duration(); t += 0.037) {
    const Reference before = figure.at(t - kDifference);
    const Reference here = figure.at(t);
    const Reference after = figure.at(t + kDifference);
    const double scale = 1.0 / (2.0 * kDifference);
    ASSERT_LT(((after.position - before.position) * scale - here.velocity).norm(), kQuotient) << t;
    ASSERT_LT(((after.velocity - before.velocity) * scale - here.acceleration).norm(), kQuotient) << t;
    ASSERT_LT(((after.acceleration - before.acceleration) * scale - here.jerk).norm(), kQuotient) << t;
    ASSERT_NEAR(std::remainder(after.yaw - before.yaw, 6.283185307179586) * scale, here.yaw_rate, kQuotient)
        << t;
  }
}

TEST(FlightFigure, JerkIsContinuous) {
  const FlightFigure figure{FigureOptions()};
  constexpr double kStep = 1e-4;
  constexpr double kGreatestSnap = 40.0;  // [m/s^4], reached in the climb
  for (double t = 0.0; t < figure.duration(); t += kStep) {
    ASSERT_LT((figure.at(t + kStep).jerk - figure.at(t).jerk).norm(), kGreatestSnap * kStep) << t;
  }
}

TEST(FlightFigure, StartsAndEndsAtRest) {
  FigureOptions options;
  options.start = Eigen::Vector3d(1.0, -2.0, 0.5);
  options.start_yaw = 0.3;
  const FlightFigure figure(options);
  const Reference first = figure.at(-1.0);
  EXPECT_EQ(first.position, options.start);
  EXPECT_EQ(first.velocity, Eigen::Vector3d::Zero());
  EXPECT_NEAR(first.yaw, 0.3, kRest);
  for (double t = figure.holdStart(); t < figure.duration() + 5.0; t += 0.1) {
    const Reference held = figure.at(t);
    EXPECT_LT((held.position - Eigen::Vector3d(1.0, -2.0, options.height)).norm(), 1e-9);
    EXPECT_LT(held.velocity.norm(), kRest);
    EXPECT_LT(held.acceleration.norm(), kRest);
    EXPECT_NEAR(std::remainder(held.yaw - 0.3 - options.yaw_turn, 6.283185307179586), 0.0, 1e-9);
  }
  EXPECT_NEAR(figure.duration() - figure.holdStart(), options.hold_time, 1e-9);
}

// The demonstration's figure is fast, and yet its steady-state input with lead, under any horizontal wind of
// 0.5 m/s^2, stays in the range |u_ref| <= 0.25 rad of the region maps with room for estimation errors.
TEST(FlightFigure, TheDefaultIsFastAndFitsTheMaps) {
  constexpr double kGravity = 9.8066;
  constexpr double kGain = 0.9;
  constexpr double kTime = 0.255;
  constexpr double kDrag = 0.01;
  constexpr double kWind = 0.5;
  constexpr double kLimit = 0.195;
  const FlightFigure figure{FigureOptions()};
  double speed = 0.0;
  double input = 0.0;
  double vertical = 0.0;
  double extent = 0.0;
  for (double t = 0.0; t < figure.duration(); t += 0.005) {
    const Reference r = figure.at(t);
    speed = std::max(speed, r.velocity.norm());
    vertical = std::max(vertical, std::abs(r.acceleration.z()));
    extent = std::max(extent, r.position.head<2>().norm());
    for (int axis = 0; axis < 2; ++axis) {
      const double angle = (r.acceleration[axis] + kDrag * r.velocity[axis]) / kGravity;
      const double angle_rate = (r.jerk[axis] + kDrag * r.acceleration[axis]) / kGravity;
      input = std::max(input, std::abs(angle + kTime * angle_rate) / kGain + kWind / (kGravity * kGain));
    }
  }
  RecordProperty("peak_speed", std::to_string(speed));
  RecordProperty("peak_input", std::to_string(input));
  EXPECT_GT(speed, 2.3);
  EXPECT_GT(extent, 3.9);
  EXPECT_LT(input, kLimit);
  EXPECT_LT(vertical, 1.0);
}

TEST(FlightFigure, SamplesCoverTheFlight) {
  FigureOptions options;
  options.sample_period = 0.02;
  const FlightFigure figure(options);
  const std::vector<Reference> points = figure.sample();
  EXPECT_GE(static_cast<double>(points.size() - 1) * 0.02, figure.duration());
  EXPECT_LT(static_cast<double>(points.size() - 2) * 0.02, figure.duration());
  EXPECT_EQ(points[700].position, figure.at(14.0).position);
  EXPECT_EQ(points[700].yaw, figure.at(14.0).yaw);
}

void expectRefused(const FigureOptions& options, const std::string& key) {
  try {
    FlightFigure figure(options);
    FAIL() << key << " was accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("figure: " + key), std::string::npos) << error.what();
  }
}

TEST(FlightFigure, BadOptionsAreRefusedByName) {
  FigureOptions options;
  options.laps = 0;
  expectRefused(options, "laps");
  options = FigureOptions();
  options.rate = std::numeric_limits<double>::quiet_NaN();
  expectRefused(options, "rate");
  options = FigureOptions();
  options.start.x() = std::numeric_limits<double>::infinity();
  expectRefused(options, "start");
  options = FigureOptions();
  options.blend_time = 100.0;
  expectRefused(options, "blend_time");
}

}  // namespace
}  // namespace polyfly
