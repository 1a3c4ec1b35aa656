// Commands that swing from bound to bound: told soon where they do, never in a flight that is well, and prevented where
// the laws are told of a slow loop.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include "compared_laws.hpp"
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/types/remark.hpp"
#include "polyfly_test/flight_figure.hpp"
#include "polyfly_test/gaussian_source.hpp"
#include "rigid_bodies.hpp"

namespace polyfly {
namespace {

constexpr double kSeconds = 20.0;     // of a flight
constexpr double kBound = 0.4363323;  // of the commands [rad]

/// A vehicle, what its law is told of it, and the air.
struct Setting {
  RigidBodyOptions body;
  double told_delay = 0.0;      ///< by the options [s]
  double told_lag = 0.0;        ///< [s]; 0: the shipped one
  double gust = 0.0;            ///< of first order, 1 s, in each axis [m/s^2]
  double problems_delay = 0.0;  ///< told by the problems [s]
};

struct Flown {
  double at_bound = kSeconds;  ///< first command at its bound [s]
  double told = kSeconds;      ///< first report of swings [s]
  double greatest = 0.0;       ///< command of roll or pitch after 3 s [rad]
};

Flown fly(const std::string& name, const Setting& setting, const Path& path) {
  MultirotorOptions options;
  options.mass = setting.body.mass;
  options.delay = setting.told_delay;
  NonlinearMpcOptions nonlinear;
  if (setting.told_lag > 0.0) nonlinear.model.roll_time = nonlinear.model.pitch_time = setting.told_lag;
  options.look_ahead = name != "linear";
  LawInputs inputs{options, nonlinear, problemsWith(nullptr), nullptr};
  for (MpcProblem& problem : inputs.problems) problem.delay = setting.problems_delay;
  const auto made = makeLaws(lawTypes(), inputs, lawOfName(name.substr(0, name.find(','))));
  LawSwitch& laws = *made;
  RigidBodyPlant plant(setting.body, path(0.0).position);
  std::vector<Reference> preview(static_cast<std::size_t>(laws.previewLength()));
  GaussianSource source(11);
  Eigen::Vector3d gust = Eigen::Vector3d::Zero();
  const double kept = std::exp(-kPeriod), drawn = std::sqrt(1.0 - kept * kept) * setting.gust;
  Flown flown;
  while (plant.time() < kSeconds) {
    const VehicleState state = plant.measure();
    for (std::size_t k = 0; k < preview.size(); ++k)
      preview[k] = path(state.stamp + laws.lead() + static_cast<double>(k) * laws.previewPeriod());
    const ControlReport& report = laws.step(state, preview.data());
    const AttitudeCommand command = report.command;
    const double tilt = std::max(std::abs(command.roll), std::abs(command.pitch));
    if (tilt > 0.99 * kBound) flown.at_bound = std::min(flown.at_bound, state.stamp);
    if (report.swings) flown.told = std::min(flown.told, state.stamp);
    EXPECT_EQ(remarkOn(report).find("swings from side to side") != std::string::npos, report.swings);
    if (state.stamp > 3.0) flown.greatest = std::max(flown.greatest, tilt);
    laws.prepare();
    gust = kept * gust + drawn * source.next3();
    plant.setForce(setting.body.mass * gust);
    plant.advance(command, kPeriod);
  }
  return flown;
}

RigidBodyOptions noisy(RigidBodyOptions body) {
  body.position_noise = 0.005;
  body.velocity_noise = 0.02;
  body.attitude_noise = 0.005;
  return body;
}

Path eight(double rate) {
  FigureOptions options;
  options.rate = rate;
  options.yaw_turn = 0.0;
  const FlightFigure figure(options);
  return [figure](double time) { return figure.at(time); };
}

Path hover() {
  return [](double) { return Reference{}; };
}

/// To and fro, without velocities.
Path steps(double distance, double period) {
  return [=](double time) {
    Reference reference;
    if (std::fmod(time, 2.0 * period) >= period) reference.position = {distance, 0.5 * distance, 0.0};
    return reference;
  };
}

TEST(Swings, OfASlowLoopThatIsNotToldAreToldWithinThreeSeconds) {
  RigidBodyOptions late_racer = racer();
  late_racer.command_delay = 0.1;
  for (const RigidBodyOptions& body : {heavy(), late_racer}) {
    for (const Path& path : {hover(), eight(0.27), helix(8.0, 3.0, 0.0), steps(1.0, 4.0)}) {
      const Flown flown = fly("nonlinear", {noisy(body)}, path);
      EXPECT_LT(flown.at_bound, kSeconds - 3.0) << body.mass;
      EXPECT_LT(flown.told, flown.at_bound + 3.0) << body.mass;
    }
  }
}

// By weights that fit the loop of 0.25 s they would swing from bound to bound here too.
TEST(Swings, OfASlowLoopThatIsToldAreNone) {
  RigidBodyOptions late_racer = racer();
  late_racer.command_delay = 0.1;
  for (const Setting& setting : {Setting{noisy(heavy()), 0.03, 0.42}, Setting{noisy(late_racer), 0.1},
                                 Setting{noisy(late_racer), 0.0, 0.0, 0.0, 0.1}}) {
    for (const Path& path : {hover(), eight(0.27)}) {
      const Flown flown = fly("nonlinear", setting, path);
      EXPECT_LT(flown.greatest, 0.6 * kBound) << setting.body.mass;
      EXPECT_EQ(flown.told, kSeconds) << setting.body.mass;
    }
    EXPECT_EQ(fly("nonlinear", setting, steps(1.0, 4.0)).told, kSeconds) << setting.body.mass;
  }
}

TEST(Swings, AreNotToldInFlightsThatAreWell) {
  const RigidBodyOptions body;
  for (const std::string name : {"linear", "linear, looking ahead", "nonlinear"}) {
    for (const RigidBodyOptions& vehicle : {body, racer(), noisy(body)}) {
      for (const Path& path : {hover(), eight(0.53), eight(0.9), helix(8.0, 5.0, 0.0), helix(1.5, 1.5, 0.3),
                               steps(1.0, 2.0), steps(3.0, 4.0)})
        EXPECT_EQ(fly(name, {vehicle}, path).told, kSeconds) << name << ", " << vehicle.mass;
    }
    for (const RigidBodyOptions& vehicle : {body, racer()})
      EXPECT_EQ(fly(name, {vehicle, 0.0, 0.0, 2.0}, hover()).told, kSeconds) << name << ", " << vehicle.mass;
  }
  EXPECT_EQ(fly("linear, looking ahead", {noisy(heavy())}, eight(0.53)).told, kSeconds);
}

}  // namespace
}  // namespace polyfly
