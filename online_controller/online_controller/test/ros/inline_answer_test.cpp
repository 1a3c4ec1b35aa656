// Odometry answered in the thread that publishes it: the node in the process of the one who publishes.
#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <mav_msgs/RollPitchYawrateThrust.h>
#include <nav_msgs/Odometry.h>
#include <online_controller/ControllerStatus.h>
#include <pthread.h>
#include <ros/ros.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "online_controller_ros/callback_thread.hpp"
#include "online_controller_ros/controller_node.hpp"
#include "online_controller_ros/inline_callback_queue.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

// Commands that arrived as bytes.
std::atomic<long> deserialised_commands{0};

}  // namespace
}  // namespace polyfly_ros

namespace ros {
namespace serialization {

// What roscpp calls before it reads a message from bytes.
template <>
struct PreDeserialize<mav_msgs::RollPitchYawrateThrust> {
  static void notify(const PreDeserializeParams<mav_msgs::RollPitchYawrateThrust>&) {
    ++polyfly_ros::deserialised_commands;
  }
};

}  // namespace serialization
}  // namespace ros

namespace polyfly_ros {
namespace {

constexpr double kPatience = 20.0;  // until something must have happened [s]

nav_msgs::Odometry::Ptr odometryAt(const ros::Time& stamp, double x = 0.0) {
  auto odometry = boost::make_shared<nav_msgs::Odometry>();
  odometry->header.frame_id = "world";
  odometry->header.stamp = stamp;
  odometry->pose.pose.position.x = x;
  odometry->pose.pose.orientation.w = 1.0;
  return odometry;
}

std::string nameOfThisThread() {
  char name[16] = {};
  pthread_getname_np(pthread_self(), name, sizeof name);
  return name;
}

/// The node, and one who publishes odometry, unless the node shall be alone with a connection, and takes
/// commands where they are published.
class Flight {
 public:
  explicit Flight(const std::string& space, const std::string& answer = "",
                  ProcessKind process = ProcessKind::kNodeletManager)
      : handle_(space), private_handle_(space + "/controller") {
    private_handle_.setParam("law", "linear");
    private_handle_.setParam("controller/stale_periods", 10000);
    // An earlier flight may have left parameters.
    private_handle_.deleteParam("real_time");
    if (!answer.empty()) private_handle_.setParam("real_time/answer", answer);
    ros::SubscribeOptions options;
    options.init<mav_msgs::RollPitchYawrateThrust>(
        "command/roll_pitch_yawrate_thrust", 100,
        [this](const mav_msgs::RollPitchYawrateThrust::ConstPtr& command) {
          thread = std::this_thread::get_id();
          ++(nameOfThisThread() == "mpc_control" ? by_control : elsewhere);
          last = *command;
          stamps.push_back(command->header.stamp);
          count = stamps.size();
        });
    options.callback_queue = &inline_queue_;
    commands_ = handle_.subscribe(options);
    statuses_ =
        onQueue(handle_, queue_)
            .subscribe<online_controller::ControllerStatus>(
                "controller_status", 0, [this](const online_controller::ControllerStatus::ConstPtr& status) {
                  sequences.push_back(status->sequence);
                  last_stamp_ = status->header.stamp.toNSec();
                });
    if (process == ProcessKind::kNodeletManager)
      odometry = handle_.advertise<nav_msgs::Odometry>("odometry", 1);
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = "world";
    pose.pose.orientation.w = 1.0;
    reference_ = handle_.advertise<geometry_msgs::PoseStamped>("command/pose", 1, true);
    reference_.publish(pose);
    node = std::make_unique<ControllerNode>(handle_, private_handle_, LegacyNames{}, process);
    thread_.emplace(queue_, "statuses", CallbackThread::Tasks{});
    if (process == ProcessKind::kNodeletManager) awaitReference();
  }

  /// Publishes, and waits for the command.
  bool exchange(const ros::Time& stamp, double x = 0.0) {
    const std::size_t before = count;
    odometry.publish(odometryAt(stamp, x));
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kPatience);
    while (count == before && ros::WallTime::now() < end) std::this_thread::yield();
    return count > before;
  }

  /// Waits for the status of the odometry with this stamp, and takes no more.
  bool awaitStatus(const ros::Time& stamp) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kPatience);
    while (last_stamp_ != stamp.toNSec() && ros::WallTime::now() < end) std::this_thread::yield();
    thread_.reset();
    return last_stamp_ == stamp.toNSec();
  }

  // Guarded by the lock of the commands; to be read when nobody publishes.
  std::vector<ros::Time> stamps;
  std::thread::id thread;
  // Number of commands that the control thread published, and that others did.
  std::atomic<int> by_control{0}, elsewhere{0};
  mav_msgs::RollPitchYawrateThrust last;
  std::atomic<std::size_t> count{0};
  // Only the thread of the statuses uses `sequences`.
  std::vector<std::uint32_t> sequences;
  ros::Publisher odometry;
  std::unique_ptr<ControllerNode> node;

 private:
  /// Nothing is sent before a reference.
  void awaitReference() {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kPatience);
    for (int i = 0; count == 0 && ros::WallTime::now() < end; ++i) {
      odometry.publish(odometryAt(ros::Time(99.3 + 1e-4 * i)));
      ros::WallDuration(0.005).sleep();
    }
  }

  polyfly::TryLock lock_;
  std::atomic<std::uint64_t> last_stamp_{0};
  WaitableQueue queue_;
  InlineCallbackQueue inline_queue_{lock_, queue_};
  ros::NodeHandle handle_, private_handle_;
  ros::Subscriber commands_, statuses_;
  ros::Publisher reference_;
  std::optional<CallbackThread> thread_;
};

TEST(InlineAnswer, ComesInThePublishersThreadUnlessTheControlThreadIsToldTo) {
  for (const char* answer : {"", "auto", "publisher", "thread"}) {
    const bool in_publisher = std::string(answer) != "thread";
    Flight flight(std::string("/where") + answer, answer);
    int here = 0;
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kPatience);
    const auto missing = [&] { return in_publisher && here == 0 && ros::WallTime::now() < end; };
    for (int i = 1; i <= 20 || missing(); ++i) {
      ASSERT_TRUE(flight.exchange(ros::Time(100.0 + 0.01 * i)));
      here += flight.thread == std::this_thread::get_id() ? 1 : 0;
      ros::WallDuration(0.005).sleep();
    }
    // Some may meet the control thread at work: at the start, and always where the machine is slow.
    EXPECT_EQ(here > 0, in_publisher) << answer;
  }
}

TEST(InlineAnswer, EachCommandHasItsStatusHoweverFastOdometryComes) {
  constexpr int kCount = 3000;
  Flight flight("/fast");
  ASSERT_TRUE(flight.exchange(ros::Time(99.9)));
  for (int i = 0; i < kCount; ++i) {
    flight.odometry.publish(odometryAt(ros::Time(100.0 + 0.01 * i)));
    if (i % 10 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  ASSERT_TRUE(flight.exchange(ros::Time(200.0)));
  // A message may be replaced by a newer one, as in any queue of one; none is answered twice, late or out of
  // order. What is not told is missing in the sequence.
  for (std::size_t i = 1; i < flight.stamps.size(); ++i) ASSERT_LT(flight.stamps[i - 1], flight.stamps[i]);
  EXPECT_EQ(flight.stamps.back(), ros::Time(200.0));
  ASSERT_TRUE(flight.awaitStatus(ros::Time(200.0)));
  for (std::size_t i = 1; i < flight.sequences.size(); ++i)
    ASSERT_LT(flight.sequences[i - 1], flight.sequences[i]);
}

// Odometry over TCP holds other locks than odometry of this process: if both were answered where they come,
// the two could wait for each other for ever.
TEST(InlineAnswer, OdometryOfTwoOriginsStopsNobody) {
  Flight flight("/mixed");
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(3.0);
  std::size_t published = 0;
  while (ros::WallTime::now() < end || published <= 100) {
    flight.odometry.publish(odometryAt(ros::Time::now()));
    ++published;
    std::this_thread::sleep_for(std::chrono::microseconds(published % 7 * 100));
  }
  EXPECT_GT(published, 100U);
  const std::size_t before = flight.count;
  const ros::WallTime last = ros::WallTime::now() + ros::WallDuration(kPatience);
  while (flight.count < before + 100 && ros::WallTime::now() < last) ros::WallDuration(0.01).sleep();
  // The odometry over TCP is still answered.
  EXPECT_GE(flight.count, before + 100);
}

// Zero-copy: what the node reads is the publisher's message, and what the subscriber gets is the node's. A message that was
// serialised would not change any more with the object that was published.
TEST(InlineAnswer, NothingIsSerialisedWithinAProcess) {
  ros::NodeHandle handle("/shared");
  nav_msgs::Odometry::Ptr published;
  const ros::Time changed(300.0);
  // Called before the node, because it subscribes first.
  polyfly::TryLock lock;
  WaitableQueue queue;
  InlineCallbackQueue at_once(lock, queue);
  ros::SubscribeOptions options;
  options.init<nav_msgs::Odometry>("odometry", 1, [&](const nav_msgs::Odometry::ConstPtr& received) {
    if (!published) return;
    EXPECT_EQ(received.get(), published.get());
    published->header.stamp = changed;
  });
  options.callback_queue = &at_once;
  const ros::Subscriber before = handle.subscribe(options);
  Flight flight("/shared");
  const std::size_t commands = flight.count;
  published = odometryAt(ros::Time(100.0));
  const long deserialised = deserialised_commands;
  flight.odometry.publish(published);
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kPatience);
  while (flight.count == commands && ros::WallTime::now() < end) std::this_thread::yield();
  ASSERT_EQ(flight.count, commands + 1);
  EXPECT_EQ(flight.last.header.stamp, changed);
  EXPECT_EQ(deserialised_commands, deserialised);
}

// The counter of the test above counts.
TEST(InlineAnswer, ACommandFromBytesIsCounted) {
  ros::SubscribeOptions subscriber;
  subscriber.init<mav_msgs::RollPitchYawrateThrust>("command", 1,
                                                    [](const mav_msgs::RollPitchYawrateThrust::ConstPtr&) {});
  const ros::SerializedMessage bytes =
      ros::serialization::serializeMessage(mav_msgs::RollPitchYawrateThrust());
  ros::SubscriptionCallbackHelperDeserializeParams parameters;
  parameters.buffer = bytes.message_start;
  parameters.length = static_cast<std::uint32_t>(bytes.num_bytes - 4);
  parameters.connection_header = boost::make_shared<ros::M_string>();
  const long before = deserialised_commands;
  EXPECT_NE(subscriber.helper->deserialize(parameters), nullptr);
  EXPECT_EQ(deserialised_commands, before + 1);
}

// In a node of its own whoever reads the connection answers: nobody else has to wake up.
TEST(InlineAnswer, OdometryOverAConnectionIsAnsweredWhereItIsReadInANodeOfItsOwn) {
  for (const char* answer : {"", "thread"}) {
    Flight flight("/alone", answer, ProcessKind::kStandalone);
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kPatience);
    const bool here = std::string(answer) != "thread";
    const auto missing = [&] { return flight.count < 200 || (here && flight.elsewhere == 0); };
    while (missing() && ros::WallTime::now() < end) ros::WallDuration(0.01).sleep();
    EXPECT_GE(flight.count, 200U) << answer;
    // What comes while the control thread works is left to it.
    EXPECT_EQ(flight.elsewhere > 0, here) << flight.by_control << " by the control thread";
  }
}

// No lock of roscpp's is left behind: subscribers come and go, options change, all while odometry is
// answered.
TEST(InlineAnswer, ANodeOfItsOwnEndsAndBeginsAgainWhileItsConnectionBringsOdometry) {
  for (int round = 0; round < 5; ++round) {
    Flight flight("/alone", "", ProcessKind::kStandalone);
    dynamic_reconfigure::Reconfigure change;
    change.request.config.doubles.resize(1);
    change.request.config.doubles[0].name = "controller/yaw_gain";
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kPatience);
    for (int call = 0; call < 20 || (flight.count < 50 && ros::WallTime::now() < end); ++call) {
      change.request.config.doubles[0].value = 1.0 + call % 2;
      ASSERT_TRUE(ros::service::call("/alone/controller/set_parameters", change));
    }
    EXPECT_GE(flight.count, 50U);
  }
}

TEST(InlineAnswer, TheNodeEndsAndAnotherBeginsWhileOdometryComes) {
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
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kPatience);
    while (flight.count < before + 50 && ros::WallTime::now() < end) std::this_thread::yield();
    EXPECT_GE(flight.count, before + 50);
    flight.node.reset();
    const std::size_t after = flight.count;
    ros::WallDuration(0.02).sleep();
    EXPECT_EQ(flight.count, after);
    flight.node = std::make_unique<ControllerNode>(handle, private_handle);
  }
  done = true;
  publisher.join();
}

// A publisher that latches hands its last message over when a subscriber connects, with other locks.
TEST(InlineAnswer, ALatchedOdometryIsLeftToTheControlThread) {
  Flight flight("/latched");
  ASSERT_TRUE(flight.exchange(ros::Time(100.0)));
  flight.odometry.shutdown();
  ros::NodeHandle handle("/latched");
  flight.odometry = handle.advertise<nav_msgs::Odometry>("odometry", 1, true);
  ASSERT_TRUE(flight.exchange(ros::Time(101.0)));
  EXPECT_NE(flight.thread, std::this_thread::get_id());
}

TEST(AnswersInPublisher, IsChosenByNameAndByWhatIsAskedOfTheControlThread) {
  RealTimeOptions options;
  EXPECT_TRUE(answersInPublisher("auto", options));
  EXPECT_TRUE(answersInPublisher("publisher", options));
  EXPECT_FALSE(answersInPublisher("thread", options));
  EXPECT_THROW(answersInPublisher("both", options), polyfly::Error);
  options.lock_memory = true;
  EXPECT_TRUE(answersInPublisher("auto", options));
  options.core = 0;
  EXPECT_FALSE(answersInPublisher("auto", options));
  options = {};
  options.priority = 1;
  EXPECT_FALSE(answersInPublisher("auto", options));
  EXPECT_TRUE(answersInPublisher("publisher", options));
}

int publishOdometry(const std::string& topic) {
  ros::NodeHandle handle;
  const ros::Publisher publisher = handle.advertise<nav_msgs::Odometry>(topic, 1);
  for (ros::WallRate rate(500.0); ros::ok(); rate.sleep()) publisher.publish(odometryAt(ros::Time::now()));
  return 0;
}

}  // namespace
}  // namespace polyfly_ros

// With a topic for argument it is the other process that publishes odometry there.
int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "inline_answer_test");
  if (!ros::master::check()) {
    std::cerr << "inline_answer_test: no ROS master answers at " << ros::master::getURI()
              << "; rostest starts one\n";
    return 1;
  }
  if (argc > 1) return polyfly_ros::publishOdometry(argv[1]);
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
