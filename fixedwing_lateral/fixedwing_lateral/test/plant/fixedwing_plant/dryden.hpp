#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

namespace polyfly {

/// Continuous gusts by the Dryden model (MIL-F-8785C), in the axes of the airspeed: along it, across it to
/// the right, across it downwards.
struct DrydenOptions {
  /// Standard deviation of the gusts [m/s].
  Eigen::Vector3d deviation = Eigen::Vector3d::Zero();
  /// Length scale L [m], > 0.
  Eigen::Vector3d scale = Eigen::Vector3d::Constant(150.0);
  /// Standard deviation of the roll rate that gusts along the span cause [rad/s].
  double roll_deviation = 0.0;
  /// Wing span b, which sets the roll gusts' length 4 b / pi [m], > 0.
  double span = 2.6;
};

/// The specification's deviations and lengths below 300 m, from the mean wind at 6 m above ground [m/s].
DrydenOptions lowAltitudeDryden(double altitude, double wind_at_6m, double span);

/// Draws gusts. The steps are exact, whatever their length, and the first gust is one of the steady process.
///
/// With w = V / L: sigma sqrt(2 w) / (s + w) along, sigma sqrt(w) (w + sqrt(3) s) / (s + w)^2 across, driven by white
/// noise of unit intensity. The roll gusts are as those along, with w = pi V / (4 b).
class DrydenGusts {
 public:
  DrydenGusts(const DrydenOptions& options, std::uint32_t seed);

  /// `airspeed` [m/s] must be positive; it may change from step to step.
  void step(double airspeed, double duration);

  /// Gust velocity of the air [m/s].
  const Eigen::Vector3d& velocity() const { return velocity_; }
  /// Roll rate of the air [rad/s].
  double rollRate() const { return roll_rate_; }

 private:
  double draw() { return normal_(random_); }
  void compose();

  DrydenOptions options_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  // Processes of unit variance: the first lag of each axis, the second of those across, the roll.
  Eigen::Vector3d first_;
  Eigen::Vector3d second_;
  double roll_ = 0.0;
  Eigen::Vector3d velocity_;
  double roll_rate_ = 0.0;
};

}  // namespace polyfly
