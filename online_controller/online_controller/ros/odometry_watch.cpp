#include "online_controller_ros/odometry_watch.hpp"

#include <ros/console.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "polyfly_ros/stamps.hpp"

namespace polyfly_ros {
namespace {

constexpr double kLongGap = 100.0;  // so many control periods without odometry are no loss of samples
constexpr double kSimulatedInterval = 1e-3;  // simulated time may run fast: between two looks at it [s]

double wallTime() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

OdometryWatch::OdometryWatch(double control_period, double silence)
    : control_period_(control_period),
      silence_(silence),
      time_(ros::Time::isSimTime()),
      clock_(control_period, kSimulatedInterval) {}

double OdometryWatch::interval() const {
  return ros::Time::isSimTime() ? std::min(kSimulatedInterval, control_period_) : control_period_;
}

int OdometryWatch::onOdometry(const std_msgs::Header& header) {
  const double stamp = header.stamp.toSec();
  time_.onOdometry(ros::Time::now().toSec(), wallTime(), stamp);
  has_odometry_ = true;
  frame_ = header.frame_id;
  age_ = time_.arrival() - stamp;
  const double periods = stamp_.isZero() ? 0.0 : secondsBetween(stamp_, header.stamp) / control_period_;
  stamp_ = header.stamp;
  // Half a period late is jitter; a long gap is silence, or another flight.
  return periods > 1.5 && periods < kLongGap ? static_cast<int>(std::lround(periods)) - 1 : 0;
}

bool OdometryWatch::isDue() {
  const double wall = wallTime();
  time_.advance(ros::Time::now().toSec(), wall);
  if (!ros::Time::isSimTime()) return true;  // it is asked once in each control period
  tellOfClock();
  const double decisive = time_.byWall() ? wall : now();
  if (!clock_.due(decisive)) return false;
  clock_.decided(decisive);
  return true;
}

double OdometryWatch::now() const { return ros::Time::now().toSec() + time_.ahead(); }

ros::Time OdometryWatch::stampInSilence() const {
  return time_.byWall() ? stampOf(time_.arrival() + time_.silence()) : ros::Time::now();
}

void OdometryWatch::tellOfClock() {
  if (time_.byWall() == told_of_wall_time_) return;
  told_of_wall_time_ = time_.byWall();
  if (told_of_wall_time_) {
    ROS_WARN(
        "MPC: odometry comes, but simulated time stands still: wall time decides when odometry is silent. "
        "Does anybody publish /clock, as /use_sim_time asks for?");
  } else {
    ROS_WARN("MPC: simulated time runs again, and decides when odometry is silent");
  }
}

}  // namespace polyfly_ros
