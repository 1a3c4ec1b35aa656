// The model against closed forms and an integration of its own.
#include "fixedwing_lateral/model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "polyfly_base/error.hpp"

namespace {

using namespace polyfly;
using Index = LateralIndex;

TEST(LateralModel, RatesAreThoseOfTheEquationsWrittenOut) {
  LateralConditions conditions;
  conditions.airspeed = 14.0;
  conditions.wind = {3.0, -5.0};
  LateralState state;
  state << 10.0, 20.0, kPi / 4.0, kPi / 2.0, 0.5, 0.0;  // rolled right, flying east
  const LateralState rate = lateralRate(LateralModel(), conditions, state, 0.25);
  EXPECT_NEAR(rate[Index::kNorth], 3.0, 1e-12);
  EXPECT_NEAR(rate[Index::kEast], 9.0, 1e-12);
  EXPECT_NEAR(rate[Index::kRoll], 0.5, 1e-12);
  EXPECT_NEAR(rate[Index::kHeading], 9.81 / 14.0, 1e-12);  // right roll turns clockwise
  EXPECT_NEAR(rate[Index::kRollRate], 13.48 * 0.25 - 6.577 * 0.5 - 13.97 * kPi / 4.0, 1e-12);
  EXPECT_EQ(rate[Index::kSwitch], 0.0);
}

// phi'' + a1 phi' + a0 phi = b0 u from rest, underdamped.
double rollStepResponse(const LateralModel& model, double time) {
  const double decay = model.a1 / 2.0;
  const double frequency = std::sqrt(model.a0 - decay * decay);
  const double shape = std::cos(frequency * time) + decay / frequency * std::sin(frequency * time);
  return model.b0 / model.a0 * (1.0 - std::exp(-decay * time) * shape);
}

double worstRollStepError(double duration) {
  const LateralModel model;
  const LateralConditions conditions;
  LateralState state = LateralState::Zero();
  double worst = 0.0;
  const int steps = static_cast<int>(std::lround(4.0 / duration));
  for (int i = 1; i <= steps; ++i) {
    state = integrate(model, conditions, state, {0.4, duration});
    worst = std::max(worst, std::abs(state[Index::kRoll] - 0.4 * rollStepResponse(model, i * duration)));
  }
  return worst;
}

TEST(LateralModel, RollStepIsTheClosedFormToFourthOrder) {
  EXPECT_LT(worstRollStepError(0.1), 2e-4);  // rad, at the step of the horizon
  EXPECT_LT(worstRollStepError(0.01), 2e-8);
  const double order = std::log2(worstRollStepError(0.02) / worstRollStepError(0.01));
  EXPECT_NEAR(order, 4.0, 0.2);
}

TEST(LateralModel, SteadyTurnInWindIsTheClosedForm) {
  const LateralModel model;
  LateralConditions conditions;
  conditions.wind = {4.0, -7.0};
  const double roll = 0.35;
  const double rate = kGravity * std::tan(roll) / conditions.airspeed;
  const double radius = conditions.airspeed / rate;
  const double heading = 2.0;
  LateralState state;
  state << 50.0, -20.0, roll, heading, 0.0, 0.0;
  const LateralState start = state;
  const int steps = 600;  // 60 s, more than two turns
  for (int i = 0; i < steps; ++i)
    state = integrate(model, conditions, state, {roll * model.a0 / model.b0, 0.1});
  const double time = 0.1 * steps;
  const double turned = heading + rate * time;
  EXPECT_GT(turned, heading + 4.0 * kPi);  // not wrapped
  EXPECT_NEAR(state[Index::kHeading], turned, 1e-9);
  EXPECT_NEAR(state[Index::kRoll], roll, 1e-12);
  const double north = start[Index::kNorth] + radius * (std::sin(turned) - std::sin(heading)) + 4.0 * time;
  const double east = start[Index::kEast] - radius * (std::cos(turned) - std::cos(heading)) - 7.0 * time;
  EXPECT_NEAR(state[Index::kNorth], north, 1e-4);
  EXPECT_NEAR(state[Index::kEast], east, 1e-4);
}

// Eq. 45 once more, in a mid-point rule of 2e5 steps: an oracle with nothing of the library in it.
std::array<double, 5> fineFlight(double duration, const std::function<double(double)>& roll_reference) {
  const double airspeed = 12.0;
  const double wind_north = -3.0;
  const double wind_east = 8.0;
  const auto rates = [&](const std::array<double, 5>& x, double u) {
    return std::array<double, 5>{airspeed * std::cos(x[3]) + wind_north,
                                 airspeed * std::sin(x[3]) + wind_east, x[4],
                                 9.81 * std::tan(x[2]) / airspeed, 13.48 * u - 6.577 * x[4] - 13.97 * x[2]};
  };
  std::array<double, 5> x{0.0, 0.0, 0.1, 0.0, 0.0};
  const int steps = 200000;
  const double h = duration / steps;
  for (int i = 0; i < steps; ++i) {
    const double u = roll_reference((i + 0.5) * h);
    std::array<double, 5> middle = x;
    const std::array<double, 5> first = rates(x, u);
    for (std::size_t k = 0; k < 5; ++k) middle[k] += h / 2.0 * first[k];
    const std::array<double, 5> second = rates(middle, u);
    for (std::size_t k = 0; k < 5; ++k) x[k] += h * second[k];
  }
  return x;
}

TEST(LateralModel, ManoeuvreInWindIsThatOfAFineIntegration) {
  const double duration = 20.0;
  const double step = 0.1;
  const auto command = [&](double time) {  // held for a step, with changes of sign
    return 0.5 * std::sin(0.7 * std::floor(time / step));
  };
  LateralConditions conditions;
  conditions.airspeed = 12.0;
  conditions.wind = {-3.0, 8.0};
  LateralState state = LateralState::Zero();
  state[Index::kRoll] = 0.1;
  for (int i = 0; i < 200; ++i)
    state = integrate(LateralModel(), conditions, state, {command((i + 0.5) * step), step});
  const std::array<double, 5> expected = fineFlight(duration, command);
  EXPECT_NEAR(state[Index::kNorth], expected[0], 0.02);
  EXPECT_NEAR(state[Index::kEast], expected[1], 0.02);
  EXPECT_NEAR(state[Index::kRoll], expected[2], 2e-4);
  EXPECT_NEAR(state[Index::kHeading], expected[3], 2e-4);
  EXPECT_NEAR(state[Index::kRollRate], expected[4], 2e-3);
}

TEST(LateralModel, RefusesNumbersOutOfRange) {
  EXPECT_NO_THROW(checkModel(LateralModel(), "techpod"));
  const std::array<double LateralModel::*, 3> fields = {&LateralModel::a0, &LateralModel::a1,
                                                        &LateralModel::b0};
  const std::array<std::string, 3> names = {"a0", "a1", "b0"};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (const double bad : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
      LateralModel model;
      model.*fields[i] = bad;
      try {
        checkModel(model, "techpod");
        ADD_FAILURE() << names[i] << " = " << bad << " was taken";
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find("techpod: " + names[i] + ": "), 0u) << error.what();
      }
    }
  }
}

}  // namespace
