// The configuration as published: its values, its file, and its flights over the chapter's figures.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "fixedwing_lateral/lateral_parameters.hpp"
#include "fixedwing_plant/figures.hpp"
#include "fixedwing_plant/flight_metrics.hpp"
#include "polyfly_base/read_text.hpp"

namespace {

using namespace polyfly;

/// All options by name, as text.
struct Listing {
  std::vector<std::string> entries;

  void operator()(const char* name, bool value) {
    entries.push_back(name + std::string(value ? "=true" : "=false"));
  }
  void operator()(const char* name, int value, const char*, const Range&) {
    entries.push_back(name + ("=" + std::to_string(value)));
  }
  void operator()(const char* name, double value, const char*, const Range&) {
    entries.push_back(name + ("=" + std::to_string(value)));
  }
};

std::vector<std::string> listed(const GuidanceOptions& options) {
  Listing listing;
  visitGuidance(options, listing);
  listing("feedforward", options.weights.feedforward, "", Range{});
  listing("curvature", options.weights.curvature, "", Range{});
  listing("smooth_radius", options.criterion.smooth_radius, "", Range{});
  listing("at_bisector", options.criterion.at_bisector);
  listing("corrects_wind", options.corrects_wind);
  listing("learns_disturbance", options.learns_disturbance);
  listing("chooses_side", options.chooses_side);
  listing("falls_back", options.falls_back);
  return listing.entries;
}

TEST(Published, HasTheValuesOfTheChapter) {
  const GuidanceOptions options = publishedGuidance();
  EXPECT_EQ(options.horizon.horizon, 40);
  EXPECT_EQ(options.horizon.step, 0.1);
  EXPECT_EQ(options.period, 0.05);
  EXPECT_EQ(options.weights.track, 0.01);
  EXPECT_EQ(options.weights.course, 10.0);
  EXPECT_EQ(options.weights.roll, 0.1);
  EXPECT_EQ(options.weights.roll_rate, 0.01);
  EXPECT_EQ(options.weights.roll_reference, 10.0);
  EXPECT_EQ(options.weights.slew, 100.0);
  EXPECT_EQ(options.weights.feedforward, 0.0);
  EXPECT_EQ(options.weights.curvature, 0.0);
  EXPECT_EQ(options.weights.airspeed, 0.0);
  EXPECT_NEAR(options.limits.roll_reference, 35.0 * kPi / 180.0, 1e-12);
  EXPECT_EQ(options.criterion.acceptance_radius, 35.0);
  EXPECT_EQ(options.criterion.smooth_radius, 35.0);
  EXPECT_EQ(kCourseTolerance, kPi / 4.0);
  EXPECT_EQ(kSwitchRate, 1.0);
  EXPECT_EQ(kSwitchThreshold, 0.05);
  for (const bool addition : {options.criterion.at_bisector, options.corrects_wind,
                              options.learns_disturbance, options.chooses_side, options.falls_back})
    EXPECT_FALSE(addition);
  EXPECT_NO_THROW(checkGuidance(options, "published"));
}

TEST(Published, IsTheFileOfTheLaunchFolder) {
  const char* root = std::getenv("POLYFLY_ROOT");
  ASSERT_NE(root, nullptr);
  const std::string path = std::string(root) + "/launch/config/techpod_published.yaml";
  const LateralParameters parameters = parseLateralParameters(readText(path), path);
  EXPECT_TRUE(parameters.as_published);
  EXPECT_EQ(listed(parameters.guidance), listed(publishedGuidance()));
}

FlightMetrics fly(const Mission& mission, const GuidanceOptions& options) {
  AircraftState start;
  start.ground_velocity = {14.0, 0.0};
  ChapterAircraft aircraft(LateralModel{}, start, 14.0, {0.0, 0.0});
  LateralGuidance guidance(options, "test");
  guidance.setMission(mission);
  Sensors sensors({}, 7);
  const auto samples = flyLaw(aircraft, sensors, lawOf(guidance), options.period, 240.0);
  for (const FlightSample& sample : samples) {
    EXPECT_EQ(sample.output.mode, GuidanceMode::kTracking);
    EXPECT_EQ(sample.output.roll_bias, 0.0);
    EXPECT_EQ(sample.output.turn_gain, 1.0);
  }
  EXPECT_EQ(samples.back().output.segment + 1, static_cast<int>(mission.segments.size()));
  return flightMetrics(mission.segments, samples, 0.5, 7.0);
}

// The chapter reports less than 1 m on each line and on the loiter, in calm.
TEST(Published, FliesTheBoxOfTheChapter) {
  const FlightMetrics metrics = fly(boxFigure(), publishedGuidance());
  EXPECT_LT(metrics.converged, 1.0);
  EXPECT_LT(metrics.loiter, 1.0);
  EXPECT_LT(metrics.overshoot, 5.0);
  EXPECT_LE(metrics.roll_largest, 0.62);
}

// The chapter reports less than 3 m after convergence to the path.
TEST(Published, FliesADubinsSequenceOfTheChapter) {
  const FlightMetrics metrics = fly(dubinsFigure(), publishedGuidance());
  EXPECT_LT(metrics.converged, 3.0);
  RecordProperty("loiter_m", std::to_string(metrics.loiter));
}

// An addition is seen where it is meant to help: the feedforward on a circle.
TEST(Published, LeavesATightLoiterByWhatTheFeedforwardRemoves) {
  const Mission mission = makeMission({LoiterCircle{{0.0, 60.0}, 60.0, TurnDirection::kRight}}, {}, "test");
  const double published = fly(mission, publishedGuidance()).loiter;
  GuidanceOptions options = publishedGuidance();
  options.weights.feedforward = 1.0;
  const double with = fly(mission, options).loiter;
  EXPECT_GT(published, 1.0);
  EXPECT_LT(published, 1.6);
  EXPECT_LT(with, 0.1);
}

}  // namespace
