// A simulated aircraft on mavros' topics (the rough one, or with ~rigid the one in six degrees of freedom),
// in steps: each command, of roll or of attitude, moves it on by one period, so that a slow machine flies the
// same as a fast one.
// ~pace 1 waits for the clock on the wall, to be watched in rviz.
#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <mavros_msgs/AttitudeTarget.h>
#include <mavros_msgs/VFR_HUD.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/Imu.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>

#include "fixedwing_lateral_ros/conversions.hpp"
#include "fixedwing_plant/six_dof_aircraft.hpp"

namespace {

constexpr double kPeriod = 0.05;  // [s]

class PlantNode {
 public:
  PlantNode(ros::NodeHandle& handle, bool rigid, double pace) : aircraft_(makeAircraft(rigid)), pace_(pace) {
    odometry_ = handle.advertise<nav_msgs::Odometry>("mavros/local_position/odom", 10);
    imu_ = handle.advertise<sensor_msgs::Imu>("mavros/imu/data", 10);
    hud_ = handle.advertise<mavros_msgs::VFR_HUD>("mavros/vfr_hud", 10);
    wind_ = handle.advertise<geometry_msgs::TwistWithCovarianceStamped>("mavros/wind_estimation", 10);
    clock_ = handle.advertise<rosgraph_msgs::Clock>("/clock", 10);
    command_ = handle.subscribe("mavros/setpoint_attitude/cmd_vel", 10, &PlantNode::onCommand, this);
    attitude_ = handle.subscribe("mavros/setpoint_raw/attitude", 10, &PlantNode::onAttitude, this);
    patience_ =
        handle.createWallTimer(ros::WallDuration(0.2), [this](const ros::WallTimerEvent&) { onSilence(); });
  }

 private:
  static std::unique_ptr<polyfly::Aircraft> makeAircraft(bool rigid) {
    if (rigid) {
      polyfly::SixDofOptions options;
      options.wind = {2.0, -3.0};
      options.turbulence = options.wind.norm();
      return std::make_unique<polyfly::SixDofAircraft>(options, start(), 1);
    }
    polyfly::RoughOptions options;
    options.wind = {2.0, -3.0};
    return std::make_unique<polyfly::PerturbedAircraft>(options, start(), 1);
  }
  static polyfly::AircraftState start() {
    polyfly::AircraftState state;
    state.stamp = 1.0;
    state.position = {-50.0, 10.0};
    state.ground_velocity = {14.0, 0.0};
    return state;
  }

  void onCommand(const geometry_msgs::TwistStamped& command) {
    answer(command.header.stamp, command.twist.angular.x);
  }

  // Height and airspeed are the plant's own: of an attitude it takes the roll.
  void onAttitude(const mavros_msgs::AttitudeTarget& target) {
    const auto& q = target.orientation;
    answer(target.header.stamp,
           std::atan2(2.0 * (q.w * q.x + q.y * q.z), 1.0 - 2.0 * (q.x * q.x + q.y * q.y)));
  }

  void answer(const ros::Time& stamp, double roll) {
    // A command for an earlier state does not count.
    if (stamp != sent_) return;
    aircraft_->fly(roll, kPeriod);
    answered_ = true;
    if (pace_ > 0.0) ros::WallDuration(kPeriod / pace_).sleep();
    publish();
  }

  // Nobody answered: the same state again, a moment later, until somebody listens.
  void onSilence() {
    if (!answered_) {
      aircraft_->fly(0.0, kPeriod);
      publish();
    }
    answered_ = false;
  }

  void publish() {
    const polyfly::AircraftState state = aircraft_->state();
    sent_ = ros::Time(state.stamp);
    rosgraph_msgs::Clock clock;
    clock.clock = sent_;
    clock_.publish(clock);
    geometry_msgs::TwistWithCovarianceStamped wind;
    wind.header.stamp = sent_;
    wind.twist.twist.linear.x = aircraft_->wind().y();
    wind.twist.twist.linear.y = aircraft_->wind().x();
    wind_.publish(wind);
    mavros_msgs::VFR_HUD hud;
    hud.header.stamp = sent_;
    hud.airspeed = static_cast<float>(aircraft_->airspeed());
    hud_.publish(hud);
    sensor_msgs::Imu imu;
    imu.header.stamp = sent_;
    imu.angular_velocity.x = state.roll_rate;
    imu_.publish(imu);
    odometry_.publish(odometryOf(state));
  }

  nav_msgs::Odometry odometryOf(const polyfly::AircraftState& state) const {
    nav_msgs::Odometry odometry;
    odometry.header.stamp = sent_;
    odometry.header.frame_id = "map";
    odometry.child_frame_id = "base_link";
    odometry.pose.pose.position.x = state.position.y();
    odometry.pose.pose.position.y = state.position.x();
    odometry.pose.pose.position.z = aircraft_->altitude();
    // Only its quaternion is used.
    mavros_msgs::AttitudeTarget attitude;
    polyfly_ros::fillAttitude(state.roll, state.heading, {}, attitude);
    odometry.pose.pose.orientation = attitude.orientation;
    const auto& q = attitude.orientation;
    const Eigen::Vector3d body = Eigen::Quaterniond(q.w, q.x, q.y, q.z).inverse() *
                                 Eigen::Vector3d(state.ground_velocity.y(), state.ground_velocity.x(), 0.0);
    odometry.twist.twist.linear.x = body.x();
    odometry.twist.twist.linear.y = body.y();
    odometry.twist.twist.linear.z = body.z();
    return odometry;
  }

  std::unique_ptr<polyfly::Aircraft> aircraft_;
  ros::Publisher odometry_, imu_, hud_, wind_, clock_;
  ros::Subscriber command_, attitude_;
  ros::WallTimer patience_;
  ros::Time sent_;
  bool answered_ = true;
  // Simulated time per wall time; 0: as fast as commands come.
  double pace_ = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "lateral_plant");
  ros::NodeHandle handle;
  const ros::NodeHandle own("~");
  const PlantNode plant(handle, own.param("rigid", false), own.param("pace", 0.0));
  ros::spin();
}
