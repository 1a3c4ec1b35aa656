#pragma once

#include <ros/ros.h>
#include <rosbag/bag.h>
#include <topic_tools/shape_shifter.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace polyfly_ros {

/// Records topics to a bag without loss. `rosbag record` keeps at most 100 unread messages per topic. A flight in
/// lockstep, many times faster than real time, can exceed that. The queues here are unbounded. The flight waits for
/// `recorder/ready` and the end of the flight for `recorder/closed`. Topics and parameters: test/README.md.
class FlightRecorder {
 public:
  /// Opens the bag as `FILE.active`, which becomes FILE at the end of a whole flight. Throws polyfly::Error
  /// when that fails or a parameter breaks its rule.
  FlightRecorder(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);
  ~FlightRecorder();
  FlightRecorder(const FlightRecorder&) = delete;
  FlightRecorder& operator=(const FlightRecorder&) = delete;

 private:
  using Event = ros::MessageEvent<topic_tools::ShapeShifter const>;

  void subscribe(const std::string& topic);
  void record(const std::string& topic, const Event& event);
  void writeEarly(const ros::Time& time);
  void write(const std::string& topic, const Event& event, const ros::Time& time);
  void announceWhenConnected();
  void close(bool complete);

  ros::NodeHandle nh_;
  std::string path_;
  std::unique_ptr<rosbag::Bag> bag_ = std::make_unique<rosbag::Bag>();
  bool open_ = false;
  std::vector<std::pair<std::string, Event>> early_;  // arrived before simulated time began
  std::vector<ros::Subscriber> subscribers_;
  ros::Subscriber done_sub_;
  ros::Publisher ready_pub_;
  ros::Publisher closed_pub_;
  ros::WallTimer ready_timer_;
  ros::WallTimer close_timer_;
};

}  // namespace polyfly_ros
