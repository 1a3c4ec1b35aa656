#pragma once

#include <Eigen/Core>
#include <string>

#include "fixedwing_lateral/switch_gate.hpp"

namespace polyfly {

// Lateral-directional motion at constant altitude (Eq. 45, 47):
//
//   n'   = V cos psi + w_n        phi' = p
//   e'   = V sin psi + w_e        p'   = b0 phi_r - a1 p - a0 phi
//   psi' = g tan(phi) / V         x_sw' = alpha once the switch condition was met, else 0
//
// and, where the aircraft is known to differ: phi_r + roll_bias for phi_r, and turn_gain g tan(phi) / V +
// turn_bias for psi'.
//
// Everything here has a fixed size: nothing allocates, and only checkModel throws.

/// Rows of the state.
struct LateralIndex {
  static constexpr int kNorth = 0;     ///< n [m]
  static constexpr int kEast = 1;      ///< e [m]
  static constexpr int kRoll = 2;      ///< phi [rad], |phi| < pi/2
  static constexpr int kHeading = 3;   ///< psi, clockwise from north, not wrapped [rad]
  static constexpr int kRollRate = 4;  ///< p [rad/s]
  static constexpr int kSwitch = 5;    ///< x_sw [-]
  static constexpr int kSize = 6;
};

using LateralState = Eigen::Matrix<double, LateralIndex::kSize, 1>;

constexpr double kGravity = 9.81;  ///< g [m/s^2]
/// alpha of Eq. 47 [1/s], and the threshold of x_sw, above which the switch has happened for good [-]. As published.
constexpr double kSwitchRate = 1.0;
constexpr double kSwitchThreshold = 0.05;

/// Constant during a flight. The roll loop is that of the Techpod.
struct LateralModel {
  /// Stiffness of the roll loop [1/s^2], > 0.
  double a0 = 13.97;
  /// Damping of the roll loop [1/s], > 0.
  double a1 = 6.577;
  /// Gain of the roll loop [1/s^2], > 0.
  double b0 = 13.48;
  /// Greatest roll rate that the autopilot flies. After its first moves the horizon keeps roll references near enough to the
  /// predicted roll for it, and turns are planned by it. 0: unknown [rad/s].
  double roll_rate_max = 0.0;
};

/// The online data: constant over a horizon.
struct LateralConditions {
  double airspeed = 14.0;  ///< V [m/s], must be positive
  /// Velocity of the air over ground, (w_n, w_e) [m/s].
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();
  /// Bias added to every roll reference [rad].
  double roll_bias = 0.0;
  /// Gain of the turn rate by roll [-], must be positive.
  double turn_gain = 1.0;
  /// Bias added to the turn rate [rad/s].
  double turn_bias = 0.0;
  /// Gate at the end of the current segment.
  SwitchGate gate;
};

/// Throws polyfly::Error, beginning with `where`, if a number is out of its range.
void checkModel(const LateralModel& model, const std::string& where);

/// (n', e') [m/s].
Eigen::Vector2d groundVelocity(const LateralConditions& conditions, double heading) noexcept;

/// The roll [rad] at which Eq. 45 turns along a path of that curvature [1/m, positive to the right], at a ground
/// speed [m/s]. The cosine of the angle between heading and course must be positive: see turn_limits.hpp.
double rollOfTurn(double curvature, double ground_speed, double crab_cosine,
                  const LateralConditions& conditions) noexcept;

/// x_sw has passed the threshold: the state belongs to the next segment.
bool hasSwitched(const LateralState& state) noexcept;

/// Eq. 45 and 47.
LateralState lateralRate(const LateralModel& model, const LateralConditions& conditions,
                         const LateralState& state, double roll_reference) noexcept;

/// What one integration is over.
struct LateralStep {
  double roll_reference = 0.0;  ///< phi_r, held during the step [rad]
  double duration = 0.1;        ///< [s]
};

/// One step of the classical Runge-Kutta method of fourth order.
LateralState integrate(const LateralModel& model, const LateralConditions& conditions,
                       const LateralState& state, const LateralStep& step) noexcept;

}  // namespace polyfly
