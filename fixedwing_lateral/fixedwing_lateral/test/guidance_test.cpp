// The safety ladder: every reason, what is flown then, and how it ends.
#include "fixedwing_lateral/guidance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "allocations.hpp"
#include "fixedwing_plant/flight_loop.hpp"
#include "polyfly_base/error.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

constexpr double kPeriod = 0.05;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

AircraftState start() {
  AircraftState state;
  state.position = {0.0, 15.0};
  state.ground_velocity = {14.0, 0.0};
  return state;
}

/// A guidance on a long line beside an aircraft, and the knobs of what it is told.
class Failsafe : public ::testing::Test {
 protected:
  Failsafe() : aircraft_(LateralModel{}, start(), 14.0, {0.0, 0.0}), guidance_(GuidanceOptions{}, "test") {
    guidance_.setMission(missionThrough({{0.0, 0.0}, {4000.0, 0.0}}, {}, "test"));
  }

  GuidanceInput truth() const {
    GuidanceInput input;
    input.state = aircraft_.state();
    input.time = input.state.stamp;
    input.airspeed = {aircraft_.airspeed(), input.time};
    input.wind = {aircraft_.wind(), input.time};
    return input;
  }

  GuidanceOutput step(const GuidanceInput& input) {
    GuidanceOutput output = guidance_.update(input);
    guidance_.prepare();
    EXPECT_TRUE(std::isfinite(output.roll_reference));
    EXPECT_LE(std::abs(output.roll_reference), guidance_.options().limits.roll_reference);
    aircraft_.fly(output.roll_reference, kPeriod);
    return output;
  }

  GuidanceOutput fly(double duration) {
    GuidanceOutput output;
    for (double time = 0.0; time < duration; time += kPeriod) output = step(truth());
    return output;
  }

  /// Flies with something wrong; the last output.
  template <class Spoil>
  GuidanceOutput flyWith(double duration, Spoil&& spoil) {
    GuidanceOutput output;
    for (double time = 0.0; time < duration; time += kPeriod) {
      GuidanceInput input = truth();
      spoil(input);
      output = step(input);
    }
    return output;
  }

  void expectRecovery() {
    const GuidanceOutput output = fly(30.0);
    EXPECT_EQ(output.mode, GuidanceMode::kTracking);
    EXPECT_EQ(output.reason, GuidanceReason::kNone);
    EXPECT_LT(std::abs(output.error.track), 0.5);
  }

  ChapterAircraft aircraft_;
  LateralGuidance guidance_;
};

TEST_F(Failsafe, TracksWhenAllIsWell) { expectRecovery(); }

TEST_F(Failsafe, LevelsWithoutAMission) {
  guidance_.clearMission();
  const GuidanceOutput output = fly(0.2);
  EXPECT_EQ(output.mode, GuidanceMode::kLevel);
  EXPECT_EQ(output.reason, GuidanceReason::kNoMission);
  EXPECT_EQ(output.roll_reference, 0.0);
}

TEST_F(Failsafe, FliesTheLastHorizonThroughNansThenLevels) {
  const GuidanceOutput before = fly(0.5);
  const std::vector<double> horizon(guidance_.nmpc().moves(), guidance_.nmpc().moves() + 40);
  EXPECT_EQ(before.roll_reference, horizon[1]);
  const auto poison = [](GuidanceInput& input) { input.state.roll = kNan; };
  GuidanceOutput output = flyWith(0.04, poison);
  EXPECT_EQ(output.mode, GuidanceMode::kHoldHorizon);
  EXPECT_EQ(output.reason, GuidanceReason::kNotFinite);
  EXPECT_EQ(output.roll_reference, horizon[1]);
  output = flyWith(0.99, poison);  // 1 s after the horizon was made
  EXPECT_EQ(output.mode, GuidanceMode::kHoldHorizon);
  EXPECT_NEAR(output.roll_reference, horizon[11], std::abs(horizon[10] - horizon[11]) + 1e-12);
  output = flyWith(1.2, poison);
  EXPECT_EQ(output.mode, GuidanceMode::kLevel);
  EXPECT_EQ(output.reason, GuidanceReason::kNotFinite);
  EXPECT_EQ(output.roll_reference, 0.0);
  output = step(truth());
  EXPECT_EQ(output.mode, GuidanceMode::kTracking);
  EXPECT_TRUE(output.restarted);
  expectRecovery();
}

TEST_F(Failsafe, RefusesEveryNumberThatIsNone) {
  fly(0.5);
  const std::vector<std::function<void(GuidanceInput&)>> poisons = {
      [](GuidanceInput& input) { input.state.position.x() = kNan; },
      [](GuidanceInput& input) { input.state.ground_velocity.y() = std::numeric_limits<double>::infinity(); },
      [](GuidanceInput& input) { input.state.heading = kNan; },
      [](GuidanceInput& input) { input.state.roll_rate = kNan; },
      [](GuidanceInput& input) { input.state.stamp = kNan; },
      [](GuidanceInput& input) { input.time = kNan; },
      [](GuidanceInput& input) { input.state.roll_rate = 50.0; },
      [](GuidanceInput& input) { input.state.roll = 1.5; }};
  for (const auto& poison : poisons) {
    EXPECT_EQ(flyWith(0.04, poison).reason, GuidanceReason::kNotFinite);
    EXPECT_EQ(step(truth()).reason, GuidanceReason::kNone);
  }
}

TEST_F(Failsafe, HoldsThroughAStaleState) {
  fly(1.0);
  const AircraftState old = aircraft_.state();
  GuidanceOutput output = flyWith(0.25, [&](GuidanceInput& input) { input.state = old; });
  EXPECT_EQ(output.mode, GuidanceMode::kTracking);
  output = flyWith(0.3, [&](GuidanceInput& input) { input.state = old; });
  EXPECT_EQ(output.mode, GuidanceMode::kHoldHorizon);
  EXPECT_EQ(output.reason, GuidanceReason::kStale);
  output = flyWith(3.0, [&](GuidanceInput& input) { input.state = old; });
  EXPECT_EQ(output.mode, GuidanceMode::kLevel);
  output = flyWith(0.1, [](GuidanceInput& input) { input.state.stamp += 5.0; });
  EXPECT_EQ(output.reason, GuidanceReason::kStale);
  expectRecovery();
}

TEST_F(Failsafe, DisbelievesAJumpUntilItStays) {
  fly(1.0);
  const auto jump = [](GuidanceInput& input) { input.state.position.x() += 60.0; };
  GuidanceOutput output = flyWith(0.3, jump);
  EXPECT_EQ(output.mode, GuidanceMode::kHoldHorizon);
  EXPECT_EQ(output.reason, GuidanceReason::kJump);
  EXPECT_EQ(step(truth()).reason, GuidanceReason::kNone);  // it was an outlier
  int restarts = 0;
  for (int i = 0; i < 20; ++i) {
    GuidanceInput input = truth();
    jump(input);
    output = step(input);
    restarts += output.restarted ? 1 : 0;
  }
  EXPECT_EQ(output.reason, GuidanceReason::kNone);  // it is where the aircraft is
  EXPECT_EQ(restarts, 1);
}

TEST_F(Failsafe, DisbelievesAHeadingOrARollThatJumps) {
  expectRecovery();
  for (const double angle : {kPi, -2.2}) {
    GuidanceOutput output = flyWith(1.5, [&](GuidanceInput& input) { input.state.heading += angle; });
    EXPECT_EQ(output.mode, GuidanceMode::kHoldHorizon) << angle;
    EXPECT_EQ(output.reason, GuidanceReason::kJump) << angle;
    EXPECT_LT(std::abs(aircraft_.state().roll), 0.05) << angle;  // it goes on straight ahead
    EXPECT_EQ(step(truth()).reason, GuidanceReason::kNone);
    EXPECT_LT(std::abs(fly(0.5).error.track), 0.5) << angle;
  }
  GuidanceOutput output = flyWith(0.3, [](GuidanceInput& input) { input.state.roll = 1.3; });
  EXPECT_EQ(output.reason, GuidanceReason::kJump);
  EXPECT_EQ(step(truth()).reason, GuidanceReason::kNone);
  // One that stays is believed when the last horizon is flown: the wings would be levelled next. Against the
  // ground velocity, a heading means wind.
  output = flyWith(2.1, [](GuidanceInput& input) { input.state.heading += kPi; });
  EXPECT_EQ(output.reason, GuidanceReason::kStrongWind);
}

TEST_F(Failsafe, TakesAStateThatRepeatsItselfUnderNewStampsForStale) {
  fly(1.0);
  const AircraftState first = aircraft_.state();
  const auto repeat = [&](GuidanceInput& input) {
    const double stamp = input.state.stamp;
    input.state = first;
    input.state.stamp = stamp;
  };
  EXPECT_EQ(flyWith(0.25, repeat).reason,
            GuidanceReason::kNone);  // slow positions may be published more often
  const GuidanceOutput output = flyWith(0.5, repeat);
  EXPECT_EQ(output.mode, GuidanceMode::kHoldHorizon);
  EXPECT_EQ(output.reason, GuidanceReason::kStale);
  expectRecovery();
}

TEST_F(Failsafe, LevelsAtLowAirspeedUntilThereIsAMargin) {
  fly(1.0);
  const auto slow = [](double airspeed) {
    return [airspeed](GuidanceInput& input) { input.airspeed.value = airspeed; };
  };
  GuidanceOutput output = flyWith(0.1, slow(7.5));
  EXPECT_EQ(output.mode, GuidanceMode::kLevel);
  EXPECT_EQ(output.reason, GuidanceReason::kLowAirspeed);
  EXPECT_EQ(output.roll_reference, 0.0);
  EXPECT_EQ(flyWith(0.1, slow(8.2)).reason, GuidanceReason::kLowAirspeed);
  EXPECT_EQ(flyWith(0.1, slow(8.6)).reason, GuidanceReason::kNone);
  EXPECT_EQ(flyWith(0.1, slow(8.2)).reason, GuidanceReason::kNone);
  EXPECT_EQ(flyWith(0.1, slow(0.0)).reason, GuidanceReason::kLowAirspeed);
  expectRecovery();
}

TEST_F(Failsafe, TurnsIntoAWindAboveTheAirspeed) {
  fly(1.0);
  // The wind blows to the east: upwind is west.
  aircraft_.setWind({0.0, 16.0});
  GuidanceOutput output = fly(15.0);
  EXPECT_EQ(output.mode, GuidanceMode::kUpwind);
  EXPECT_EQ(output.reason, GuidanceReason::kStrongWind);
  const double heading = aircraft_.state().heading;
  EXPECT_NEAR(wrapCourse(heading + kPi / 2.0), 0.0, 0.05);
  EXPECT_LT(aircraft_.state().ground_velocity.norm(), 2.5);
  aircraft_.setWind({0.0, 13.5});  // still near the airspeed
  EXPECT_EQ(fly(5.0).mode, GuidanceMode::kUpwind);
  aircraft_.setWind({0.0, 5.0});
  fly(30.0);
  expectRecovery();
}

TEST_F(Failsafe, AssumesWindAndAirspeedWhereTheyAreMissing) {
  aircraft_.setWind({-3.0, 5.0});
  GuidanceOutput output = flyWith(60.0, [](GuidanceInput& input) {
    input.wind = {};
    input.airspeed.value = kNan;
  });
  EXPECT_EQ(output.mode, GuidanceMode::kTracking);
  EXPECT_EQ(output.reason, GuidanceReason::kAirspeedAssumed);
  EXPECT_EQ(output.airspeed, 14.0);
  EXPECT_LT(std::abs(output.error.track), 1.0);
  output = flyWith(30.0, [](GuidanceInput& input) { input.wind.value.x() = kNan; });
  EXPECT_EQ(output.reason, GuidanceReason::kWindAssumed);
  EXPECT_LT((output.wind - Vector2d(-3.0, 5.0)).norm(), 0.1);
  EXPECT_LT(std::abs(output.error.track), 1.0);
  output =
      flyWith(4.0, [](GuidanceInput& input) { input.wind.stamp = input.time - 4.0; });  // old, not too old
  EXPECT_EQ(output.reason, GuidanceReason::kNone);
  output = flyWith(0.1, [](GuidanceInput& input) { input.wind.stamp = input.time - 6.0; });
  EXPECT_EQ(output.reason, GuidanceReason::kWindAssumed);
}

TEST_F(Failsafe, FollowsTheRollWhileAnotherModeFliesAndBeginsAnewAfterwards) {
  fly(1.0);
  GuidanceInput input = truth();
  input.engaged = false;
  input.state.roll = 0.2;
  GuidanceOutput output = step(input);
  EXPECT_EQ(output.mode, GuidanceMode::kStandby);
  EXPECT_EQ(output.reason, GuidanceReason::kNotEngaged);
  EXPECT_EQ(output.roll_reference, 0.2);
  output = step(truth());
  EXPECT_EQ(output.mode, GuidanceMode::kTracking);
  EXPECT_TRUE(output.restarted);
  EXPECT_LT(std::abs(output.roll_reference - aircraft_.state().roll), 0.2);  // without a jump
  expectRecovery();
}

TEST_F(Failsafe, BeginsAnewWhereTheOptimisationFailsThenHoldsTheLastHorizon) {
  fly(1.0);
  // Finite numbers whose squares are not: a jump that is believed in the end, so only the optimisation can notice.
  const auto overflow = [](GuidanceInput& input) { input.state.position.y() = 1e200; };
  GuidanceOutput output = flyWith(0.6, overflow);
  EXPECT_EQ(output.mode, GuidanceMode::kHoldHorizon);
  EXPECT_EQ(output.reason, GuidanceReason::kSolver);
  EXPECT_TRUE(output.restarted);
  output = flyWith(2.5, overflow);
  EXPECT_EQ(output.mode, GuidanceMode::kLevel);
  EXPECT_EQ(output.reason, GuidanceReason::kSolver);
  expectRecovery();
}

TEST_F(Failsafe, LoitersAtTheEnd) {
  guidance_.setMission(missionThrough({{0.0, 0.0}, {200.0, 0.0}}, {80.0, TurnDirection::kLeft}, "test"));
  const GuidanceOutput output = fly(90.0);
  EXPECT_TRUE(output.loitering);
  EXPECT_EQ(output.segment, 1);
  EXPECT_LT(std::abs(output.error.track), 0.5);
}

TEST_F(Failsafe, SurvivesATimeThatBeginsAnew) {
  fly(5.0);
  aircraft_ = ChapterAircraft(LateralModel{}, start(), 14.0, {0.0, 0.0});
  fly(1.0);
  expectRecovery();
}

TEST_F(Failsafe, AllocatesNothing) {
  const GuidanceInput good = truth();
  std::vector<GuidanceInput> inputs(12, good);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    inputs[i].time = inputs[i].state.stamp = 0.05 * static_cast<double>(i);
    inputs[i].state.position.x() += 0.7 * static_cast<double>(i);
  }
  inputs[3].state.roll = kNan;
  inputs[5].airspeed = {3.0, 0.25};
  inputs[6].wind = {{20.0, 0.0}, 0.3};
  inputs[7].engaged = false;
  inputs[8].state.position.x() += 500.0;
  inputs[9].state.position.y() = 1e200;
  const long before = polyfly_test::allocationCount();
  for (const GuidanceInput& input : inputs) {
    guidance_.update(input);
    guidance_.prepare();
  }
  guidance_.setTuning(LateralWeights{}, LateralLimits{}, SafetyOptions{});
  EXPECT_EQ(polyfly_test::allocationCount(), before);
}

TEST(GuidanceOptions, AreChecked) {
  GuidanceOptions options;
  options.period = 0.0;
  EXPECT_THROW(LateralGuidance(options, "here"), Error);
  options = {};
  options.safety.wind_share_max = 1.5;
  EXPECT_THROW(LateralGuidance(options, "here"), Error);
}

}  // namespace
