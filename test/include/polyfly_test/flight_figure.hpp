#pragma once

#include <Eigen/Core>
#include <vector>

#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// The flight that the demonstration tracks: hold, climb, a horizontal figure of eight flown fast, hold. With the
/// phase s,
///   x = radius_x sin s,  y = radius_y sin 2s,  z = height + radius_z sin s,  yaw = yaw_turn s / (2 pi laps).
/// The phase starts and ends smoothly, so that the jerk is continuous all along.
struct FigureOptions {
  /// First hold position in W [m]. The eight is flown around (x, y).
  Eigen::Vector3d start{0.0, 0.0, 1.0};
  /// Height of the eight's centre [m].
  double height = 1.5;
  double start_yaw = 0.0;  ///< [rad]
  /// Hold time before the climb [s].
  double settle_time = 2.0;
  /// Time of the climb from start to height [s].
  double climb_time = 3.0;
  double radius_x = 4.0;  ///< [m]
  double radius_y = 1.0;  ///< [m]
  double radius_z = 0.3;  ///< [m]
  /// Rate s' at full speed [rad/s].
  double rate = 0.53;
  /// Time until full speed, and back to rest [s].
  double blend_time = 6.0;
  /// Number of whole turns of the phase.
  int laps = 2;
  double yaw_turn = 4.712389;  ///< [rad]
  /// Hold time at the end [s].
  double hold_time = 10.0;
  /// Time between points of the trajectory [s].
  double sample_period = 0.05;
};

/// Lists the fields of FigureOptions once: visit(key, field, unit, range).
template <class Options, class Visitor>
void visitFigureOptions(Options& self, Visitor&& visit) {
  visit("start", self.start, "m", Range{-1000.0, 1000.0});
  visit("height", self.height, "m", Range{-1000.0, 1000.0});
  visit("start_yaw", self.start_yaw, "rad", Range{-3.1415927, 3.1415927});
  visit("settle_time", self.settle_time, "s", Range{0.0, 1000.0});
  visit("climb_time", self.climb_time, "s", Range{0.1, 1000.0});
  visit("radius_x", self.radius_x, "m", Range{0.0, 1000.0});
  visit("radius_y", self.radius_y, "m", Range{0.0, 1000.0});
  visit("radius_z", self.radius_z, "m", Range{0.0, 1000.0});
  visit("rate", self.rate, "rad/s", Range{0.001, 100.0});
  visit("blend_time", self.blend_time, "s", Range{0.1, 1000.0});
  visit("laps", self.laps, "-", Range{1.0, 1000.0});
  visit("yaw_turn", self.yaw_turn, "rad", Range{-1000.0, 1000.0});
  visit("hold_time", self.hold_time, "s", Range{0.0, 1000.0});
  visit("sample_period", self.sample_period, "s", Range{0.001, 1.0});
}

/// The reference of the flight as a function of time.
class FlightFigure {
 public:
  /// Throws Error when an option is out of range, or when the laps are too few for the blends.
  explicit FlightFigure(const FigureOptions& options);

  double duration() const { return duration_; }  ///< [s]
  /// Time from which on the last point is held [s].
  double holdStart() const { return hold_start_; }

  /// At `time` seconds after the start; held at the ends outside [0, duration].
  Reference at(double time) const;

  /// Points every sample_period from 0 to duration; a point's time is its index times sample_period.
  std::vector<Reference> sample() const;

 private:
  FigureOptions options_;
  double figure_start_ = 0.0;
  double cruise_time_ = 0.0;  // at full rate
  double hold_start_ = 0.0;
  double duration_ = 0.0;
};

}  // namespace polyfly
