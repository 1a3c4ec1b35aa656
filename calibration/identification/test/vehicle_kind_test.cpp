#include "identification/vehicle_kind.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "identification/flight_signals.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kSeconds = 120.0;
constexpr double kRate = 20.0;  // [Hz]

TimeSeries madeSeries(const std::function<double(double)>& value) {
  TimeSeries series;
  for (int i = 0; i < static_cast<int>(kSeconds * kRate); ++i) {
    series.time.push_back(i / kRate);
    series.value.push_back(value(i / kRate));
  }
  return series;
}

// On the ground for 20 s, then circles at `speed` in a wind; the heading turns by `offset` from the course.
FlightSignals circles(double speed, double wind, double offset) {
  FlightSignals signals;
  const auto flies = [](double time) { return time > 20.0 ? 1.0 : 0.0; };
  signals.series["vx"] =
      madeSeries([=](double time) { return flies(time) * (speed * std::cos(0.1 * time) + wind); });
  signals.series["vy"] = madeSeries([=](double time) { return flies(time) * speed * std::sin(0.1 * time); });
  signals.series["yaw"] =
      madeSeries([=](double time) { return std::remainder(0.1 * time + offset, 2.0 * M_PI); });
  return signals;
}

TEST(RecogniseVehicle, ByTheGroundSpeed) {
  EXPECT_EQ(recogniseVehicle(circles(15.0, 4.0, 0.0)).kind, VehicleKind::kFixedWing);
  EXPECT_EQ(recogniseVehicle(circles(3.0, 0.0, 0.0)).kind, VehicleKind::kMultirotor);
  // Fast, but sideways; and nothing but rest.
  EXPECT_EQ(recogniseVehicle(circles(15.0, 0.0, 1.5)).kind, VehicleKind::kUnknown);
  EXPECT_EQ(recogniseVehicle(circles(0.0, 0.0, 0.0)).kind, VehicleKind::kUnknown);
  EXPECT_EQ(recogniseVehicle({}).kind, VehicleKind::kUnknown);
}

// Legs at 12 m/s with a hover between.
TEST(RecogniseVehicle, AMultirotorThatFliesFastAlsoHovers) {
  FlightSignals signals = circles(0.0, 0.0, 0.0);
  signals.series["vx"] = madeSeries([](double time) { return 12.0 * std::pow(std::sin(0.3 * time), 2); });
  const RecognisedVehicle vehicle = recogniseVehicle(signals);
  EXPECT_EQ(vehicle.kind, VehicleKind::kMultirotor);
  EXPECT_EQ(vehicle.reason.find("In flight the ground speed is below 4 m/s in "), 0u) << vehicle.reason;
}

// Against a strong wind a plane hardly moves over ground.
TEST(RecogniseVehicle, ByTheAirspeedBeforeTheGroundSpeed) {
  FlightSignals signals = circles(14.0, 13.0, 0.0);
  EXPECT_NE(recogniseVehicle(signals).kind, VehicleKind::kFixedWing);
  signals.series.erase("yaw");
  signals.series["airspeed"] = madeSeries([](double time) { return time > 20.0 ? 14.0 : 0.2; });
  const RecognisedVehicle vehicle = recogniseVehicle(signals);
  EXPECT_EQ(vehicle.kind, VehicleKind::kFixedWing);
  EXPECT_EQ(vehicle.reason, "The airspeed stays above 4 m/s for 100 s of flight.");
}

TEST(RecogniseVehicle, WhatTheLogNamesCounts) {
  FlightSignals signals = circles(15.0, 0.0, 0.0);
  signals.vehicle = {VehicleKind::kMultirotor, "As --vehicle says."};
  EXPECT_EQ(recogniseVehicle(signals).kind, VehicleKind::kMultirotor);
  for (const VehicleKind kind : {VehicleKind::kUnknown, VehicleKind::kMultirotor, VehicleKind::kFixedWing})
    EXPECT_EQ(vehicleKindOf(nameOf(kind)), kind);
  EXPECT_THROW(vehicleKindOf("boat"), Error);
}

}  // namespace
}  // namespace polyfly
