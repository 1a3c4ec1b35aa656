#pragma once

#include <ros/time.h>
#include <std_msgs/Header.h>

#include <string>

#include "online_controller/realtime/sampling_clock.hpp"
#include "polyfly_base/time_source.hpp"

namespace polyfly_ros {

/// When odometry came last, and since when it is silent. Reads ROS time and wall time. A ros::Timer would not
/// do: it never fires where simulated time is used and its clock is dead.
class OdometryWatch {
 public:
  /// Both in [s]. Odometry that is missing for longer than `silence` counts as silent.
  OdometryWatch(double control_period, double silence);

  /// How often isDue() is to be asked [s].
  double interval() const;

  /// Odometry with this header came. Returns how many were lost since the one before.
  int onOdometry(const std_msgs::Header& header);

  /// Whether a control period has passed since the last time that this was so.
  bool isDue();

  const polyfly::TimeSource& time() const noexcept { return time_; }
  /// Time by the clock that decides about silence [s].
  double now() const;
  bool hasOdometry() const noexcept { return has_odometry_; }
  bool isSilent() const noexcept { return has_odometry_ && time_.silence() > silence_; }

  // Of the last odometry:
  const std::string& frame() const noexcept { return frame_; }
  /// Age at its arrival; in silence, the time of silence so far [s].
  double age() const noexcept { return isSilent() ? time_.silence() : age_; }
  /// The stamp that goes on in silence from that of the last odometry.
  ros::Time stampInSilence() const;

 private:
  void tellOfClock();

  double control_period_;  // [s]
  double silence_;         // [s]
  polyfly::TimeSource time_;
  // Clock of isDue().
  polyfly::SamplingClock clock_;
  bool has_odometry_ = false;
  bool told_of_wall_time_ = false;
  std::string frame_;
  ros::Time stamp_;
  double age_ = 0.0;
};

}  // namespace polyfly_ros
