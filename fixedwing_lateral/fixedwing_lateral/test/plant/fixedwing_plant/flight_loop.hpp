#pragma once

#include <functional>
#include <random>
#include <vector>

#include "fixedwing_lateral/guidance.hpp"
#include "fixedwing_plant/aircraft.hpp"

namespace polyfly {

/// What the sensors add to the truth. Chances are per second.
struct SensorOptions {
  double position_noise = 0.0;  ///< [m]
  /// Noise of roll and heading [rad].
  double angle_noise = 0.0;
  double rate_noise = 0.0;      ///< [rad/s]
  double airspeed_noise = 0.0;  ///< [m/s]
  /// Time constant of the wind estimate; 0: none [s].
  double wind_lag = 0.0;
  double wind_noise = 0.0;  ///< [m/s]
  /// Chance that the state stops for up to `loss_time`.
  double state_loss = 0.0;
  /// Chance that wind and airspeed stop.
  double wind_loss = 0.0;
  /// Chance of a sample that is not a number.
  double nan_chance = 0.0;
  /// Chance of a position that is off by 100 m for up to 0.3 s.
  double jump_chance = 0.0;
  double loss_time = 3.0;  ///< [s]
};

/// One control period of a flight.
struct FlightSample {
  double time = 0.0;
  AircraftState truth;
  double airspeed = 0.0;
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();
  double roll_reference = 0.0;
  /// Output of the controller; other laws set only mode, segment and error.
  GuidanceOutput output;
};

/// Measures an aircraft with faults.
class Sensors {
 public:
  Sensors(const SensorOptions& options, std::uint32_t seed) : options_(options), random_(seed) {}
  GuidanceInput measure(const Aircraft& aircraft, double period);

 private:
  double noise(double deviation) { return deviation * normal_(random_); }
  bool strikes(double chance, double period) { return uniform_(random_) < chance * period; }

  SensorOptions options_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  GuidanceInput last_;
  Eigen::Vector2d wind_ = Eigen::Vector2d::Zero();
  bool has_wind_ = false;
  double state_back_ = -1.0, air_back_ = -1.0, jump_back_ = -1.0;
};

/// Any law from measurements to a roll reference.
using LateralLaw = std::function<GuidanceOutput(const GuidanceInput&)>;

/// The guidance as a law: update, then prepare.
LateralLaw lawOf(LateralGuidance& guidance);

/// Flies until the time is over or `until` says so.
std::vector<FlightSample> flyLaw(Aircraft& aircraft, Sensors& sensors, const LateralLaw& law, double period,
                                 double duration,
                                 const std::function<bool(const FlightSample&)>& until = nullptr);

}  // namespace polyfly
