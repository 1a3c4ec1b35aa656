// The node in the process of the one who publishes odometry: the control thread answers, by pointer, in order.
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <mav_msgs/RollPitchYawrateThrust.h>
#include <nav_msgs/Odometry.h>
#include <online_controller/ControllerStatus.h>
#include <ros/ros.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "online_controller_ros/controller_node.hpp"

namespace polyfly_ros {
namespace {

// Commands and odometry that arrived as bytes.
std::atomic<long> deserialised{0};

}  // namespace
}  // namespace polyfly_ros

namespace ros {
namespace serialization {

// What roscpp calls before it reads a message from bytes.
template <>
struct PreDeserialize<mav_msgs::RollPitchYawrateThrust> {
  static void notify(const PreDeserializeParams<mav_msgs::RollPitchYawrateThrust>&) {
    ++polyfly_ros::deserialised;
  }
};

}  // namespace serialization
}  // namespace ros

namespace polyfly_ros {
namespace {

constexpr double kPatience = 20.0;  // until something must have happened [s]

nav_msgs::Odometry::Ptr odometryAt(const ros::Time& stamp) {
  auto odometry = boost::make_shared<nav_msgs::Odometry>();
  odometry->header.frame_id = "world";
  odometry->header.stamp = stamp;
  odometry->pose.pose.orientation.w = 1.0;
  return odometry;
}

/// Whether it became so in time.
template <class Done>
bool await(Done done) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kPatience);
  while (!done()) {
    if (ros::WallTime::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

/// The node, one who publishes odometry, and one who takes commands and statuses.
class Flight {
 public:
  explicit Flight(const std::string& space) : handle_(space), private_handle_(space + "/controller") {
    private_handle_.setParam("law", "linear");
    private_handle_.setParam("controller/stale_periods", 10000);
    const ros::NodeHandle own = onQueue(handle_, queue_);
    commands_ =
        ros::NodeHandle(own).subscribe("command/roll_pitch_yawrate_thrust", 0, &Flight::onCommand, this);
    statuses_ = ros::NodeHandle(own).subscribe("controller_status", 0, &Flight::onStatus, this);
    odometry = handle_.advertise<nav_msgs::Odometry>("odometry", 1);
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = "world";
    pose.pose.orientation.w = 1.0;
    reference_ = handle_.advertise<geometry_msgs::PoseStamped>("command/pose", 1, true);
    reference_.publish(pose);
    node = std::make_unique<ControllerNode>(handle_, private_handle_);
    thread_.start();
    // Nothing is sent before a reference.
    await([this, i = 0]() mutable {
      odometry.publish(odometryAt(ros::Time(99.3 + 1e-4 * i++)));
      ros::WallDuration(0.005).sleep();
      return count > 0;
    });
  }

  /// Publishes, and waits for the command.
  bool exchange(const ros::Time& stamp) {
    const std::size_t before = count;
    odometry.publish(odometryAt(stamp));
    return await([&] { return count > before; });
  }

  /// Waits for the status of the odometry with this stamp, and takes no more messages.
  bool awaitStatus(const ros::Time& stamp) {
    const bool came = await([&] { return last_status_ == stamp.toNSec(); });
    thread_.stop();
    return came;
  }

  // To be read when no more messages are taken.
  std::vector<ros::Time> stamps;
  std::vector<std::uint32_t> sequences;
  std::atomic<std::size_t> count{0};
  ros::Publisher odometry;
  std::unique_ptr<ControllerNode> node;

 private:
  void onCommand(const mav_msgs::RollPitchYawrateThrust::ConstPtr& command) {
    stamps.push_back(command->header.stamp);
    count = stamps.size();
  }
  void onStatus(const online_controller::ControllerStatus::ConstPtr& status) {
    sequences.push_back(status->sequence);
    last_status_ = status->header.stamp.toNSec();
  }

  std::atomic<std::uint64_t> last_status_{0};
  ThreadQueue queue_;
  ros::NodeHandle handle_, private_handle_;
  ros::Subscriber commands_, statuses_;
  ros::Publisher reference_;
  ros::AsyncSpinner thread_{1, &queue_};
};

// A message may be replaced by a newer one, as in any queue of one; none is answered twice, late or out of order.
TEST(ControlThread, EachCommandHasItsStatusHoweverFastOdometryComes) {
  constexpr int kCount = 3000;
  Flight flight("/fast");
  ASSERT_TRUE(flight.exchange(ros::Time(99.9)));
  for (int i = 0; i < kCount; ++i) {
    flight.odometry.publish(odometryAt(ros::Time(100.0 + 0.01 * i)));
    if (i % 10 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  flight.odometry.publish(odometryAt(ros::Time(200.0)));
  ASSERT_TRUE(flight.awaitStatus(ros::Time(200.0)));
  for (std::size_t i = 1; i < flight.stamps.size(); ++i) ASSERT_LT(flight.stamps[i - 1], flight.stamps[i]);
  EXPECT_EQ(flight.stamps.back(), ros::Time(200.0));
  for (std::size_t i = 1; i < flight.sequences.size(); ++i)
    ASSERT_EQ(flight.sequences[i - 1] + 1, flight.sequences[i]);
}

// Zero-copy: what the subscriber gets is the node's message. One that was serialised would be counted.
TEST(ControlThread, NothingIsSerialisedWithinAProcess) {
  Flight flight("/shared");
  const long before = deserialised;
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(flight.exchange(ros::Time(100.0 + i)));
  EXPECT_EQ(deserialised, before);
}

// The counter of the test above counts.
TEST(ControlThread, ACommandFromBytesIsCounted) {
  ros::SubscribeOptions subscriber;
  subscriber.init<mav_msgs::RollPitchYawrateThrust>("command", 1,
                                                    [](const mav_msgs::RollPitchYawrateThrust::ConstPtr&) {});
  const ros::SerializedMessage bytes =
      ros::serialization::serializeMessage(mav_msgs::RollPitchYawrateThrust());
  ros::SubscriptionCallbackHelperDeserializeParams parameters;
  parameters.buffer = bytes.message_start;
  parameters.length = static_cast<std::uint32_t>(bytes.num_bytes - 4);
  parameters.connection_header = boost::make_shared<ros::M_string>();
  const long before = deserialised;
  EXPECT_NE(subscriber.helper->deserialize(parameters), nullptr);
  EXPECT_EQ(deserialised, before + 1);
}

TEST(ControlThread, TheNodeEndsAndAnotherBeginsWhileOdometryComes) {
  Flight flight("/ends");
  std::atomic<bool> done{false};
  std::thread publisher([&] {
    for (int i = 0; !done; ++i) {
      flight.odometry.publish(odometryAt(ros::Time(100.0 + 0.001 * i)));
      if (i % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  ros::NodeHandle handle("/ends"), private_handle("/ends/controller");
  for (int round = 0; round < 5; ++round) {
    const std::size_t before = flight.count;
    EXPECT_TRUE(await([&] { return flight.count >= before + 50; }));
    flight.node.reset();
    flight.node = std::make_unique<ControllerNode>(handle, private_handle);
  }
  done = true;
  publisher.join();
}

}  // namespace
}  // namespace polyfly_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "control_thread_test");
  if (!ros::master::check()) {
    std::cerr << "control_thread_test: no ROS master answers at " << ros::master::getURI()
              << "; rostest starts one\n";
    return 1;
  }
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
