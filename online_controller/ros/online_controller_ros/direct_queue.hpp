#pragma once

#include <ros/callback_queue_interface.h>
#include <ros/datatypes.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <utility>

#include "online_controller/realtime/baton.hpp"

namespace polyfly_ros {

/// A callback queue without a thread. Who adds a callback runs it at once, where the baton is free; where it
/// is not, the callback is left to `others`, whose thread takes the baton for each callback. So nobody who
/// adds ever waits, callbacks never run concurrently, and no wake-up lies between a message and its callback.
///
/// Order: what waits in a subscription's queue is taken from its front, whoever takes it, so a later message
/// never overtakes an earlier one. Removal: roscpp keeps its lock on a subscription while it adds, and takes
/// the same lock to remove; so no callback runs when a subscriber has been shut down. IN_FLIGHT.md says which
/// locks are held meanwhile, and why none can wait for another.
class DirectQueue : public ros::CallbackQueueInterface {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::time_point kNever = Clock::time_point::min();

  /// `follow_up`, where there is one, is added to `others` when a callback has run here. Keeps references.
  DirectQueue(polyfly::Baton& baton, ros::CallbackQueueInterface& others,
              ros::CallbackInterfacePtr follow_up = {})
      : baton_(baton), others_(others), follow_up_(std::move(follow_up)) {}

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) override;
  void removeByID(std::uint64_t owner_id) override { others_.removeByID(owner_id); }

  /// To be asked by a callback: whether the thread that added it runs it.
  bool runsHere() const noexcept { return runs_here_; }

  /// When a callback was last left to `others` for want of the baton; kNever: none was since this was asked
  /// last.
  Clock::time_point takeLeft() noexcept { return left_at_.exchange(kNever, std::memory_order_relaxed); }

 private:
  polyfly::Baton& baton_;
  ros::CallbackQueueInterface& others_;
  ros::CallbackInterfacePtr follow_up_;
  bool runs_here_ = false;  // guarded by the baton
  std::atomic<Clock::time_point> left_at_{kNever};
};

/// Which messages may be answered by the thread that brings them, in a process with others: those that
/// publish() of this process hands over, with roscpp's lock on all its publications held. Others come with
/// other locks: of a connection over TCP, and the last message of a publisher that latches, when it is
/// connected.
class PublishedHere {
 public:
  /// By the header of the connection that a message came by, which is compared with the last one.
  bool operator()(const boost::shared_ptr<ros::M_string>& header);

 private:
  boost::shared_ptr<ros::M_string> last_;
  bool answer_ = false;  // for the last one
};

}  // namespace polyfly_ros
