// Odometry that contradicts itself: headings that creep away from what the body rates say and return at once,
// velocities that do not lead from position to position, stamps that stand still. Three vehicles, seeded.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <utility>

#include "identification/csv_log.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "outlier_flight.hpp"
#include "reference_data.hpp"
#include "shipped_problems.hpp"

namespace polyfly {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::unique_ptr<ControlLaw> linear(const MultirotorOptions& options) {
  static const std::array<MpcProblem, 3> kProblems = shippedProblems();
  return std::make_unique<MultirotorController>(kProblems, options);
}

/// The shipped model with the mass set: a fast vehicle, the Firefly, a heavy one with slow loops and rotors.
std::array<Setting, 3> vehicles() {
  std::array<Setting, 3> result;
  const double masses[] = {0.5, 1.52, 8.0}, loops[] = {0.1, 0.25, 0.42}, motors[] = {0.02, 0.02, 0.07};
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i].force *= masses[i] / result[i].options.mass;
    result[i].options.mass = masses[i];
    result[i].loop_time = loops[i];
    result[i].motor_time = motors[i];
  }
  return result;
}

/// The heading's error grows to `angle` within `rise` [s], and is gone after `length` [s].
Fault creepingHeading(double angle, double rise, double length) {
  const auto spoil = [=](VehicleState& state, double since) {
    const double error = angle * std::min(1.0, (since + kPeriod) / rise);
    state.attitude = Eigen::AngleAxisd(error, Eigen::Vector3d::UnitZ()) * state.attitude;
  };
  return {spoil, length};
}

Fault scaledVelocity(double factor, double length) {
  return {[factor](VehicleState& state, double) { state.velocity *= factor; }, length};
}

Fault frozenStamps(double length) {
  const auto stamp = std::make_shared<double>(0.0);
  const auto spoil = [stamp](VehicleState& state, double since) {
    if (since == 0.0) *stamp = state.stamp;
    state.stamp = *stamp;
  };
  return {spoil, length};
}

Flown fly(const Setting& setting, bool moving, const Fault& fault) {
  OutlierFlight flight(linear, setting);
  flight.fly(5.0);
  if (moving) {
    flight.goAhead(6.0, 5.0);
    flight.fly(1.5);
  }
  return flight.fly(fault.length + 5.0, fault);
}

// Without the gate of the attitude they fly 10 to 35 m; when the truth is refused they are lost.
TEST(OdometryContradiction, AHeadingThatCreptDoesNotKeepTheTruthOut) {
  for (const Setting& setting : vehicles()) {
    for (const bool moving : {false, true}) {
      const Flown quick = fly(setting, moving, creepingHeading(kPi, 0.04, 2.0));
      EXPECT_LT(quick.away, moving ? 0.1 : 1.0) << setting.options.mass;
      EXPECT_LT(quick.last, 0.05) << setting.options.mass;
      const Flown slow = fly(setting, moving, creepingHeading(0.5 * kPi, 0.5, 3.0));
      EXPECT_LT(slow.away, moving ? 0.1 : 2.0) << setting.options.mass;
      EXPECT_LT(slow.last, 0.05) << setting.options.mass;
      // In hover the wrong one was believed in the end; the true one was not refused.
      EXPECT_LT(slow.refused, moving ? kPeriod : 2.2) << setting.options.mass;
    }
  }
}

TEST(OdometryContradiction, AVelocityThatContradictsIsReplaced) {
  for (const Setting& setting : vehicles()) {
    for (const auto& [factor, length] : {std::pair{-1.0, 1.0}, {0.0, 1.0}, {0.5, 4.0}}) {
      const Flown flown = fly(setting, true, scaledVelocity(factor, length));
      EXPECT_LT(flown.away, 0.8) << setting.options.mass << " " << factor;
      EXPECT_LT(flown.last, 0.05) << setting.options.mass << " " << factor;
      EXPECT_EQ(flown.refused, 0.0);
    }
  }
}

TEST(OdometryContradiction, TheStatusSaysSo) {
  OutlierFlight flight(linear, vehicles()[1]);
  flight.fly(5.0);
  flight.goAhead(6.0, 5.0);
  flight.fly(1.5);
  EXPECT_EQ(flight.supervisor().report().status, ControlStatus::kOptimal);
  flight.fly(0.8, scaledVelocity(0.0, 0.8));
  EXPECT_EQ(flight.supervisor().report().status, ControlStatus::kSuboptimal);
  EXPECT_EQ(flight.supervisor().report().reason, ControlReason::kContradiction);
  flight.fly(4.0);
  EXPECT_EQ(flight.supervisor().report().status, ControlStatus::kOptimal);
}

TEST(OdometryContradiction, StampsThatStandStillAreSilence) {
  for (const Setting& setting : vehicles()) {
    const Flown flown = fly(setting, true, frozenStamps(1.0));
    EXPECT_NEAR(flown.refused, 0.89, 1.5 * kPeriod);
    EXPECT_LT(flown.away, 0.5);
    EXPECT_LT(flown.last, 0.05);
  }
}

/// Round a circle at `speed`, while it yaws and tilts fast. `factor` is that of the rates, `wrong` turns the velocity.
VehicleState onCircle(double time, double speed, double factor, double wrong = 0.0) {
  constexpr double kRadius = 8.0, kStep = 1e-4;
  const auto attitude = [speed](double t) {
    return Eigen::Quaterniond(
        Eigen::AngleAxisd(0.5 * speed * t + (speed > 0.0 ? 0.8 * std::sin(3.0 * t) : 0.0),
                          Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(0.3 * std::sin(2.0 * t), Eigen::Vector3d::UnitY()) *
        Eigen::AngleAxisd(0.2 * std::cos(2.6 * t), Eigen::Vector3d::UnitX()));
  };
  const double angle = speed / kRadius * time;
  VehicleState state;
  state.stamp = 10.0 + time;
  state.position = kRadius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
  state.velocity = speed * Eigen::Vector3d(-std::sin(angle + wrong), std::cos(angle + wrong), 0.0);
  state.attitude = attitude(time);
  const Eigen::AngleAxisd turn(attitude(time - kStep).conjugate() * attitude(time + kStep));
  state.angular_velocity = factor * turn.angle() / (2.0 * kStep) * turn.axis();
  return state;
}

// Absent rates, rates in degrees, 20 Hz, jitter and noise.
TEST(OdometryContradiction, ATrueFlightIsNone) {
  for (const double factor : {1.0, 0.0, 180.0 / kPi, std::numeric_limits<double>::quiet_NaN()}) {
    for (const double period : {0.01, 0.05}) {
      for (const double speed : {0.0, 4.0, 8.0}) {
        GaussianSource noise(1);
        OdometryGate gate{MultirotorOptions{}};
        for (int k = 0; k * period < 20.0; ++k) {
          const double jitter = 0.1 * period * std::clamp(noise.next3().x(), -3.0, 3.0);
          VehicleState state = onCircle(k * period + jitter, speed, factor, 0.15);
          state.position += 0.02 * noise.next3();
          state.velocity += 0.1 * noise.next3();
          const OdometryGate::Verdict verdict = gate.check(state);
          ASSERT_EQ(verdict.refusal, ControlReason::kNone)
              << factor << " " << period << " " << speed << " " << k;
          ASSERT_FALSE(verdict.contradicts) << factor << " " << period << " " << speed << " " << k;
        }
      }
    }
  }
}

TEST(OdometryContradiction, CorrectionsAndGapsAreNone) {
  OdometryGate gate{MultirotorOptions{}};
  for (int k = 0; k < 2000; ++k) {
    if (k % 900 > 800) continue;  // silence of a second
    VehicleState state = onCircle(k * kPeriod, 1.0, 1.0);
    state.position.x() += 0.4 * (k / 300);  // one correction each three seconds
    const OdometryGate::Verdict verdict = gate.check(state);
    EXPECT_EQ(verdict.refusal, ControlReason::kNone) << k;
    EXPECT_FALSE(verdict.contradicts) << k;
  }
}

TEST(OdometryContradiction, AnotherFrameOfTheVelocityIsFound) {
  for (const double wrong : {0.5 * kPi, kPi, -1.0}) {
    OdometryGate gate{MultirotorOptions{}};
    int found = 0;
    for (int k = 0; k < 200; ++k) {
      VehicleState state = onCircle(k * kPeriod, 1.0, 1.0, wrong);
      found += gate.check(state).contradicts ? 1 : 0;
    }
    EXPECT_GT(found, 100) << wrong;
  }
}

/// A recorded flight, with its columns of roll, pitch, yaw, and of the body rates.
struct Recorded {
  const char* file;
  std::array<const char*, 3> angles, rates;
};

// Its positions are another matter: those of the first two files have velocities of an unknown frame.
TEST(OdometryContradiction, AttitudesOfRecordedFlightsAreNotRefused) {
  const std::filesystem::path logs = referenceData("flight_logs");
  if (logs.empty()) GTEST_SKIP() << "The recorded flights are not here: set POLYFLY_DATA to their folder.";
  const std::array<const char*, 3> vicon{"roll_vicon_rad", "pitch_vicon_rad", "yaw_vicon_rad"},
      rates{"wx_radps", "wy_radps", "wz_radps"};
  for (const Recorded& flight : {Recorded{"mr_asctec_pitchroll.csv", vicon, rates},
                                 {"mr_asctec_height.csv", vicon, rates},
                                 {"mr_jay_100932.csv",
                                  {"roll_imu_rad", "pitch_imu_rad", "yaw_imu_rad"},
                                  {"gx_radps", "gy_radps", "gz_radps"}}}) {
    const CsvLog log = readCsv(logs / flight.file);
    for (const bool has_rates : {false, true}) {
      for (const std::size_t every : {1U, 2U, 5U}) {  // 100, 50 and 20 Hz
        OdometryGate gate{MultirotorOptions{}};
        for (std::size_t k = 0; k < log.rows; k += every) {
          const auto at = [&](const char* column) { return log.column(column)[k]; };
          VehicleState state;
          state.stamp = at("t_s");
          state.attitude = Eigen::AngleAxisd(at(flight.angles[2]), Eigen::Vector3d::UnitZ()) *
                           Eigen::AngleAxisd(at(flight.angles[1]), Eigen::Vector3d::UnitY()) *
                           Eigen::AngleAxisd(at(flight.angles[0]), Eigen::Vector3d::UnitX());
          if (has_rates)
            state.angular_velocity = {at(flight.rates[0]), at(flight.rates[1]), at(flight.rates[2])};
          const OdometryGate::Verdict verdict = gate.check(state);
          ASSERT_EQ(verdict.refusal, ControlReason::kNone) << flight.file << " " << state.stamp;
          ASSERT_FALSE(verdict.contradicts) << flight.file << " " << state.stamp;
        }
      }
    }
  }
}

}  // namespace
}  // namespace polyfly
