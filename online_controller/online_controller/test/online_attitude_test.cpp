#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "online_controller/types/attitude.hpp"

namespace {

using polyfly::TiltAngles;

constexpr double kPi = 3.14159265358979323846;
constexpr double kRounding = 1e-12;

TEST(Attitude, EulerAnglesUndoTheirRotation) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> turn(-kPi, kPi);
  std::uniform_real_distribution<double> pitch(-1.5, 1.5);
  for (int i = 0; i < 1000; ++i) {
    const double roll_in = turn(random);
    const double pitch_in = pitch(random);
    const double yaw_in = turn(random);
    const Eigen::Quaterniond attitude(Eigen::AngleAxisd(yaw_in, Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(pitch_in, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(roll_in, Eigen::Vector3d::UnitX()));
    const polyfly::EulerAngles angles = polyfly::eulerAngles(attitude);
    EXPECT_NEAR(angles.roll, roll_in, 1e-9);
    EXPECT_NEAR(angles.pitch, pitch_in, 1e-9);
    EXPECT_NEAR(angles.yaw, yaw_in, 1e-9);
  }
}

TEST(Attitude, EulerAnglesAreFiniteAtTheSingularity) {
  const Eigen::Quaterniond up(Eigen::AngleAxisd(0.5 * kPi, Eigen::Vector3d::UnitY()));
  const polyfly::EulerAngles angles = polyfly::eulerAngles(up);
  EXPECT_TRUE(std::isfinite(angles.roll) && std::isfinite(angles.yaw));
  EXPECT_NEAR(angles.pitch, 0.5 * kPi, 1e-6);
}

TEST(Attitude, WrapAngleKeepsTheDirectionAndTheRange) {
  for (const double angle : {0.0, 1.0, -1.0, kPi, -kPi, 3.5, -3.5, 7.0, 1e4, -1e4, std::nextafter(kPi, 0.0),
                             std::nextafter(-kPi, -4.0)}) {
    const double wrapped = polyfly::wrapAngle(angle);
    EXPECT_GE(wrapped, -kPi) << angle;
    EXPECT_LT(wrapped, kPi) << angle;
    EXPECT_NEAR(std::cos(wrapped), std::cos(angle), 1e-9) << angle;
    EXPECT_NEAR(std::sin(wrapped), std::sin(angle), 1e-9) << angle;
  }
  EXPECT_EQ(polyfly::wrapAngle(kPi), -kPi);
  EXPECT_EQ(polyfly::wrapAngle(0.25), 0.25);
}

TEST(Attitude, Equation40TurnsByTheYaw) {
  // Heading along +y: to accelerate along +x (world pitch), the body must roll to its right.
  const TiltAngles forward = polyfly::worldToBodyTilt({0.0, 0.1}, 0.5 * kPi);
  EXPECT_NEAR(forward.roll, 0.1, kRounding);
  EXPECT_NEAR(forward.pitch, 0.0, kRounding);
  // To accelerate along +y (negative world roll), it must pitch forward.
  const TiltAngles left = polyfly::worldToBodyTilt({-0.1, 0.0}, 0.5 * kPi);
  EXPECT_NEAR(left.roll, 0.0, kRounding);
  EXPECT_NEAR(left.pitch, 0.1, kRounding);
}

TEST(Attitude, Equation40AgreesWithTheThrustDirection) {
  // For small tilt, the horizontal specific force of the rotation matrix is that of the world-aligned angles.
  constexpr double kTilt = 1e-4;
  for (const double yaw : {0.3, 1.9, -2.7}) {
    const TiltAngles world{0.7 * kTilt, -0.4 * kTilt};
    const TiltAngles body = polyfly::worldToBodyTilt(world, yaw);
    const Eigen::Vector3d force =
        Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
        (Eigen::AngleAxisd(body.pitch, Eigen::Vector3d::UnitY()) *
         (Eigen::AngleAxisd(body.roll, Eigen::Vector3d::UnitX()) * Eigen::Vector3d::UnitZ()));
    EXPECT_NEAR(force.x(), world.pitch, kTilt * kTilt);
    EXPECT_NEAR(force.y(), -world.roll, kTilt * kTilt);
  }
}

TEST(Attitude, Equation40RoundTrip) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> any(-kPi, kPi);
  for (int i = 0; i < 1000; ++i) {
    const TiltAngles world{any(random), any(random)};
    const double yaw = any(random);
    const TiltAngles back = polyfly::bodyToWorldTilt(polyfly::worldToBodyTilt(world, yaw), yaw);
    EXPECT_NEAR(back.roll, world.roll, kRounding);
    EXPECT_NEAR(back.pitch, world.pitch, kRounding);
  }
}

// Against the difference quotient along the rotation that the rates make.
TEST(Attitude, TheRateOfTheTiltIsItsDerivative) {
  constexpr double kStep = 1e-6;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Quaterniond attitude = Eigen::AngleAxisd(kPi * any(random), Eigen::Vector3d::UnitZ()) *
                                        Eigen::AngleAxisd(0.8 * any(random), Eigen::Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(0.8 * any(random), Eigen::Vector3d::UnitX());
    const Eigen::Vector3d rates(3.0 * any(random), 3.0 * any(random), 3.0 * any(random));
    const auto tilt_after = [&](double time) {
      const Eigen::Quaterniond turned =
          attitude * Eigen::Quaterniond(Eigen::AngleAxisd(rates.norm() * time, rates.normalized()));
      const polyfly::EulerAngles angles = polyfly::eulerAngles(turned);
      return polyfly::bodyToWorldTilt({angles.roll, angles.pitch}, angles.yaw);
    };
    const TiltAngles before = tilt_after(-kStep), after = tilt_after(kStep);
    const TiltAngles rate = polyfly::worldTiltRate(polyfly::eulerAngles(attitude), rates);
    EXPECT_NEAR(rate.roll, (after.roll - before.roll) / (2.0 * kStep), 1e-7);
    EXPECT_NEAR(rate.pitch, (after.pitch - before.pitch) / (2.0 * kStep), 1e-7);
  }
}

TEST(Attitude, Equation41ByHand) {
  // T = 1.2, g = 9.8, roll 0.2, pitch -0.1: 11 / (0.980066577841242 * 0.995004165278026) = 11.280081...
  const TiltAngles tilt{0.2, -0.1};
  const double total = polyfly::compensatedThrust(1.2, tilt, 9.8, 0.5);
  EXPECT_NEAR(total, 11.0 / (0.980066577841242 * 0.995004165278026) + 0.5, 1e-12);
  const TiltAngles sent = polyfly::compensatedTilt({0.1, 0.3}, 11.5, 9.8, 0.2, -0.4);
  EXPECT_NEAR(sent.roll, (9.8 * 0.1 + 0.4) / 11.5, kRounding);
  EXPECT_NEAR(sent.pitch, (9.8 * 0.3 + 0.2) / 11.5, kRounding);
}

TEST(Attitude, Equation41KeepsTheThrustFiniteAtAnyTilt) {
  for (const double roll : {1.2, 0.5 * kPi, 2.0, kPi, -3.0}) {
    const double total = polyfly::compensatedThrust(0.0, {roll, 0.0}, 9.8, 0.0);
    EXPECT_GT(total, 0.0) << roll;
    EXPECT_LE(total, 9.8 / polyfly::kLeastTiltCosine) << roll;
  }
}

}  // namespace
