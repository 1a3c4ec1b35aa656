#pragma once

#include <cstdint>
#include <deque>

#include "fixedwing_plant/aircraft.hpp"
#include "fixedwing_plant/airframe.hpp"
#include "fixedwing_plant/autopilot.hpp"
#include "fixedwing_plant/dryden.hpp"

namespace polyfly {

struct SixDofOptions {
  Airframe airframe;
  AutopilotOptions autopilot;
  /// Delay from a roll reference to the autopilot [s].
  double command_delay = 0.08;
  /// Time constant of the surfaces [s].
  double actuator_lag = 0.05;
  /// Time constant of the thrust [s].
  double motor_lag = 0.25;
  /// Aileron deflection of a warped wing; it causes a steady error of roll [rad].
  double aileron_trim = 0.015;
  /// Roll mounting error of the attitude sensor, in all roll measurements [rad].
  double roll_mounting = 0.01;
  /// Mean wind (north, east) [m/s].
  Eigen::Vector2d wind{0.0, 0.0};
  /// Wind at 6 m above ground from which the gusts follow; 0: no gusts [m/s].
  double turbulence = 0.0;
};

/// A rigid aircraft in six degrees of freedom with published coefficients, an autopilot of its own, actuators, and
/// Dryden gusts. The controller has no model of its roll loop, its slip in turns or its trim errors. Nor does it know
/// how airspeed and altitude change in a bank.
class SixDofAircraft : public Aircraft {
 public:
  /// Begins in level trimmed flight at the heading of `start` and the autopilot's airspeed and altitude.
  SixDofAircraft(const SixDofOptions& options, const AircraftState& start, std::uint32_t seed);

  void fly(double roll_reference, double duration) override;
  AircraftState state() const override;
  double airspeed() const override;
  /// Wind including the gusts [m/s].
  Eigen::Vector2d wind() const override;
  double altitude() const override { return -body_.position.z(); }

  const BodyState& body() const { return body_; }
  /// Deflections and throttle after the actuators.
  const Controls& controls() const { return surfaces_; }
  /// Sideslip angle beta, without gusts [rad].
  double slip() const;

 private:
  void step(double roll_reference, double duration);
  AutopilotInput measured() const;

  SixDofOptions options_;
  Autopilot autopilot_;
  DrydenGusts gusts_;
  std::deque<double> delayed_;
  BodyState body_;
  AirMotion air_;
  Controls surfaces_;
  double time_ = 0.0;
  double heading_ = 0.0;  // not wrapped [rad]
};

}  // namespace polyfly
