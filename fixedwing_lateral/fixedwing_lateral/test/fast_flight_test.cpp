// Airspeeds that the published weights were not made for: similarity, flights of a fast aircraft that rolls slowly, and
// what happens where tracking does not converge.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "allocations.hpp"
#include "fixedwing_lateral/l1_guidance.hpp"
#include "fixedwing_lateral/lateral_parameters.hpp"
#include "fixedwing_plant/figures.hpp"
#include "fixedwing_plant/flight_metrics.hpp"
#include "step_oracles.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

constexpr double kFast = 52.0;
constexpr double kSlow = 14.0;
constexpr double kScale = kFast / kSlow;
constexpr double kSettle = 0.5;
// The bar of a fast aircraft: distance per airspeed [s].
constexpr double kBar = 0.25;

/// The roll loop that is s times as slow.
LateralModel slowedModel(double scale) {
  LateralModel model;
  model.a0 /= scale * scale;
  model.a1 /= scale;
  model.b0 /= scale * scale;
  return model;
}

/// The moves that are optimal from a state beside a line to the north.
std::vector<double> optimalMoves(const LateralModel& model, double step, const LateralWeights& weights,
                                 const LateralState& state, double airspeed) {
  HorizonOptions options;
  options.step = step;
  LateralNmpc nmpc(model, options, "test");
  nmpc.setTuning(weights, LateralLimits{});
  HorizonData data;
  data.conditions.airspeed = airspeed;
  data.current = LineSegment{{-1e5, 0.0}, {1e5, 0.0}};
  data.next = data.current;
  nmpc.reset(data, state, state[LateralIndex::kRoll]);
  lateral_test::iterate(nmpc, data, state, 60, 1e-11);
  return {nmpc.moves(), nmpc.moves() + nmpc.horizon()};
}

// With a roll loop that is slower by s, the problem at s V_0 is the one at V_0 in other units, so all moves are equal.
TEST(SpeedScaling, KeepsTheOptimumOfASimilarFlight) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> offset(-40.0, 40.0);
  std::uniform_real_distribution<double> angle(-0.5, 0.5);
  const LateralWeights weights = defaultWeights();
  for (const double scale : {1.2, 2.0, kScale}) {
    const LateralModel model = slowedModel(scale);
    const SpeedScaling scaling = scalingAt(scale * kSlow, weights, HorizonOptions{}, model);
    EXPECT_NEAR(scaling.step, 0.1 * scale, 1e-12);
    const LateralWeights scaled = scaledWeights(weights, scaling, 1e9);
    for (int i = 0; i < 20; ++i) {
      LateralState state = LateralState::Zero();
      state[1] = offset(random);
      for (Eigen::Index k = 2; k < 5; ++k) state[k] = angle(random);
      LateralState similar = state;
      similar.head<2>() *= scale * scale;
      similar[LateralIndex::kRollRate] /= scale;
      const std::vector<double> slow = optimalMoves(LateralModel{}, 0.1, weights, state, kSlow);
      const std::vector<double> fast = optimalMoves(model, scaling.step, scaled, similar, scale * kSlow);
      for (std::size_t k = 0; k < slow.size(); ++k) EXPECT_NEAR(slow[k], fast[k], 1e-6) << scale << ' ' << k;
    }
  }
}

TEST(SpeedScaling, ChangesNothingUpToTheAirspeedOfTheWeights) {
  const LateralWeights weights = defaultWeights();
  for (const double airspeed : {5.0, 10.0, kSlow}) {
    const SpeedScaling scaling = scalingAt(airspeed, weights, HorizonOptions{}, LateralModel{});
    EXPECT_EQ(scaling.scale, 1.0);
    EXPECT_EQ(scaling.step, HorizonOptions{}.step);
    EXPECT_EQ(scaledWeights(weights, scaling, 500.0).track, weights.track);
    EXPECT_EQ(scaledWeights(weights, scaling, 500.0).roll_rate, weights.roll_rate);
  }
  const LateralWeights published;
  EXPECT_EQ(scalingAt(kFast, published, HorizonOptions{}, LateralModel{}).scale, 1.0);
}

TEST(SpeedScaling, WeighsTheErrorFullyNearThePathAndBySimilarityFarAway) {
  LateralWeights weights = defaultWeights();
  weights.track = LateralWeights{}.track;
  const SpeedScaling scaling = scalingAt(kFast, weights, HorizonOptions{}, LateralModel{});
  EXPECT_EQ(scaledWeights(weights, scaling, 0.0).track, weights.track);
  EXPECT_EQ(scaledWeights(weights, scaling, kNearTime * kFast).track, weights.track);
  EXPECT_NEAR(scaledWeights(weights, scaling, 1e6).track, weights.track / std::pow(kScale, 4.0), 1e-12);
  double last = weights.track;
  for (double error = 1.0; error < 1e4; error *= 1.1) {
    const double track = scaledWeights(weights, scaling, error).track;
    EXPECT_LE(track, last);
    last = track;
  }
  // Three times the weight makes the frequency w 3^(1/4) times as high, and e_near w^3 times as small.
  const SpeedScaling closer = scalingAt(kFast, defaultWeights(), HorizonOptions{}, LateralModel{});
  EXPECT_NEAR(closer.near, kNearTime * kFast / std::pow(3.0, 0.75), 1e-9);
  // The step stays where the Runge-Kutta step of the roll loop is accurate.
  EXPECT_LE(scalingAt(200.0, weights, HorizonOptions{}, LateralModel{}).step, 0.41);
}

struct Flight {
  std::vector<FlightSample> samples;
  FlightMetrics metrics;
  int fallbacks = 0;
};

Flight measured(const Mission& mission, std::vector<FlightSample> samples) {
  Flight flight;
  flight.samples = std::move(samples);
  flight.metrics = flightMetrics(mission.segments, flight.samples, kSettle, 7.0 * kScale);
  for (std::size_t i = 1; i < flight.samples.size(); ++i) {
    const bool before = flight.samples[i - 1].output.mode == GuidanceMode::kFallback;
    flight.fallbacks += !before && flight.samples[i].output.mode == GuidanceMode::kFallback ? 1 : 0;
  }
  return flight;
}

constexpr double kDuration = 240.0 * kScale;

PerturbedAircraft slowRoller(const Vector2d& wind) {
  AircraftState start;
  start.ground_velocity = {kFast, 0.0};
  RoughOptions options = slowRolling();
  options.wind = wind;
  return {options, start, 1};
}

Flight flyFast(const Mission& mission, const Vector2d& wind, const GuidanceOptions& options) {
  PerturbedAircraft aircraft = slowRoller(wind);
  LateralGuidance guidance(options, "test");
  guidance.setMission(mission);
  Sensors sensors({}, 1);
  return measured(mission, flyLaw(aircraft, sensors, lawOf(guidance), options.period, kDuration));
}

Flight flyL1(const Mission& mission, const Vector2d& wind, const SwitchCriterion& criterion, double period) {
  PerturbedAircraft aircraft = slowRoller(wind);
  L1Options options;
  options.period = period;
  L1Guidance guidance(mission, criterion, options);
  Sensors sensors({}, 1);
  return measured(mission,
                  flyLaw(
                      aircraft, sensors, [&](const GuidanceInput& input) { return guidance.update(input); },
                      0.05, kDuration));
}

/// The defaults for the airspeed, in a mission that is planned for the wind.
LateralParameters uncalibrated(double wind_share) {
  LateralParameters parameters;
  parameters.guidance.airspeed_nominal = kFast;
  parameters.wind_expected = wind_share * kFast;
  parameters.tight_turns = "widen";
  return parameters;
}

/// The same with the roll loop and the roll rate of the aircraft.
LateralParameters calibrated(double wind_share) {
  LateralParameters parameters = uncalibrated(wind_share);
  LateralModel& model = parameters.guidance.model;
  const RoughOptions aircraft = slowRolling();
  model.a0 = model.b0 = aircraft.roll_frequency * aircraft.roll_frequency;
  model.a1 = 2.0 * aircraft.roll_damping * aircraft.roll_frequency;
  model.roll_rate_max = aircraft.roll_rate_max;
  return parameters;
}

Vector2d windOf(double share) { return share * kFast * Vector2d(0.6, -0.8); }

/// For how long a flight was farther from its path than the bar [s]: while it joins the path and behind corners.
double timeAway(const Mission& mission, const Flight& flight) {
  double time = 0.0;
  for (const FlightSample& sample : flight.samples)
    time += pathDistance(mission.segments, sample) > kBar * kFast ? 0.05 : 0.0;
  return time;
}

// The switch condition of L1: it turns onto the next segment as far from a corner as the radius of its turn.
SwitchCriterion turnRadius() {
  SwitchCriterion criterion;
  criterion.acceptance_radius = kScale * kScale * 28.5;
  return criterion;
}

// Below this distance both laws count as on the path [m].
constexpr double kOnPath = 0.1;

// "Never worse than L1": on the same mission from the same start in the same wind, by the period that belongs to this speed
// (leastL1Period; a shorter one cannot turn onto a path that it crosses) and by a longer one. Not farther from the path on
// lines and loiter in the second half of their time, and not away from it for longer. The turns of a Dubins sequence can
// be followed, so there every distance counts once the path is joined.
void expectNeverWorse(const Mission& mission, const Flight& flight, double share, bool can_be_followed) {
  for (const double period : {leastL1Period(kFast, L1Options{}), 40.0}) {
    const Flight usual = flyL1(mission, windOf(share), turnRadius(), period);
    EXPECT_LE(flight.metrics.converged, std::max(kOnPath, usual.metrics.converged)) << share << ' ' << period;
    EXPECT_LE(flight.metrics.loiter, std::max(kOnPath, usual.metrics.loiter)) << share << ' ' << period;
    EXPECT_LE(timeAway(mission, flight), timeAway(mission, usual)) << share << ' ' << period;
    if (!can_be_followed || !usual.metrics.has_joined) continue;
    EXPECT_LE(flight.metrics.after_joining, usual.metrics.after_joining) << share << ' ' << period;
  }
}

// Where the roll rate is not set, turns are planned by a presumed one.
TEST(FastFlight, DubinsByDefaultsAndCalibratedIsHeldAndNeverWorseThanByL1) {
  for (const double share : {0.0, 0.3, 0.5}) {
    for (const LateralParameters& parameters : {uncalibrated(share), calibrated(share)}) {
      const Mission mission = dubinsFigure(turnPlanOf(parameters, {}), kScale * kScale);
      const Flight flight = flyFast(mission, windOf(share), parameters.guidance);
      ASSERT_TRUE(flight.metrics.has_joined) << share;
      EXPECT_LT(flight.metrics.after_joining, kBar * kFast) << share;
      EXPECT_LT(flight.metrics.loiter, 1.0) << share;
      EXPECT_EQ(flight.fallbacks, 0);
      expectNeverWorse(mission, flight, share, true);
      // Shorter periods too, where L1 joins by them.
      for (const double period : {16.0, 25.0}) {
        const Flight usual = flyL1(mission, windOf(share), turnRadius(), period);
        if (!usual.metrics.has_joined) continue;
        EXPECT_LE(flight.metrics.after_joining, usual.metrics.after_joining) << share << ' ' << period;
      }
    }
  }
}

// By the Techpod's roll loop and no roll rate, as before anything was presumed: the sequence is left by more than the bar.
TEST(FastFlight, DubinsThatIsPlannedForAnotherRollLoopIsLeft) {
  const LateralParameters parameters = uncalibrated(0.5);
  TurnPlan plan = turnPlanOf(parameters, {});
  plan.conditions.roll_rate = 0.0;
  const Mission mission = dubinsFigure(plan, kScale * kScale);
  const Flight flight = flyFast(mission, windOf(0.5), parameters.guidance);
  EXPECT_GT(flight.metrics.after_joining, kBar * kFast);
}

/// The same options as at 14 m/s but for the airspeed, roll loop and acceptance radius included.
GuidanceOptions fastDefaults() {
  GuidanceOptions options;
  options.airspeed_nominal = kFast;
  return options;
}

// Over the whole flight, corners included, L1 is compared with each period, and with a greater radius too.
TEST(FastFlight, TheBoxConvergesWithAllOptionsAsShippedAndCostsLessThanByL1) {
  const Mission mission = boxFigure(kScale * kScale);
  for (const double share : {0.0, 0.3, 0.5}) {
    const Flight flight = flyFast(mission, windOf(share), fastDefaults());
    EXPECT_LT(flight.metrics.converged, kBar * kFast) << share;
    EXPECT_LT(flight.metrics.loiter, 1.0) << share;
    EXPECT_EQ(flight.fallbacks, 0);
    expectNeverWorse(mission, flight, share, false);
    for (const double period : {16.0, 25.0, leastL1Period(kFast, L1Options{}), 40.0}) {
      const Flight usual = flyL1(mission, windOf(share), turnRadius(), period);
      EXPECT_LE(flight.metrics.rms, usual.metrics.rms) << share << ' ' << period;
    }
    SwitchCriterion wider = turnRadius();
    wider.acceptance_radius *= 1.4;
    const Flight wide = flyL1(mission, windOf(share), wider, 40.0);
    EXPECT_LE(flight.metrics.rms, wide.metrics.rms) << share;
  }
}

TEST(FastFlight, TheBoxConvergesAsPublishedButForTheAirspeed) {
  GuidanceOptions options = fastDefaults();
  options.weights.track = LateralWeights{}.track;
  options.criterion = turnRadius();
  const Flight flight = flyFast(boxFigure(kScale * kScale), windOf(0.3), options);
  EXPECT_LT(flight.metrics.converged, kBar * kFast);
  EXPECT_EQ(flight.fallbacks, 0);
}

TEST(FastFlight, WeightsThatAreNotScaledDoNotConvergeAndL1TakesOver) {
  GuidanceOptions options;
  options.weights.airspeed = 0.0;
  const Mission mission = makeMission({LineSegment{{0.0, 300.0}, {1e5, 300.0}}}, {}, "test");
  const Flight flight = flyFast(mission, {0.0, 0.0}, options);
  EXPECT_GE(flight.fallbacks, 1);
  bool is_near = false;
  for (const FlightSample& sample : flight.samples) {
    if (sample.output.mode != GuidanceMode::kFallback) continue;
    EXPECT_EQ(sample.output.reason, GuidanceReason::kNotConverging);
    EXPECT_LE(std::abs(sample.roll_reference), options.limits.roll_reference);
    is_near = is_near || pathDistance(mission.segments, sample) < 1.0;
  }
  EXPECT_TRUE(is_near);
  options.falls_back = false;
  const Flight lost = flyFast(mission, {0.0, 0.0}, options);
  EXPECT_EQ(lost.fallbacks, 0);
  EXPECT_GT(lost.metrics.rms, 2.0 * flight.metrics.rms);
}

TEST(FastFlight, AMissionOrOtherOptionsGiveTheOptimisationAnotherChance) {
  GuidanceOptions options;
  options.weights.airspeed = 0.0;
  const Mission mission = makeMission({LineSegment{{0.0, 300.0}, {1e5, 300.0}}}, {}, "test");
  for (const bool by_mission : {true, false}) {
    LateralGuidance guidance(options, "test");
    guidance.setMission(mission);
    PerturbedAircraft aircraft = slowRoller({0.0, 0.0});
    Sensors sensors({}, 1);
    flyLaw(aircraft, sensors, lawOf(guidance), options.period, kDuration,
           [](const FlightSample& sample) { return sample.output.mode == GuidanceMode::kFallback; });
    ASSERT_EQ(guidance.output().mode, GuidanceMode::kFallback);
    if (by_mission)
      guidance.setMission(mission);
    else
      guidance.setTuning(options.weights, options.limits, options.safety);
    aircraft.fly(0.0, options.period);
    EXPECT_EQ(guidance.update(sensors.measure(aircraft, options.period)).mode, GuidanceMode::kTracking);
    EXPECT_TRUE(guidance.output().restarted);
  }
}

// Another pilot flies the aircraft away from its path. The way back is longer than the time limit.
TEST(Fallback, DoesNotCountWhatAnotherPilotFlew) {
  GuidanceOptions options;
  LateralGuidance guidance(options, "test");
  guidance.setMission(makeMission({LineSegment{{0.0, 0.0}, {1e5, 0.0}}}, {}, "test"));
  AircraftState start;
  start.ground_velocity = {kSlow, 0.0};
  ChapterAircraft aircraft(LateralModel{}, start, kSlow, {0.0, 0.0});
  Sensors sensors({}, 1);
  bool returned = false;
  for (int i = 0; i < 4000; ++i) {
    GuidanceInput input = sensors.measure(aircraft, options.period);
    const bool away = i >= 200 && i < 1400;
    input.engaged = !away;
    const GuidanceOutput& output = guidance.update(input);
    ASSERT_NE(output.mode, GuidanceMode::kFallback) << i;
    returned = i > 1400 && std::abs(output.error.track) < 1.0;
    // A turn to the east, then straight on.
    aircraft.fly(away ? (i < 340 ? 0.3 : 0.0) : output.roll_reference, options.period);
    guidance.prepare();
  }
  EXPECT_TRUE(returned);
}

TEST(FastFlight, FallingBackAllocatesNothing) {
  GuidanceOptions options;
  LateralGuidance guidance(options, "test");
  guidance.setMission(makeMission({LineSegment{{0.0, 3000.0}, {1e5, 3000.0}}}, {}, "test"));
  PerturbedAircraft aircraft = slowRoller({0.0, 0.0});
  Sensors sensors({}, 1);
  long allocations = 0;
  bool fell_back = false;
  for (int i = 0; i < 4000; ++i) {
    GuidanceInput input = sensors.measure(aircraft, options.period);
    const long before = polyfly_test::allocationCount();
    guidance.update(input);
    guidance.prepare();
    allocations += polyfly_test::allocationCount() - before;
    fell_back = fell_back || guidance.output().mode == GuidanceMode::kFallback;
    // Held in a circle: no progress at all.
    aircraft.fly(0.5, options.period);
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_TRUE(fell_back);
}

TEST(ConvergenceWatch, IsPatientWhileTheAircraftComesNearer) {
  constexpr double kMostRoll = 0.6108652;
  const double turn = 2.0 * kPi * 14.0 / (9.81 * std::tan(kMostRoll));
  ConvergenceWatch watch;
  TrackError error;
  error.course_defined = true;
  for (double distance = 3000.0; distance > 0.0; distance -= 0.2 * 14.0 * 0.05) {
    error.track = distance;
    watch.update(error, 14.0, kMostRoll, 0.05);
    ASSERT_LT(watch.withoutProgress(), 1.0);
  }
  EXPECT_TRUE(watch.isNear());
  watch.restart();
  error.track = 100.0;
  double time = 0.0;
  for (; watch.withoutProgress() <= 1.0; time += 0.05) watch.update(error, 14.0, kMostRoll, 0.05);
  EXPECT_NEAR(time, 1.5 * turn, 0.2);
  // A path that is crossed, not flown: far by the turn onto it.
  watch.restart();
  error.track = 0.0;
  error.course = kPi / 2.0;
  watch.update(error, 14.0, kMostRoll, 0.05);
  EXPECT_FALSE(watch.isNear());
}

}  // namespace
