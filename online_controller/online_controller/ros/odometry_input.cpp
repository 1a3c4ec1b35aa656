#include "online_controller_ros/odometry_input.hpp"

#include <ros/subscribe_options.h>

#include <boost/make_shared.hpp>
#include <utility>

namespace polyfly_ros {
namespace {

/// A function as a callback.
class Task : public ros::CallbackInterface {
 public:
  explicit Task(std::function<void()> function) : function_(std::move(function)) {}
  CallResult call() override {
    function_();
    return Success;
  }

 private:
  std::function<void()> function_;
};

}  // namespace

OdometryInput::OdometryInput(const ros::NodeHandle& handle, bool in_publisher, ProcessKind process,
                             Callbacks callbacks, polyfly::TryLock& lock, WaitableQueue& queue,
                             FlightRecord& record)
    : in_publisher_(in_publisher),
      process_(process),
      callbacks_(std::move(callbacks)),
      record_(record),
      inline_queue_(lock, queue, boost::make_shared<Task>([this] { onFollowUp(); })) {
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const Event&>("odometry", 1,
                                               [this](const Event& event) { onOdometry(event); });
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  options.callback_queue = &queue;
  if (in_publisher_) options.callback_queue = &inline_queue_;
  subscriber_ = onQueue(handle, queue).subscribe(options);
}

void OdometryInput::onOdometry(const Event& event) {
  if (inline_queue_.runsInline()) {
    answerInline(event);
    return;
  }
  if (in_publisher_) ++record_.waited;
  callbacks_.answer(*event.getConstMessage());
  callbacks_.finish();
}

// A follow-up comes after this in any case.
void OdometryInput::answerInline(const Event& event) {
  const bool permitted =
      process_ == ProcessKind::kStandalone || is_intra_process_(event.getConnectionHeaderPtr());
  if (permitted && deferred_ == nullptr) {
    callbacks_.answer(*event.getConstMessage());
  } else {
    deferred_ = event.getConstMessage();
  }
}

void OdometryInput::onFollowUp() {
  if (deferred_ != nullptr) callbacks_.answer(*std::exchange(deferred_, nullptr));
  callbacks_.finish();
}

}  // namespace polyfly_ros
