#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "online_controller/flight/flight_supervisor.hpp"
#include "polyfly_test/attitude_plants.hpp"

namespace polyfly {

// Control period [s].
constexpr double kPeriod = 0.01;

using MakeLaw = std::unique_ptr<ControlLaw> (*)(const MultirotorOptions&);

/// Changes an odometry, `since` seconds after the fault began.
using Spoil = std::function<void(VehicleState& state, double since)>;

struct Fault {
  Spoil spoil;
  double length = 0.0;  ///< [s]
};

/// What a flight did since its fault began.
struct Flown {
  double tilt = 0.0;     ///< greatest [rad]
  double away = 0.0;     ///< greatest distance from the reference [m]
  double refused = 0.0;  ///< odometry [s]
  double last = 0.0;     ///< distance from the reference at the end [m]
};

struct Setting {
  AttitudeLoop loop = AttitudeLoop::kBodyRates;
  bool noisy = true;
  /// Force of the wind [N].
  Eigen::Vector3d force{0.4, -0.3, 0.0};
  MultirotorOptions options;
  /// Time constants of the vehicle's attitude loops and of its rotors [s].
  double loop_time = 0.25;
  double motor_time = 0.02;
};

/// A rigid body that is told to hold a pose 1 m up, and by its odometry where it is.
class OutlierFlight {
 public:
  explicit OutlierFlight(MakeLaw make, const Setting& setting = {})
      : law_(std::make_unique<LawSwitch>(make(setting.options), setting.options)),
        supervisor_(*law_, setting.options, FlightOptions{}),
        plant_(plantOptions(setting), {0.0, 0.0, 1.0}, 0.0) {
    step({}, 0.0);
    supervisor_.onReference(ReferenceTrajectory::pose({0.0, 0.0, 1.0}, 0.0), std::nullopt);
  }

  Flown fly(double seconds, const Fault& fault = {}) {
    Flown flown;
    const long samples = std::lround(seconds / kPeriod), spoilt = std::lround(fault.length / kPeriod);
    for (long k = 0; k < samples; ++k) {
      step(k < spoilt ? fault.spoil : Spoil{}, static_cast<double>(k) * kPeriod);
      const Eigen::Vector3d up = plant_.attitude() * Eigen::Vector3d::UnitZ();
      flown.tilt = std::max(flown.tilt, std::acos(std::min(1.0, up.z())));
      flown.refused += supervisor_.lastRefusal() == ControlReason::kNone ? 0.0 : kPeriod;
      flown.last = (plant_.position() - place_(plant_.time())).norm();
      flown.away = std::max(flown.away, flown.last);
    }
    return flown;
  }

  /// From now on along x, from rest to rest, and turned by `turn` [rad] meanwhile.
  void goAhead(double length, double duration, double turn = 0.0) {
    constexpr int kPoints = 40;
    const double begin = plant_.time();
    const auto place = [=](double time) -> Eigen::Vector3d {
      const double s = std::clamp((time - begin) / duration, 0.0, 1.0);
      return {length * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), 0.0, 1.0};
    };
    std::vector<TrajectorySample> samples(kPoints + 1);
    for (int i = 0; i <= kPoints; ++i) {
      TrajectorySample& sample = samples[static_cast<std::size_t>(i)];
      sample.time = duration * i / kPoints;
      sample.position = place(begin + sample.time);
      sample.yaw = turn * i / kPoints;
    }
    supervisor_.onReference(ReferenceTrajectory(std::move(samples)), begin);
    place_ = place;
  }

  FlightSupervisor& supervisor() { return supervisor_; }
  const AttitudePlant& plant() const { return plant_; }

 private:
  static AttitudePlantOptions plantOptions(const Setting& setting) {
    AttitudePlantOptions options;
    options.loop = setting.loop;
    options.force = setting.force;
    options.mass = setting.options.mass;
    options.roll_time = options.pitch_time = setting.loop_time;
    options.motor_time = setting.motor_time;
    if (setting.noisy) {
      options.position_noise = 0.002;
      options.velocity_noise = 0.01;
      options.attitude_noise = 0.002;
    }
    return options;
  }

  void step(const Spoil& spoil, double since) {
    VehicleState state = plant_.measure();
    if (spoil) spoil(state, since);
    const AttitudeCommand command = supervisor_.onOdometry(state).command;
    if (supervisor_.sends()) sent_ = command;
    law_->prepare();
    plant_.advance(sent_, kPeriod);
  }

  std::unique_ptr<LawSwitch> law_;
  FlightSupervisor supervisor_;
  AttitudePlant plant_;
  std::function<Eigen::Vector3d(double)> place_ = [](double) { return Eigen::Vector3d(0.0, 0.0, 1.0); };
  AttitudeCommand sent_{0.0, 0.0, 0.0, MultirotorOptions{}.mass* MultirotorOptions{}.gravity};
};

/// The message's orientation is off about the vertical, so that its twist is turned with it.
inline Fault yawOff(double angle, double length) {
  const auto spoil = [angle](VehicleState& state, double) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
    state.attitude = turn * state.attitude;
    state.velocity = turn * state.velocity;
  };
  return {spoil, length};
}

/// The first odometry again and again, under new stamps.
inline Fault repeated(double length) {
  const auto first = std::make_shared<VehicleState>();
  const auto spoil = [first](VehicleState& state, double since) {
    if (since == 0.0) *first = state;
    const double stamp = state.stamp;
    state = *first;
    state.stamp = stamp;
  };
  return {spoil, length};
}

/// As `repeated`, with only one part of the odometry.
inline Fault repeatedPart(double length, bool pose) {
  const auto first = std::make_shared<VehicleState>();
  const auto spoil = [first, pose](VehicleState& state, double since) {
    if (since == 0.0) *first = state;
    // The twist of the message is in the body.
    const Eigen::Vector3d velocity =
        (pose ? state : *first).attitude.conjugate() * (pose ? state : *first).velocity;
    if (pose) {
      state.position = first->position;
      state.attitude = first->attitude;
    } else {
      state.angular_velocity = first->angular_velocity;
    }
    state.velocity = state.attitude * velocity;
  };
  return {spoil, length};
}

/// Another frame: all that was known is turned about where the vehicle is.
inline Fault turnedFrame(const Eigen::Vector3d& center, double angle, double length) {
  const auto spoil = [=](VehicleState& state, double) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
    state.attitude = turn * state.attitude;
    state.velocity = turn * state.velocity;
    state.position = center + turn * (state.position - center);
  };
  return {spoil, length};
}

enum class Task { kHover, kStart, kLine, kTurningLine };

}  // namespace polyfly
