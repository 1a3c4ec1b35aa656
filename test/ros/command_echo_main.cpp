// What a node of roscpp takes at the least: answers each odometry at once by a command that means nothing,
// from a callback like any other. For comparison with controllers that have something to compute.
#include <mav_msgs/RollPitchYawrateThrust.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "command_echo");
  ros::NodeHandle handle;
  const ros::Publisher commands =
      handle.advertise<mav_msgs::RollPitchYawrateThrust>("command/roll_pitch_yawrate_thrust", 1);
  const ros::Subscriber odometry = handle.subscribe<nav_msgs::Odometry>(
      "odometry", 1,
      [&](const nav_msgs::Odometry::ConstPtr& message) {
        mav_msgs::RollPitchYawrateThrust command;
        command.header = message->header;
        commands.publish(command);
      },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  ros::spin();
}
