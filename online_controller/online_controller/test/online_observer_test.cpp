// The observer that is published, its calibration, and the integrator: against motions with known forces.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "allocations.hpp"
#include "online_controller/estimation/attitude_trim.hpp"
#include "online_controller/estimation/vehicle_observer.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "online_controller/types/flight_options.hpp"
#include "online_support.hpp"
#include "polyfly_base/error.hpp"
#include "project_root.hpp"

namespace {

using polyfly::AttitudeCommand;
using polyfly::VehicleObserver;
using polyfly::VehicleState;

constexpr double kGravity = 9.8066;
constexpr double kMass = 1.52;
constexpr double kPeriod = 0.01;
constexpr double kDrag = 0.01;

/// Roll and pitch of a first-order lag with another gain than the observer's model and an offset.
struct Tilt {
  static constexpr double kTime = 0.25, kGain = 0.8, kOffset = 0.02;
  polyfly::TiltAngles angles;

  void move(const AttitudeCommand& command) {
    const double decay = std::exp(-kPeriod / kTime);
    angles.roll = decay * angles.roll + (1.0 - decay) * (kGain * command.roll + kOffset);
    angles.pitch = decay * angles.pitch + (1.0 - decay) * kGain * command.pitch;
  }
};

TEST(AttitudeTrim, findsTheCommandsThatTheModelDoesNotExplain) {
  polyfly::MultirotorOptions options;
  options.pitch_trim = 0.01;
  polyfly::AttitudeTrim trim({0.9, 0.25, 0.9, 0.25}, options);
  EXPECT_EQ(trim.angles().roll, 0.0);
  EXPECT_EQ(trim.angles().pitch, 0.01);
  Tilt tilt;
  AttitudeCommand command;
  command.roll = 0.1;
  command.pitch = -0.2;
  const auto fly = [&](double seconds) {
    for (int k = 0; k < static_cast<int>(seconds / kPeriod); ++k) {
      tilt.move(command);
      trim.update(tilt.angles, command, 1);
    }
  };
  fly(60.0);
  // In rest the model has angle = 0.9 (command - trim).
  EXPECT_NEAR(trim.angles().roll, 0.1 - (0.8 * 0.1 + 0.02) / 0.9, 1e-4);
  EXPECT_NEAR(trim.angles().pitch, -0.2 + 0.8 * 0.2 / 0.9, 1e-4);

  polyfly::AttitudeTrim next({0.9, 0.25, 0.9, 0.25}, options);
  next.transferState(trim);
  EXPECT_EQ(next.angles().roll, trim.angles().roll);
  trim.reset();
  EXPECT_EQ(trim.angles().pitch, 0.01);

  command.roll = 5.0;  // it does not follow: held by something
  tilt.angles = {};
  for (int k = 0; k < 10000; ++k) trim.update({0.0, 0.0}, command, 1);
  EXPECT_NEAR(trim.angles().roll, polyfly::AttitudeTrim::kMost, 1e-12);

  options.trim_drift = 0.0;
  polyfly::AttitudeTrim given({0.9, 0.25, 0.9, 0.25}, options);
  given.update({0.1, 0.1}, command, 1);
  EXPECT_EQ(given.angles().roll, 0.0);
  EXPECT_EQ(given.angles().pitch, 0.01);
  EXPECT_THROW(polyfly::AttitudeTrim({0.0, 0.25, 0.9, 0.25}, {}), polyfly::Error);
}

// Along s the loops need s / K + tau s' / K + trim; the model knows other numbers.
TEST(AttitudeTrim, FindsGainAndLagWhileTheReferenceTurns) {
  constexpr double kGain = 1.0, kLag = 0.19, kTrim = 0.02, kRate = 1.2, kAngle = 0.15;
  const double decay = std::exp(-kPeriod / kLag);
  polyfly::AttitudeTrim trim({0.9, 0.25, 0.9, 0.25}, {}), untaught({0.9, 0.25, 0.9, 0.25}, {});
  polyfly::TiltAngles tilt;
  for (int k = 0; k < 9000; ++k) {
    const double phase = kRate * kPeriod * k;
    const polyfly::FollowedTilt followed{
        {kAngle * std::sin(phase), kAngle * std::cos(phase)},
        {kRate * kAngle * std::cos(phase), -kRate * kAngle * std::sin(phase)}};
    // What the vehicle needs, by its own numbers.
    AttitudeCommand command;
    command.roll = (followed.angle.roll + kLag * followed.rate.roll) / kGain + kTrim;
    command.pitch = (followed.angle.pitch + kLag * followed.rate.pitch) / kGain - kTrim;
    tilt.roll = decay * tilt.roll + (1.0 - decay) * kGain * (command.roll - kTrim);
    tilt.pitch = decay * tilt.pitch + (1.0 - decay) * kGain * (command.pitch + kTrim);
    trim.update(tilt, command, 1, followed);
    untaught.update(tilt, command, 1);
  }
  EXPECT_NEAR(trim.angles().roll, kTrim, 1e-3);
  EXPECT_NEAR(trim.angles().pitch, -kTrim, 1e-3);
  const double by_angle = 1.0 / kGain - 1.0 / 0.9, by_rate = kLag / kGain - 0.25 / 0.9;
  const polyfly::TiltAngles angle = trim.feedForward({{0.1, -0.2}, {}}, 0.0);
  EXPECT_NEAR(angle.roll, 0.1 * by_angle, 0.05 * 0.1 * std::abs(by_angle));
  EXPECT_NEAR(angle.pitch, -0.2 * by_angle, 0.05 * 0.2 * std::abs(by_angle));
  const polyfly::TiltAngles rate = trim.feedForward({{}, {0.3, 0.4}}, 0.0);
  EXPECT_NEAR(rate.roll, 0.3 * by_rate, 0.1 * 0.3 * std::abs(by_rate));
  EXPECT_NEAR(rate.pitch, 0.4 * by_rate, 0.1 * 0.4 * std::abs(by_rate));

  // Over a gap of 20 periods the loops that were found are predicted as long.
  {
    constexpr int kPeriods = 20;
    constexpr double kGap = 0.3;
    polyfly::AttitudeTrim late({0.9, 0.25, 0.9, 0.25}, {});
    late.transferState(trim);
    AttitudeCommand command;
    command.roll = tilt.roll / kGain + kTrim + kGap;
    command.pitch = tilt.pitch / kGain - kTrim;
    const double left = std::exp(-kPeriods * kPeriod / kLag);
    tilt.roll = left * tilt.roll + (1.0 - left) * kGain * (command.roll - kTrim);
    late.update(tilt, command, kPeriods);
    EXPECT_NEAR(late.angles().roll, trim.angles().roll, 1e-4);
  }

  // Without a reference nothing is learnt, and the error turns with the trim.
  EXPECT_EQ(untaught.feedForward({{0.1, 0.1}, {0.3, 0.3}}, 0.0).roll, 0.0);
  polyfly::AttitudeTrim next({0.9, 0.25, 0.9, 0.25}, {});
  next.transferState(trim);
  EXPECT_EQ(next.feedForward({{0.1, -0.2}, {}}, 0.0).roll, angle.roll);
  // The numbers of the loops are kept, not their difference to a model.
  polyfly::AttitudeTrim known({kGain, kLag, kGain, kLag}, {});
  known.transferState(trim);
  EXPECT_NEAR(known.feedForward({{0.1, -0.2}, {0.3, 0.4}}, 0.0).roll, 0.0, 1e-3);
  trim.reset();
  EXPECT_EQ(trim.feedForward({{0.1, -0.2}, {}}, 0.0).roll, 0.0);
}

/// Flies round a circle of 8 m at 5 m/s for a minute with level thrust against its drag of 0.17 1/s; d = (0.3, 0, 0).
VehicleState teachDrag(polyfly::ForceObserver& observer) {
  constexpr double kRadius = 8.0, kRate = 5.0 / 8.0, kTrueDrag = 0.17;
  VehicleState state;
  for (int k = 0; k <= 6000; ++k) {
    const double phase = kRate * kPeriod * k;
    const Eigen::Vector3d out(std::cos(phase), std::sin(phase), 0.0), along(-out.y(), out.x(), 0.0);
    state.stamp = kPeriod * k;
    state.position = kRadius * out;
    state.velocity = kRadius * kRate * along;
    Eigen::Vector3d thrust = -kRadius * kRate * kRate * out + kTrueDrag * state.velocity;
    thrust += Eigen::Vector3d(-0.3, 0.0, kGravity);
    state.attitude = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), thrust);
    observer.update(state, thrust.norm(), 1, state.velocity);
  }
  return state;
}

TEST(ForceObserver, FindsADragAndLeavesItsForceToOneThatFindsNone) {
  const polyfly::MultirotorModel model;
  polyfly::ForceObserver observer(model, {}, 0.0, true), next(model, {}, 0.0, true), fixed(model, {});
  const VehicleState last = teachDrag(observer);
  EXPECT_NEAR(observer.drag().x(), 0.16, 0.01);
  EXPECT_NEAR(observer.drag().y(), 0.16, 0.01);
  EXPECT_NEAR(observer.disturbance().x(), 0.3, 0.05);
  next.transferState(observer);
  EXPECT_EQ(next.drag(), observer.drag());
  EXPECT_EQ(next.disturbance(), observer.disturbance());
  fixed.transferState(observer);
  EXPECT_EQ(fixed.drag(), Eigen::Vector3d::Zero());
  const Eigen::Vector3d whole = observer.disturbance() - observer.drag().cwiseProduct(last.velocity);
  EXPECT_LT((fixed.disturbance() - whole).norm(), 0.01);

  observer.setDisturbance({0.1, 0.2, 0.3});
  EXPECT_EQ(observer.drag(), Eigen::Vector3d::Zero());
  EXPECT_EQ(observer.disturbance(), Eigen::Vector3d(0.1, 0.2, 0.3));
}

/// A vehicle with the attitude loops of MomentModel about small angles, under a force and a moment,
/// integrated in steps of a tenth of a period.
struct Vehicle {
  void move(const AttitudeCommand& command) {
    constexpr int kSteps = 10;
    const double h = kPeriod / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      const Eigen::Matrix3d R = rotation();
      Eigen::Vector3d acceleration = command.thrust / kMass * R.col(2) + force;
      acceleration.z() -= kGravity;
      const Eigen::Vector3d drag(kDrag, kDrag, 0.0);
      acceleration -= R * drag.cwiseProduct(R.transpose() * velocity);
      Eigen::Vector3d angular = moment;
      angular.x() += 7.07 * 7.07 * (0.8 * command.roll - angles.x()) - 2.0 * 0.72 * 7.07 * rates.x();
      angular.y() += 7.07 * 7.07 * (0.84 * command.pitch - angles.y()) - 2.0 * 0.76 * 7.07 * rates.y();
      angular.z() += 5.0 * (command.yaw_rate - rates.z());
      position += h * velocity + 0.5 * h * h * acceleration;
      velocity += h * acceleration;
      angles += h * rates + 0.5 * h * h * angular;
      rates += h * angular;
    }
    time += kPeriod;
  }

  Eigen::Matrix3d rotation() const {
    return (Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()))
        .toRotationMatrix();
  }

  VehicleState measure() const {
    VehicleState state;
    state.stamp = time;
    state.position = position;
    state.velocity = velocity;
    state.attitude = Eigen::Quaterniond(rotation());
    // Body rates of the angle rates, z-y'-x''.
    const double sr = std::sin(angles.x()), cr = std::cos(angles.x());
    const double sp = std::sin(angles.y()), cp = std::cos(angles.y());
    state.angular_velocity = {rates.x() - sp * rates.z(), cr * rates.y() + sr * cp * rates.z(),
                              -sr * rates.y() + cr * cp * rates.z()};
    return state;
  }

  Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d angles = Eigen::Vector3d::Zero(), rates = Eigen::Vector3d::Zero();
  double time = 50.0;
};

VehicleObserver makeObserver(const polyfly::MomentModel& moments = {}) {
  return {polyfly::MultirotorModel{}, polyfly::MultirotorOptions{}, moments};
}

AttitudeCommand commandAt(double time) {
  AttitudeCommand command;
  command.roll = 0.2 * std::sin(2.0 * time);
  command.pitch = 0.15 * std::cos(1.3 * time);
  command.yaw_rate = 0.8;  // turns and turns: yaw must be unwrapped
  command.thrust = kMass * (kGravity + std::sin(time));
  return command;
}

void fly(Vehicle& vehicle, VehicleObserver& observer, int samples) {
  observer.update(vehicle.measure(), AttitudeCommand{});
  for (int k = 0; k < samples; ++k) {
    const AttitudeCommand command = commandAt(vehicle.time);
    vehicle.move(command);
    observer.update(vehicle.measure(), command);
  }
}

TEST(VehicleObserver, FindsForceAndMomentOfAnAgileFlight) {
  Vehicle vehicle;
  vehicle.force = {1.2, -0.7, 0.4};
  vehicle.moment = {3.0, -2.0, 0.5};
  VehicleObserver observer = makeObserver();
  fly(vehicle, observer, 2000);
  const polyfly::VehicleEstimate& estimate = observer.estimate();
  EXPECT_LT((estimate.force - vehicle.force).norm(), 0.02);
  EXPECT_LT((estimate.moment - vehicle.moment).norm(), 0.1);
  EXPECT_LT((estimate.position - vehicle.position).norm(), 0.01);
  EXPECT_LT((estimate.velocity - vehicle.velocity).norm(), 0.02);
  EXPECT_LT((estimate.attitude.head<2>() - vehicle.angles.head<2>()).norm(), 0.01);
  EXPECT_NEAR(estimate.attitude.z(), vehicle.angles.z(), 0.01);  // several turns
  EXPECT_GT(vehicle.angles.z(), 10.0);
  EXPECT_LT((estimate.angular_velocity - vehicle.rates).norm(), 0.05);
}

TEST(VehicleObserver, DragIsNoForce) {
  Vehicle vehicle;
  vehicle.velocity = {8.0, 0.0, 0.0};
  VehicleObserver observer = makeObserver();
  fly(vehicle, observer, 1000);
  EXPECT_LT(observer.estimate().force.norm(), 0.01);  // 0.08 m/s^2 with the wrong sign doubled
}

TEST(VehicleObserver, CountsLostSamplesFromTheStamps) {
  Vehicle vehicle;
  vehicle.force = {0.5, 0.0, 0.0};
  VehicleObserver observer = makeObserver();
  AttitudeCommand hover;
  hover.thrust = kMass * kGravity;
  observer.update(vehicle.measure(), hover);
  for (int k = 0; k < 1500; ++k) {
    vehicle.move(hover);
    if (k % 7 > 2) continue;  // most are lost
    observer.update(vehicle.measure(), hover);
  }
  EXPECT_LT((observer.estimate().force - vehicle.force).norm(), 0.01);
}

TEST(VehicleObserver, CalibrationAtHoverTakesTheModelsFault) {
  Vehicle vehicle;
  vehicle.force = {0.1, -0.05, -0.6};  // lift less than thought: the mass is wrong
  vehicle.moment = {0.4, 0.2, 0.0};
  polyfly::MomentModel moments;
  moments.calibration_duration = 2.0;
  VehicleObserver observer = makeObserver(moments);
  fly(vehicle, observer, 1500);
  observer.calibrate();
  EXPECT_TRUE(observer.isCalibrating());
  fly(vehicle, observer, 190);
  EXPECT_TRUE(observer.isCalibrating());
  fly(vehicle, observer, 20);
  EXPECT_FALSE(observer.isCalibrating());
  EXPECT_EQ(observer.calibrations(), 1U);
  EXPECT_LT((observer.estimate().force_offset - vehicle.force).norm(), 0.02);
  EXPECT_LT((observer.estimate().moment_offset - vehicle.moment).norm(), 0.1);
  EXPECT_LT(observer.estimate().force.norm(), 0.03);
  vehicle.force.x() += 1.0;  // now there is wind
  fly(vehicle, observer, 1500);
  EXPECT_NEAR(observer.estimate().force.x(), 1.0, 0.03);
  observer.reset();
  fly(vehicle, observer, 1500);
  // The offset stays after a reset.
  EXPECT_NEAR(observer.estimate().force.x(), 1.0, 0.03);
}

TEST(VehicleObserver, AJumpAnnouncedIsNoForce) {
  Vehicle vehicle;
  VehicleObserver observer = makeObserver();
  fly(vehicle, observer, 500);
  vehicle.position.x() += 4.0;
  observer.restart();
  fly(vehicle, observer, 1);
  EXPECT_LT(observer.estimate().force.norm(), 0.02);
  EXPECT_NEAR(observer.estimate().position.x(), vehicle.position.x(), 0.05);
}

/// Samples until nine tenths of a step of the force are found.
int samplesUntilFound(VehicleObserver& observer, Vehicle& vehicle, const Eigen::Vector3d& force) {
  vehicle.force = force;
  for (int k = 1; k <= 1000; ++k) {
    const AttitudeCommand command = commandAt(vehicle.time);
    vehicle.move(command);
    observer.update(vehicle.measure(), command);
    if (observer.estimate().force.x() > 0.9 * force.x()) return k;
  }
  return 1000;
}

TEST(VehicleObserver, NoisesOfAnotherOneTakeEffectAndNothingIsForgotten) {
  Vehicle vehicle;
  vehicle.moment = {1.0, 0.0, 0.0};
  VehicleObserver observer = makeObserver();
  fly(vehicle, observer, 1000);
  const int usual = samplesUntilFound(observer, vehicle, {1.0, 0.0, 0.0});
  fly(vehicle, observer, 1000);
  // The numbers of mav_control_rw.
  polyfly::MultirotorOptions options;
  options.noise = {0.01, 0.025, 0.015, 0.02, 0.1, 0.001, 0.0012, 0.01};
  options.disturbance_drift = std::sqrt(0.1);
  VehicleObserver quick({}, options, {});
  quick.transferState(observer);
  EXPECT_EQ(quick.estimate().force, observer.estimate().force);
  EXPECT_EQ(quick.estimate().moment, observer.estimate().moment);
  const int quickly = samplesUntilFound(quick, vehicle, {2.0, 0.0, 0.0});
  EXPECT_GT(usual, 100);
  EXPECT_LT(quickly, usual);
  fly(vehicle, quick, 500);
  EXPECT_NEAR(quick.estimate().force.x(), 2.0, 0.05);
  EXPECT_NEAR(quick.estimate().moment.x(), 1.0, 0.1);
}

TEST(VehicleObserver, DoesNotAllocateAndNamesABadOption) {
  Vehicle vehicle;
  VehicleObserver observer = makeObserver();
  const VehicleState state = vehicle.measure();
  const long before = polyfly_test::allocationCount();
  observer.calibrate();
  for (int k = 0; k < 10; ++k) {
    VehicleState next = state;
    next.stamp += kPeriod * k;
    observer.update(next, AttitudeCommand{});
  }
  EXPECT_EQ(polyfly_test::allocationCount(), before);
  polyfly::MomentModel moments;
  moments.roll_omega = -1.0;
  try {
    makeObserver(moments);
    FAIL() << "no error";
  } catch (const polyfly::Error& error) {
    EXPECT_EQ(std::string(error.what()).rfind("KF_observer/roll_omega: must lie in [", 0), 0U);
  }
}

/// What the law commands after it stood `seconds` at an error in x, without an observer.
template <class AnyLaw>
double pitchAfter(AnyLaw& law, double error, double seconds) {
  std::vector<polyfly::Reference> preview(static_cast<std::size_t>(law.previewLength()));
  VehicleState state;
  double pitch = 0.0;
  for (int k = 0; k < std::lround(seconds / kPeriod); ++k) {
    state.position.x() = error;
    pitch = law.step(state, preview.data()).command.pitch;
    law.prepare();
    state.stamp += kPeriod;
  }
  return pitch;
}

TEST(Integrator, AnswersAConstantErrorWithinItsBoundsAndForgetsIt) {
  polyfly::MultirotorOptions options;
  options.offset_free = false;
  polyfly_test::Flight without(options);
  options.integrator = true;
  polyfly_test::Flight with(options);
  const double plain = pitchAfter(*without.controller, 0.1, 5.0);
  const double more = pitchAfter(*with.controller, 0.1, 5.0);
  // 0.2 * 0.1 * 5 m/s^2 more, as an angle through g, the gain of the loop and the law of the made maps.
  EXPECT_NEAR(more - plain, -0.1 / kGravity * (1.0 + 1.0 / 0.9), 2e-3);
  with.controller->forget(polyfly::LawMemory::kIntegral);
  EXPECT_NEAR(pitchAfter(*with.controller, 0.1, 0.01), plain, 1e-6);

  polyfly_test::Flight far(options);  // beyond the ball
  EXPECT_EQ(pitchAfter(*far.controller, 0.5, 5.0), pitchAfter(*without.controller, 0.5, 5.0));
  polyfly_test::Flight long_time(options);
  const double bounded = pitchAfter(*long_time.controller, 0.39, 10.0);
  EXPECT_EQ(bounded, pitchAfter(*long_time.controller, 0.39, 1.0));  // 2 m s after 5.1 s
}

TEST(Integrator, WorksInTheNonlinearLawToo) {
  polyfly::MultirotorOptions options;
  options.offset_free = false;
  polyfly::NonlinearController without(options, {});
  options.integrator = true;
  polyfly::NonlinearController with(options, {});
  const double plain = pitchAfter(without, 0.1, 3.0);
  EXPECT_LT(pitchAfter(with, 0.1, 3.0), plain - 0.005);
}

TEST(Integrator, AKnownDisturbanceIsAnsweredFromTheFirstStep) {
  polyfly_test::Flight flight;
  flight.controller->setDisturbance({0.5, 0.0, -0.4});
  const double pitch = pitchAfter(*flight.controller, 0.0, 0.01);
  EXPECT_LT(pitch, -0.04);
  EXPECT_NEAR(flight.controller->report().axis[2].disturbance, -0.4, 1e-12);
}

TEST(FlightOptions, ThePageListsEachKey) {
  std::ifstream stream(polyfly::projectRoot() + "/online_controller/FLIGHT.md");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const auto expect_listed = [&](const std::string& key, auto&&...) {
    const std::string name = key.substr(key.find('/') + 1);
    EXPECT_NE(text.find(name + "`"), std::string::npos) << key;
  };
  polyfly::FlightOptions flight;
  polyfly::visitFlightOptions(flight, expect_listed);
  polyfly::MomentModel moments;
  polyfly::visitMomentModel(moments, expect_listed);
}

}  // namespace
