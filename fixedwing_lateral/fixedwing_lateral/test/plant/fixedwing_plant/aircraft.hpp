#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>

#include "fixedwing_lateral/guidance.hpp"
#include "fixedwing_plant/dryden.hpp"

namespace polyfly {

/// What flies: takes a roll reference, tells its state. Simulated time only.
class Aircraft {
 public:
  virtual ~Aircraft() = default;
  virtual void fly(double roll_reference, double duration) = 0;  ///< [rad], [s]
  /// True state with its time stamp.
  virtual AircraftState state() const = 0;
  virtual double airspeed() const = 0;  ///< [m/s]
  /// Velocity of the air around the aircraft [m/s].
  virtual Eigen::Vector2d wind() const = 0;
  virtual double altitude() const { return 0.0; }  ///< [m]
};

/// The model that the controller predicts with (Eq. 45), integrated with a step of its own.
class ChapterAircraft : public Aircraft {
 public:
  ChapterAircraft(const LateralModel& model, const AircraftState& start, double airspeed,
                  const Eigen::Vector2d& wind);

  void fly(double roll_reference, double duration) override;
  AircraftState state() const override;
  double airspeed() const override { return airspeed_; }
  Eigen::Vector2d wind() const override { return wind_; }
  void setWind(const Eigen::Vector2d& wind) { wind_ = wind; }
  void setAirspeed(double airspeed) { airspeed_ = airspeed; }

 private:
  LateralModel model_;
  double time_ = 0.0;
  double airspeed_ = 0.0;
  Eigen::Vector2d wind_;
  double north_ = 0.0, east_ = 0.0, roll_ = 0.0, heading_ = 0.0, rate_ = 0.0;
};

/// What the controller does not know. The roll loop has other constants, delay, rate limit and trim error. A turn
/// follows roll with a lag and not quite in coordination. A banked wing disturbs the loops of airspeed and altitude.
/// There are gusts.
struct RoughOptions {
  /// Natural frequency of the roll loop [rad/s].
  double roll_frequency = 5.0;
  /// Damping ratio of the roll loop [-].
  double roll_damping = 0.75;
  double roll_gain = 0.96;  ///< [-]
  /// Offset added to every roll reference [rad].
  double roll_trim = 0.015;
  /// Delay from the command to the roll loop [s].
  double roll_delay = 0.10;
  double roll_rate_max = 1.5;  ///< [rad/s]
  /// Time constant with which the turn rate follows the roll [s].
  double turn_lag = 0.25;
  /// Turn rate relative to a coordinated turn [-].
  double turn_gain = 0.95;
  /// Airspeed that the airspeed loop holds [m/s].
  double airspeed = 14.0;
  /// Time constant of the airspeed loop [s].
  double airspeed_lag = 2.0;
  /// Deceleration per load factor above 1 [m/s^2].
  double load_drag = 6.0;
  /// Altitude that the altitude loop holds [m].
  double altitude = 80.0;
  /// Time constant of the climb angle [s].
  double altitude_lag = 1.5;
  /// Mean wind [m/s].
  Eigen::Vector2d wind{0.0, 0.0};
  /// Standard deviation of each gust component [m/s].
  double gust = 0.0;
  /// Length scale of the gusts, Dryden model [m].
  double gust_scale = 150.0;
  /// Roll acceleration per cross gust [rad/s^2 per m/s].
  double gust_roll = 0.15;
};

/// A light single-engined aircraft at 52 m/s whose roll loop is slow and rolls by at most 9 deg/s.
RoughOptions slowRolling();

class PerturbedAircraft : public Aircraft {
 public:
  PerturbedAircraft(const RoughOptions& options, const AircraftState& start, std::uint32_t seed);

  void fly(double roll_reference, double duration) override;
  AircraftState state() const override;
  double airspeed() const override { return airspeed_; }
  Eigen::Vector2d wind() const override;
  double altitude() const override { return altitude_; }

 private:
  void step(double roll_reference, double step);

  RoughOptions options_;
  DrydenGusts gusts_;
  std::deque<double> delayed_;
  double time_ = 0.0;
  Eigen::Vector2d position_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_ = Eigen::Vector2d::Zero();
  double roll_ = 0.0, rate_ = 0.0, heading_ = 0.0, turn_ = 0.0;
  double airspeed_ = 14.0, altitude_ = 80.0, climb_ = 0.0;
};

}  // namespace polyfly
