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
  virtual AircraftState state() const = 0;                       ///< the truth, stamped
  virtual double airspeed() const = 0;                           ///< [m/s]
  virtual Eigen::Vector2d wind() const = 0;                      ///< of the air around it [m/s]
  virtual double altitude() const { return 0.0; }                ///< [m]
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

/// What the controller does not know: a roll loop of other constants with delay, rate limit and trim error; a
/// turn that follows roll with a lag and not quite in coordination; airspeed and altitude loops that a banked
/// wing disturbs; gusts.
struct RoughOptions {
  double roll_frequency = 5.0;     ///< of the roll loop [rad/s]
  double roll_damping = 0.75;      ///< of the roll loop [-]
  double roll_gain = 0.96;         ///< [-]
  double roll_trim = 0.015;        ///< added to every reference [rad]
  double roll_delay = 0.10;        ///< from command to loop [s]
  double roll_rate_max = 1.5;      ///< [rad/s]
  double turn_lag = 0.25;          ///< of the turn rate behind roll [s]
  double turn_gain = 0.95;         ///< of the turn rate against a coordinated turn [-]
  double airspeed = 14.0;          ///< that the airspeed loop holds [m/s]
  double airspeed_lag = 2.0;       ///< of the airspeed loop [s]
  double load_drag = 6.0;          ///< loss of airspeed by load factor above 1 [m/s^2]
  double altitude = 80.0;          ///< that the altitude loop holds [m]
  double altitude_lag = 1.5;       ///< of the climb angle [s]
  Eigen::Vector2d wind{0.0, 0.0};  ///< mean [m/s]
  double gust = 0.0;               ///< standard deviation of each component [m/s]
  double gust_scale = 150.0;       ///< length, Dryden model [m]
  double gust_roll = 0.15;         ///< roll acceleration by cross gust [rad/s^2 per m/s]
};

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
