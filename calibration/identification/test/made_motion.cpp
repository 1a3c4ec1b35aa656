#include "made_motion.hpp"

#include <cmath>
#include <random>

namespace polyfly::test {

FlightSignals makeMotion(const MadeMotion& made, std::uint32_t seed, std::vector<double>* gusts) {
  constexpr double kStep = 1e-3;
  constexpr int kEach = 10;
  constexpr double kMemory = 0.5;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  FlightSignals signals;
  signals.source = "made motion";
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d disturbance = Eigen::Vector3d::Zero();
  const auto put = [&signals](const char* name, double time, double value) {
    signals.series[name].time.push_back(time);
    signals.series[name].value.push_back(value);
  };
  for (int i = 0; i < static_cast<int>(made.duration / kStep); ++i) {
    const double t = i * kStep;
    const double roll = 0.15 * std::sin(0.9 * t) + 0.05 * std::sin(2.3 * t);
    const double pitch = 0.12 * std::sin(1.1 * t + 1.0);
    const double yaw = std::remainder(0.3 * t, 2.0 * 3.14159265358979);
    const double thrust = kMass * kGravity * (1.0 + 0.1 * std::sin(0.7 * t));
    // Third column of Rz(yaw) Ry(pitch) Rx(roll), written out.
    const Eigen::Vector3d up(
        std::cos(yaw) * std::sin(pitch) * std::cos(roll) + std::sin(yaw) * std::sin(roll),
        std::sin(yaw) * std::sin(pitch) * std::cos(roll) - std::cos(yaw) * std::sin(roll),
        std::cos(pitch) * std::cos(roll));
    const Eigen::Vector3d more(t > 0.5 * made.duration ? made.step : 0.0, 0.0, 0.0);
    if (i % kEach == 0) {
      put("roll", t, roll);
      put("pitch", t, pitch);
      put("yaw", t, yaw);
      put("thrust_cmd", t, thrust);
      put("vx", t, velocity.x() + made.noise * normal(random));
      put("vy", t, velocity.y() + made.noise * normal(random));
      put("vz", t, velocity.z() + made.noise * normal(random));
      if (gusts != nullptr) gusts->push_back(disturbance.x() + more.x());
    }
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    if (made.drag_turns) turn << std::cos(yaw), -std::sin(yaw), 0, std::sin(yaw), std::cos(yaw), 0, 0, 0, 1;
    velocity += kStep * (thrust / kMass * up - Eigen::Vector3d(0.0, 0.0, kGravity) -
                         turn * made.drag.asDiagonal() * turn.transpose() * velocity + disturbance + more);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      disturbance[axis] += -disturbance[axis] * kStep / kMemory +
                           made.gust * std::sqrt(2.0 * kStep / kMemory) * normal(random);
    }
  }
  return signals;
}

}  // namespace polyfly::test
