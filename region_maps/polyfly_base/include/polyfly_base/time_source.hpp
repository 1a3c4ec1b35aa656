#pragma once

#include <limits>

namespace polyfly {

/// How long odometry has been silent, by the clock that can be trusted. ROS time decides, unless it is
/// simulated and its clock is dead: then wall time does. The clock is dead where odometry has come for
/// kStandstill of wall time since ROS time last moved, and one of these holds:
/// - no clock ever came;
/// - the odometry's stamps advanced by kStandstill meanwhile. A step of more than kGreatestStep is no advance.
///
/// A clock that stands still otherwise is a paused simulation: no time passes. A simulated clock is late where the
/// odometry's stamps lead it by more than they ever did: catching up is no silence.
///
/// Reads no clock; ROS time and a steady wall time are arguments [s].
class TimeSource {
 public:
  /// Long against a slow /clock, short against what a vehicle can do meanwhile [s].
  static constexpr double kStandstill = 0.25;
  /// Longest time between two odometry messages that follow each other [s].
  static constexpr double kGreatestStep = 1.0;

  /// Without `simulated`, ROS time always decides.
  explicit TimeSource(bool simulated) noexcept : simulated_(simulated) {}

  /// To be called in each control period.
  void advance(double ros, double wall) noexcept;

  /// Odometry with this stamp [s] arrived.
  void onOdometry(double ros, double wall, double stamp) noexcept;

  /// Whether wall time decides.
  bool byWall() const noexcept { return by_wall_; }
  /// Time since the last odometry [s].
  double silence() const noexcept { return silence_; }
  /// When the last odometry arrived, by ROS time; by its stamp where simulated time stands still or has not come yet [s].
  double arrival() const noexcept { return arrival_; }
  /// Lead of the time that decides over ROS time [s].
  double ahead() const noexcept { return ahead_; }

 private:
  static constexpr double kNoLead = std::numeric_limits<double>::infinity();

  bool simulated_;
  // ROS time when it last moved. 0: no clock came yet.
  double ros_ = 0.0;
  // ROS time from which silence counts.
  double since_ = 0.0;
  // Of the stamps over ROS time, since one of both jumped.
  double least_lead_ = kNoLead;
  // Whether odometry came since ROS time last moved. Only then the next two members are valid.
  bool heard_ = false;
  // Wall time of the first odometry since ROS time last moved.
  double first_wall_ = 0.0;
  // Sum of the steps of the stamps since ROS time last moved.
  double advance_ = 0.0;
  // Stamp of the last odometry.
  double last_stamp_ = 0.0;
  // Wall time of the last odometry.
  double last_wall_ = 0.0;
  double arrival_ = 0.0;
  double silence_ = 0.0;
  double ahead_ = 0.0;
  bool by_wall_ = false;
};

}  // namespace polyfly
