// Publishes a mission from a file, latched, until it is ended. The guidance takes it when it starts, and
// begins it anew when this program is started again.
#include <fixedwing_lateral/Mission.h>
#include <ros/ros.h>

#include <exception>

#include "fixedwing_lateral/mission_file.hpp"
#include "fixedwing_lateral_ros/conversions.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_ros/parameter_reader.hpp"

namespace {

polyfly::Mission readMission() {
  polyfly_ros::ParameterReader reader(ros::NodeHandle("~"));
  const std::string path = reader.requiredText("file", "the mission, a YAML file");
  polyfly::LoiterOptions loiter;
  reader("loiter_radius", loiter.radius, "m", polyfly::Range{1.0, 1e5});
  return polyfly::loadMission(path, loiter);
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "publish_mission");
  ros::NodeHandle handle;  // outlives what is said in the end
  try {
    const polyfly::Mission mission = readMission();
    ros::Publisher publisher = handle.advertise<fixedwing_lateral::Mission>("mission", 1, true);
    publisher.publish(polyfly_ros::toMessage(mission));
    ROS_INFO("a mission of %zu segments", mission.segments.size());
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("no mission: %s", error.what());
    return 1;
  }
  return 0;
}
