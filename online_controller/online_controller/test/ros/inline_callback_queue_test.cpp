// The queue that runs callbacks where they are added, with callbacks made by hand: no master is needed.
#include "online_controller_ros/inline_callback_queue.hpp"

#include <gtest/gtest.h>
#include <ros/init.h>
#include <ros/message_deserializer.h>
#include <ros/subscription_callback_helper.h>
#include <ros/subscription_queue.h>
#include <ros/this_node.h>
#include <ros/time.h>
#include <std_msgs/UInt32.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <functional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "online_controller_ros/callback_thread.hpp"

namespace polyfly_ros {
namespace {

constexpr std::uint64_t kOwner = 7;

class Callback : public ros::CallbackInterface {
 public:
  explicit Callback(std::function<void()> function, CallResult result = Success)
      : function_(std::move(function)), result_(result) {}
  CallResult call() override {
    function_();
    return result_;
  }

 private:
  std::function<void()> function_;
  CallResult result_;
};

ros::CallbackInterfacePtr callback(std::function<void()> function, ros::CallbackInterface::CallResult result =
                                                                       ros::CallbackInterface::Success) {
  return boost::make_shared<Callback>(std::move(function), result);
}

struct InlineCallbackQueueTest : testing::Test {
  polyfly::TryLock lock;
  WaitableQueue others;  // with the callbacks that did not run inline
  int follow_ups = 0;
  InlineCallbackQueue queue{lock, others, callback([this] { ++follow_ups; })};
};

TEST_F(InlineCallbackQueueTest, RunsWhereItIsAddedAndTheFollowUpIsLeft) {
  bool here = false;
  std::thread::id thread;
  queue.addCallback(callback([&] {
                      thread = std::this_thread::get_id();
                      here = queue.runsInline();
                      EXPECT_FALSE(lock.try_lock());
                    }),
                    kOwner);
  EXPECT_EQ(thread, std::this_thread::get_id());
  EXPECT_TRUE(here);
  EXPECT_FALSE(queue.runsInline());
  EXPECT_EQ(follow_ups, 0);
  others.callAvailable();
  EXPECT_EQ(follow_ups, 1);
  EXPECT_TRUE(lock.try_lock());
}

TEST_F(InlineCallbackQueueTest, IsLeftToOthersWhileTheLockIsTaken) {
  lock.lock();
  int calls = 0;
  queue.addCallback(callback([&] {
                      ++calls;
                      EXPECT_FALSE(queue.runsInline());
                    }),
                    kOwner);
  EXPECT_EQ(calls, 0);
  others.callAvailable();
  EXPECT_EQ(calls, 1);
  // The thread that called the callback does the rest itself.
  EXPECT_EQ(follow_ups, 0);
}

TEST_F(InlineCallbackQueueTest, WhatIsRemovedIsNotCalled) {
  lock.lock();
  int calls = 0;
  queue.addCallback(callback([&] { ++calls; }), kOwner);
  queue.removeByID(kOwner);
  others.callAvailable();
  EXPECT_EQ(calls, 0);
}

TEST_F(InlineCallbackQueueTest, ACallbackAddedWithinACallbackIsLeft) {
  std::vector<int> order;
  queue.addCallback(callback([&] {
                      queue.addCallback(callback([&] { order.push_back(2); }), kOwner);
                      order.push_back(1);
                    }),
                    kOwner);
  EXPECT_EQ(order, std::vector<int>({1}));
  others.callAvailable();
  EXPECT_EQ(order, std::vector<int>({1, 2}));
}

TEST_F(InlineCallbackQueueTest, ACallbackThatCannotBeCalledNowIsLeft) {
  int calls = 0;
  queue.addCallback(callback([&] { ++calls; }, ros::CallbackInterface::TryAgain), kOwner);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(others.callOne(), ros::CallbackQueue::TryAgain);
  EXPECT_EQ(calls, 2);
}

TEST_F(InlineCallbackQueueTest, TheLockIsFreeAfterAnException) {
  ros::Time::init();  // the error message has a time
  queue.addCallback(callback([] { throw std::runtime_error("no"); }), kOwner);
  EXPECT_FALSE(queue.runsInline());
  EXPECT_TRUE(lock.try_lock());
}

// As roscpp's Subscription does it, which holds a lock meanwhile: the message goes into the subscription's
// queue, which is added as a callback unless it was full.
class Subscriber {
 public:
  Subscriber(InlineCallbackQueue& queue, int size, const std::function<void(unsigned)>& take)
      : queue_(queue),
        messages_(boost::make_shared<ros::SubscriptionQueue>("numbers", size, false)),
        helper_(boost::make_shared<Helper>([take](const std_msgs::UInt32::ConstPtr& m) { take(m->data); })) {}

  void publish(unsigned number) {
    const auto message = boost::make_shared<std_msgs::UInt32>();
    message->data = number;
    ros::SerializedMessage serialized;
    serialized.message = message;
    serialized.type_info = &typeid(std_msgs::UInt32);
    bool was_full = false;
    messages_->push(helper_,
                    boost::make_shared<ros::MessageDeserializer>(helper_, serialized,
                                                                 boost::make_shared<ros::M_string>()),
                    false, ros::VoidConstWPtr(), false, ros::Time(), &was_full);
    if (!was_full) queue_.addCallback(messages_, kOwner);
  }

 private:
  using Helper = ros::SubscriptionCallbackHelperT<const std_msgs::UInt32::ConstPtr&>;

  InlineCallbackQueue& queue_;
  boost::shared_ptr<ros::SubscriptionQueue> messages_;
  boost::shared_ptr<Helper> helper_;
};

/// Publishes to a subscriber with a queue of that size while the other thread has work of its own; what came.
/// Where the two meet is up to the machine but for one number: it comes while the other thread is at work.
std::vector<unsigned> numbersThrough(int size, unsigned count, bool& was_left) {
  polyfly::TryLock lock;
  WaitableQueue others;
  InlineCallbackQueue queue(lock, others);
  std::vector<unsigned> came;  // guarded by the lock
  std::atomic<unsigned> last{0};
  was_left = false;
  Subscriber subscriber(queue, size, [&](unsigned number) {
    came.push_back(number);
    if (!queue.runsInline()) was_left = true;
    last = number;
  });
  long work = 0;  // guarded by the lock
  const auto busy = callback([&] {
    for (int i = 0; i < 300; ++i) ++work;
  });
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(60.0);
  const auto await = [&end](const std::function<bool()>& condition) {
    while (!condition() && ros::WallTime::now() < end) std::this_thread::yield();
  };
  std::atomic<bool> at_work{false};
  std::atomic<bool> published{false};
  const auto until_published = callback([&] {
    at_work = true;
    await([&] { return published.load(); });
  });
  {
    const CallbackThread thread(others, "others", {{}, {}, 0.05, &lock});
    for (unsigned number = 1; number <= count; ++number) {
      if (number % 3 == 0) others.addCallback(busy, kOwner + 1);
      if (number == count / 2) {
        others.addCallback(until_published, kOwner + 1);
        await([&] { return at_work.load(); });
      }
      subscriber.publish(number);
      if (number == count / 2) published = true;
    }
    await([&] { return last == count; });
  }
  return came;
}

// A queue of one keeps the newest while another thread calls back; that thread then answers that one, also
// where it came while an answer was being given.
TEST_F(InlineCallbackQueueTest, ANewerMessageReplacesOneThatWaitsAndIsNotStranded) {
  std::vector<unsigned> came;
  Subscriber* publisher = nullptr;
  Subscriber subscriber(queue, 1, [&](unsigned number) {
    came.push_back(number);
    if (number == 3 || number == 10) {
      publisher->publish(number + 1);
      publisher->publish(number + 2);
    }
  });
  publisher = &subscriber;
  lock.lock();
  for (const unsigned number : {1U, 2U, 3U}) subscriber.publish(number);  // left to others
  EXPECT_TRUE(came.empty());
  others.callAvailable();
  EXPECT_EQ(came.front(), 3U);
  others.callAvailable();
  EXPECT_EQ(came, std::vector<unsigned>({3, 5}));
  lock.unlock();
  subscriber.publish(10);  // answered here; what comes meanwhile is left
  others.callAvailable();
  EXPECT_EQ(came, std::vector<unsigned>({3, 5, 10, 12}));
  subscriber.publish(20);
  EXPECT_EQ(came.back(), 20U);
}

// A queue of one keeps the newest: what comes is in order, and the last one always comes.
TEST(InlineCallbackQueueThreads, ANewerMessageReplacesOneThatWaitsAndIsNotStranded) {
  constexpr unsigned kCount = 50000;
  bool was_left = false;
  const std::vector<unsigned> came = numbersThrough(1, kCount, was_left);
  ASSERT_FALSE(came.empty());
  for (std::size_t i = 1; i < came.size(); ++i) ASSERT_LT(came[i - 1], came[i]);
  EXPECT_EQ(came.back(), kCount);
  EXPECT_TRUE(was_left);
}

// With room for all of them none is lost, and a later one never overtakes.
TEST(InlineCallbackQueueThreads, AllComeInOrderHoweverTheyCome) {
  constexpr unsigned kCount = 50000;
  bool was_left = false;
  const std::vector<unsigned> came = numbersThrough(0, kCount, was_left);
  ASSERT_EQ(came.size(), kCount);
  for (unsigned i = 0; i < kCount; ++i) ASSERT_EQ(came[i], i + 1);
  EXPECT_TRUE(was_left);
}

TEST(IsIntraProcess, IsTrueOfWhatPublishOfThisProcessHandsOver) {
  const auto header = [](const std::string& node, const std::string& latching) {
    return boost::make_shared<ros::M_string>(ros::M_string{{"callerid", node}, {"latching", latching}});
  };
  IsIntraProcess is_intra_process;
  EXPECT_FALSE(is_intra_process(nullptr));
  EXPECT_TRUE(is_intra_process(header(ros::this_node::getName(), "0")));
  EXPECT_FALSE(is_intra_process(header("/another", "0")));
  EXPECT_FALSE(is_intra_process(header(ros::this_node::getName(), "1")));
  EXPECT_FALSE(is_intra_process(boost::make_shared<ros::M_string>()));
}

}  // namespace
}  // namespace polyfly_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "inline_callback_queue_test", ros::init_options::NoSigintHandler);
  return RUN_ALL_TESTS();
}
