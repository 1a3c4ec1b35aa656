#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"
#include "polyfly_test/dryden_turbulence.hpp"
#include "polyfly_test/gaussian_source.hpp"
#include "polyfly_test/slung_load.hpp"

namespace polyfly {

/// The vehicle that flies in the simulator, Eq. 37, and what disturbs it. Vectors are in the world frame W
/// (x, y, z up). The defaults are those of the Firefly hexacopter, undisturbed and measured without error.
struct PlantOptions {
  double mass = 1.52;  ///< [kg]
  /// Gravity g of Eq. 37 [m/s^2].
  double gravity = 9.8066;

  /// Gain K_phi of Eq. 37 [-].
  double roll_gain = 0.9;
  /// Time constant tau_phi of Eq. 37 [s].
  double roll_time = 0.25;
  /// Gain K_theta of Eq. 37 [-].
  double pitch_gain = 0.9;
  /// Time constant tau_theta of Eq. 37 [s].
  double pitch_time = 0.255;
  /// True roll where the attitude controller sees none (misalignment) [rad].
  double roll_offset = 0.0;
  /// True pitch where the attitude controller sees none [rad].
  double pitch_offset = 0.0;
  /// Lag of the yaw rate behind its command [s]. 0: none.
  double yaw_rate_time = 0.0;
  /// Lag of the thrust behind its command [s]. 0: none.
  double thrust_time = 0.0;

  /// Drag A_x, A_y, A_z per mass [1/s].
  Eigen::Vector3d drag{0.01, 0.01, 0.0};

  /// Limit of roll and pitch: commands are cut to +- this value [rad].
  double angle_max = 0.7853982;
  double yaw_rate_max = 1.5707963;  ///< [rad/s]
  /// Least thrust per mass [m/s^2].
  double thrust_min = 5.0;
  /// Greatest thrust per mass [m/s^2].
  double thrust_max = 20.0;

  /// Constant part of d(t) [m/s^2].
  Eigen::Vector3d wind = Eigen::Vector3d::Zero();
  /// Standard deviation of the Gauss-Markov part of d(t) [m/s^2].
  Eigen::Vector3d gust_sigma = Eigen::Vector3d::Zero();
  /// Correlation time of the gusts [s].
  double gust_time = 1.0;

  /// Mean wind [m/s]. It acts through `drag`.
  Eigen::Vector3d air_velocity = Eigen::Vector3d::Zero();
  /// Standard deviation of the Dryden turbulence in the wind: along, across, up [m/s].
  Eigen::Vector3d turbulence_sigma = Eigen::Vector3d::Zero();
  /// Length scale of the turbulence [m].
  double turbulence_length = 1.0;

  /// Load that hangs below the vehicle's centre.
  SlungLoad load;
  /// Short force on the load [N].
  Eigen::Vector3d load_hit = Eigen::Vector3d::Zero();
  /// Start of the force on the load [s].
  double load_hit_start = 0.0;
  /// Duration of the force on the load [s]. 0: never.
  double load_hit_time = 0.0;

  /// Short push, added to d(t) [m/s^2].
  Eigen::Vector3d kick = Eigen::Vector3d::Zero();
  /// Start of the push [s].
  double kick_start = 0.0;
  /// Duration of the push [s]. 0: never.
  double kick_time = 0.0;

  /// Rates of roll, pitch and yaw of a tumble without thrust, as after the loss of a rotor [rad/s].
  Eigen::Vector3d tumble{12.0, 7.0, 4.0};
  /// Start of the tumble [s].
  double tumble_start = 0.0;
  /// Duration of the tumble [s]. 0: never.
  double tumble_time = 0.0;

  /// Standard deviation of the position noise per axis [m].
  double position_noise = 0.0;
  /// Standard deviation of the velocity noise per axis [m/s].
  double velocity_noise = 0.0;
  /// Standard deviation of the attitude noise per axis [rad].
  double attitude_noise = 0.0;
  /// Standard deviation of the angular velocity noise per axis [rad/s].
  double angular_velocity_noise = 0.0;

  /// Time from odometry to the effect of its command [s].
  double command_delay = 0.0;
  /// Age of the state that an odometry holds [s].
  double odometry_delay = 0.0;

  /// Time between odometry samples [s].
  double period = 0.01;
  /// Step of the integration [s]. It must divide the period.
  double substep = 0.001;
  /// Seed of noise and gusts.
  int seed = 1;
};

/// Lists the fields of PlantOptions once: visit(key, field, unit, range). A vector's range is that of each
/// entry.
template <class Options, class Visitor>
void visitPlantOptions(Options& self, Visitor&& visit) {
  visit("mass", self.mass, "kg", Range{0.01, 1000.0});
  visit("gravity", self.gravity, "m/s^2", Range{0.0, 100.0});
  visit("roll_gain", self.roll_gain, "-", Range{0.01, 10.0});
  visit("roll_time", self.roll_time, "s", Range{0.001, 10.0});
  visit("pitch_gain", self.pitch_gain, "-", Range{0.01, 10.0});
  visit("pitch_time", self.pitch_time, "s", Range{0.001, 10.0});
  visit("roll_offset", self.roll_offset, "rad", Range{-0.5, 0.5});
  visit("pitch_offset", self.pitch_offset, "rad", Range{-0.5, 0.5});
  visit("yaw_rate_time", self.yaw_rate_time, "s", Range{0.0, 10.0});
  visit("thrust_time", self.thrust_time, "s", Range{0.0, 10.0});
  visit("drag", self.drag, "1/s", Range{0.0, 100.0});
  visit("angle_max", self.angle_max, "rad", Range{0.0, 1.5});
  visit("yaw_rate_max", self.yaw_rate_max, "rad/s", Range{0.0, 100.0});
  visit("thrust_min", self.thrust_min, "m/s^2", Range{0.0, 1000.0});
  visit("thrust_max", self.thrust_max, "m/s^2", Range{0.0, 1000.0});
  visit("wind", self.wind, "m/s^2", Range{-100.0, 100.0});
  visit("gust_sigma", self.gust_sigma, "m/s^2", Range{0.0, 100.0});
  visit("gust_time", self.gust_time, "s", Range{0.001, 1000.0});
  visit("air_velocity", self.air_velocity, "m/s", Range{-100.0, 100.0});
  visit("turbulence_sigma", self.turbulence_sigma, "m/s", Range{0.0, 100.0});
  visit("turbulence_length", self.turbulence_length, "m", Range{0.01, 10000.0});
  visit("load/mass", self.load.mass, "kg", Range{0.0, 1000.0});
  visit("load/length", self.load.length, "m", Range{0.01, 1000.0});
  visit("load/stiffness", self.load.stiffness, "N/m", Range{0.01, 1e7});
  visit("load/damping", self.load.damping, "N s/m", Range{0.0, 1e5});
  visit("load/drag", self.load.drag, "N s/m", Range{0.0, 1000.0});
  visit("load/hit", self.load_hit, "N", Range{-1000.0, 1000.0});
  visit("load/hit_start", self.load_hit_start, "s", Range{0.0, 1000000.0});
  visit("load/hit_time", self.load_hit_time, "s", Range{0.0, 1000.0});
  visit("kick", self.kick, "m/s^2", Range{-100.0, 100.0});
  visit("kick_start", self.kick_start, "s", Range{0.0, 1000000.0});
  visit("kick_time", self.kick_time, "s", Range{0.0, 1000.0});
  visit("tumble", self.tumble, "rad/s", Range{-100.0, 100.0});
  visit("tumble_start", self.tumble_start, "s", Range{0.0, 1000000.0});
  visit("tumble_time", self.tumble_time, "s", Range{0.0, 1000.0});
  visit("position_noise", self.position_noise, "m", Range{0.0, 10.0});
  visit("velocity_noise", self.velocity_noise, "m/s", Range{0.0, 10.0});
  visit("attitude_noise", self.attitude_noise, "rad", Range{0.0, 1.0});
  visit("angular_velocity_noise", self.angular_velocity_noise, "rad/s", Range{0.0, 10.0});
  visit("command_delay", self.command_delay, "s", Range{0.0, 1.0});
  visit("odometry_delay", self.odometry_delay, "s", Range{0.0, 1.0});
  visit("period", self.period, "s", Range{0.0001, 1.0});
  visit("substep", self.substep, "s", Range{0.00001, 0.1});
  visit("seed", self.seed, "-", Range{0.0, 2147483647.0});
}

/// Throws Error, naming the field and its rule, when an option is out of range or options do not fit
/// together.
void checkPlantOptions(const PlantOptions& options);

/// What the integration carries. Euler angles in the order yaw, pitch, roll (R(psi, theta, phi) of Eq. 37).
struct PlantState {
  /// Position in W [m].
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  /// Velocity in W [m/s].
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  double roll = 0.0;   ///< [rad]
  double pitch = 0.0;  ///< [rad]
  /// Yaw angle, not wrapped [rad].
  double yaw = 0.0;
  /// Yaw rate psi' [rad/s].
  double yaw_rate = 0.0;
  /// Thrust T per mass [m/s^2].
  double thrust = 0.0;
  /// The slung load from the vehicle in W [m]; zero at the start: it hangs at rest, and moves with the
  /// vehicle.
  Eigen::Vector3d load_offset = Eigen::Vector3d::Zero();
  /// Velocity of the load in W, not relative to the vehicle [m/s].
  Eigen::Vector3d load_velocity = Eigen::Vector3d::Zero();
};

/// Third column of R(psi, theta, phi): the body's z axis in W.
Eigen::Vector3d bodyZ(double roll, double pitch, double yaw);

/// A multirotor in simulated time. The same options give the same flight, bit for bit.
class MultirotorPlant {
 public:
  /// Starts at `start`; its thrust and yaw rate are the command that acts until the first one arrives. Throws
  /// Error.
  MultirotorPlant(const PlantOptions& options, const PlantState& start);

  /// Integrates one period with the command, held over the period after `command_delay`. A command that is
  /// not finite is ignored: the one before stays.
  void advance(const AttitudeCommand& command);

  /// Odometry now: noisy and as old as `odometry_delay`; the stamp is the time that the state was true. Draws
  /// random numbers, so call it once per period.
  VehicleState measure();

  /// Simulated time since the start [s].
  double time() const;
  const PlantState& state() const { return state_; }
  /// State now, without noise or delay.
  VehicleState truth() const;
  /// d(t) that acts now: wind, gusts, kick, the air's velocity times the drag, the string's pull [m/s^2].
  Eigen::Vector3d disturbance() const;
  /// Number of commands that were cut to the vehicle's limits.
  std::int64_t saturatedCommands() const { return saturated_; }
  /// Number of commands that were not finite.
  std::int64_t ignoredCommands() const { return ignored_; }

 private:
  struct Pending {
    std::int64_t step;  // substep at which it takes effect
    AttitudeCommand command;
  };

  AttitudeCommand saturate(const AttitudeCommand& command);
  void hangLoad();
  void substep();
  void drawGust();
  bool during(double start, double duration) const;
  bool isTumbling() const;
  // Part of d(t) that does not depend on the state [m/s^2].
  Eigen::Vector3d push() const;
  // Velocity of the air [m/s].
  Eigen::Vector3d airVelocity() const;
  // Force on the load [N].
  Eigen::Vector3d hit() const;

  PlantOptions options_;
  std::optional<DrydenTurbulence> turbulence_;
  Eigen::Vector3d gust_ = Eigen::Vector3d::Zero();
  GaussianSource gust_noise_;
  GaussianSource sensor_noise_;
  PlantState state_;
  AttitudeCommand acting_;
  std::deque<Pending> pending_;
  std::deque<VehicleState> history_;  // front: what odometry tells now
  std::int64_t step_ = 0;             // substeps since the start
  std::int64_t steps_per_period_ = 0;
  std::int64_t command_delay_steps_ = 0;
  std::int64_t odometry_delay_steps_ = 0;
  std::int64_t saturated_ = 0;
  std::int64_t ignored_ = 0;
};

}  // namespace polyfly
