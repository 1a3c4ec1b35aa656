#include "online_controller_ros/topic_rehearsal.hpp"

#include <boost/make_shared.hpp>
#include <utility>

#include "online_controller_ros/conversions.hpp"

namespace polyfly_ros {
namespace {

template <class Message>
ros::Subscriber subscribe(ros::NodeHandle& handle, const std::string& topic, DirectQueue& queue,
                          const boost::function<void(const boost::shared_ptr<const Message>&)>& callback) {
  ros::SubscribeOptions options;
  options.init<Message>(topic, 1, callback);
  options.callback_queue = &queue;
  return handle.subscribe(options);
}

}  // namespace

TopicRehearsal::TopicRehearsal(const ros::NodeHandle& private_handle, Within within)
    : within_(std::move(within)), handle_(private_handle, "rehearsal") {
  odometry_baton_.give();
  command_baton_.give();
  odometry_publisher_ = handle_.advertise<nav_msgs::Odometry>("odometry", 1);
  command_publisher_ = handle_.advertise<mav_msgs::RollPitchYawrateThrust>("command", 1);
  odometry_subscriber_ = subscribe<nav_msgs::Odometry>(handle_, "odometry", odometry_queue_,
                                                       [this](const nav_msgs::Odometry::ConstPtr& message) {
                                                         if (speaker_ == std::this_thread::get_id())
                                                           within_(*message);
                                                       });
  command_subscriber_ = subscribe<mav_msgs::RollPitchYawrateThrust>(
      handle_, "command", command_queue_, [](const mav_msgs::RollPitchYawrateThrust::ConstPtr&) {});
}

void TopicRehearsal::publish(const ros::Time& stamp, const std::string& frame) {
  const auto message = boost::make_shared<nav_msgs::Odometry>();
  message->header.stamp = stamp;
  message->header.frame_id = frame;
  message->pose.pose.orientation.w = 1.0;
  speaker_ = std::this_thread::get_id();
  odometry_publisher_.publish(message);
  speaker_ = std::thread::id();
}

void TopicRehearsal::answer(const polyfly::AttitudeCommand& command, const std_msgs::Header& header) {
  const auto message = boost::make_shared<mav_msgs::RollPitchYawrateThrust>();
  message->header = header;
  fillCommand(command, *message);
  command_publisher_.publish(message);
}

}  // namespace polyfly_ros
