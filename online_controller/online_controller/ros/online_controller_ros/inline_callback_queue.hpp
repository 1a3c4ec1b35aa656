#pragma once

#include <ros/callback_queue_interface.h>
#include <ros/datatypes.h>

#include <cstdint>
#include <utility>

#include "online_controller/realtime/try_lock.hpp"

namespace polyfly_ros {

/// A callback queue without a thread. The thread that adds a callback runs it at once where the lock is free.
/// Otherwise the callback goes into the `fallback` queue, whose thread locks for each callback. So nobody who
/// adds a callback waits, callbacks never run concurrently, and no thread has to wake up in between.
///
/// Order: each thread takes the front of a subscription's queue, so a later message never overtakes an
/// earlier one. Removal: roscpp holds a lock of the subscription while it adds a callback, and takes the same
/// lock to remove a subscriber. So no callback runs after a subscriber was shut down. IN_FLIGHT.md tells
/// which locks are held and why there is no deadlock.
class InlineCallbackQueue : public ros::CallbackQueueInterface {
 public:
  /// `follow_up`, if there is one, is added to `fallback` after each callback that ran inline. Keeps
  /// references.
  InlineCallbackQueue(polyfly::TryLock& lock, ros::CallbackQueueInterface& fallback,
                      ros::CallbackInterfacePtr follow_up = {})
      : lock_(lock), fallback_(fallback), follow_up_(std::move(follow_up)) {}

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) override;
  void removeByID(std::uint64_t owner_id) override { fallback_.removeByID(owner_id); }

  /// For callbacks: whether this one runs in the thread that added it.
  bool runsInline() const noexcept { return runs_inline_; }

 private:
  polyfly::TryLock& lock_;
  ros::CallbackQueueInterface& fallback_;
  ros::CallbackInterfacePtr follow_up_;
  bool runs_inline_ = false;  // guarded by lock_
};

/// Whether a message was handed over by publish() of this process, which holds roscpp's lock of all
/// publications. A message over TCP comes with other locks. So does the last message of a publisher that
/// latches, when a subscriber connects.
class IsIntraProcess {
 public:
  /// `header` is that of the message's connection. The result for the last header is kept.
  bool operator()(const boost::shared_ptr<ros::M_string>& header);

 private:
  boost::shared_ptr<ros::M_string> last_;
  bool result_ = false;
};

}  // namespace polyfly_ros
