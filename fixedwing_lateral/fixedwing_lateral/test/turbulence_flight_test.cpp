// Flights at 52 m/s in turbulence and a mean wind of half the airspeed, beside L1 guidance by its best period.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <vector>

#include "fixedwing_lateral/l1_guidance.hpp"
#include "fixedwing_lateral/lateral_parameters.hpp"
#include "fixedwing_plant/figures.hpp"
#include "fixedwing_plant/flight_metrics.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

constexpr double kFast = 52.0;
constexpr double kScale = kFast / 14.0;
constexpr double kWindShare = 0.5;
constexpr double kGustScale = 530.0;  // [m], that of MIL-F-8785C above 600 m
constexpr double kDuration = 500.0;   // [s]
constexpr double kJoined = 100.0;     // [s] after which the distance counts
constexpr unsigned kSeeds = 2;        // the README has the means of ten
constexpr double kMostOfL1 = 1.2;

struct Air {
  double roll_frequency = 2.0;  ///< of the aircraft [rad/s]
  double gust = 2.6;            ///< [m/s]
};

PerturbedAircraft aircraftIn(const Air& air, unsigned seed) {
  AircraftState start;
  start.ground_velocity = {kFast, 0.0};
  RoughOptions options = slowRolling();
  options.roll_frequency = air.roll_frequency;
  options.gust = air.gust;
  options.gust_scale = kGustScale;
  options.wind = kWindShare * kFast * Vector2d(0.6, -0.8);
  return {options, start, seed};
}

LateralParameters parametersFor(const Air& air, bool is_calibrated) {
  LateralParameters parameters;
  parameters.guidance.airspeed_nominal = kFast;
  parameters.wind_expected = kWindShare * kFast;
  parameters.tight_turns = "widen";
  if (!is_calibrated) return parameters;
  const RoughOptions aircraft = slowRolling();
  LateralModel& model = parameters.guidance.model;
  model.a0 = model.b0 = air.roll_frequency * air.roll_frequency;
  model.a1 = 2.0 * aircraft.roll_damping * air.roll_frequency;
  model.roll_rate_max = aircraft.roll_rate_max;
  return parameters;
}

std::vector<Mission> missionsFor(const LateralParameters& parameters) {
  const TurnPlan plan = turnPlanOf(parameters, {});
  const double radius = plan.planned(60.0 * kScale * kScale);
  return {makeMission({LineSegment{{0.0, 100.0}, {1e6, 100.0}}}, {}, "line"),
          makeMission({LoiterCircle{{0.0, radius}, radius, TurnDirection::kRight}}, {}, "loiter"),
          dubinsFigure(plan, kScale * kScale)};
}

/// Distance from the path once it had the time to be joined, rms [m].
double distanceOf(const Mission& mission, const std::vector<FlightSample>& samples) {
  double sum = 0.0;
  long count = 0;
  for (const FlightSample& sample : samples) {
    if (sample.time < kJoined) continue;
    sum += std::pow(pathDistance(mission.segments, sample), 2.0);
    ++count;
  }
  return std::sqrt(sum / static_cast<double>(count));
}

/// Mean over the seeds.
double byOptimisation(const Mission& mission, const LateralParameters& parameters, const Air& air) {
  double sum = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    PerturbedAircraft aircraft = aircraftIn(air, seed);
    LateralGuidance guidance(parameters.guidance, "test");
    guidance.setMission(mission);
    Sensors sensors({}, seed);
    sum += distanceOf(mission,
                      flyLaw(aircraft, sensors, lawOf(guidance), parameters.guidance.period, kDuration));
  }
  return sum / kSeeds;
}

/// The least mean of a few periods.
double byL1(const Mission& mission, const Air& air) {
  double best = std::numeric_limits<double>::infinity();
  for (const double period : {16.0, 20.0, 25.0, leastL1Period(kFast, L1Options{}), 40.0}) {
    double sum = 0.0;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      PerturbedAircraft aircraft = aircraftIn(air, seed);
      L1Options options;
      options.period = period;
      SwitchCriterion criterion;
      criterion.acceptance_radius = 28.5 * kScale * kScale;
      L1Guidance guidance(mission, criterion, options);
      Sensors sensors({}, seed);
      const LateralLaw law = [&](const GuidanceInput& input) { return guidance.update(input); };
      sum += distanceOf(mission, flyLaw(aircraft, sensors, law, 0.05, kDuration));
    }
    best = std::min(best, sum / kSeeds);
  }
  return best;
}

void expectAsCloseAsL1(const Air& air, std::initializer_list<bool> calibrated) {
  for (const bool is_calibrated : calibrated) {
    const LateralParameters parameters = parametersFor(air, is_calibrated);
    for (const Mission& mission : missionsFor(parameters)) {
      EXPECT_LE(byOptimisation(mission, parameters, air), kMostOfL1 * byL1(mission, air))
          << air.roll_frequency << ' ' << air.gust << ' ' << is_calibrated << ' ' << mission.segments.size();
    }
  }
}

TEST(TurbulenceFlight, IsAsCloseAsByL1) { expectAsCloseAsL1({2.0, 2.6}, {false, true}); }

// The convergence watch hands such air over to L1 now and then.
TEST(TurbulenceFlight, IsAsCloseAsByL1InSevereGusts) { expectAsCloseAsL1({2.0, 4.5}, {true}); }

TEST(TurbulenceFlight, IsAsCloseAsByL1WithASlowerRollLoop) { expectAsCloseAsL1({1.6, 2.6}, {true}); }

}  // namespace
