#include "polyfly_ros/guarded_queue.hpp"

#include <ros/console.h>

#include <boost/make_shared.hpp>
#include <exception>

namespace polyfly_ros {
namespace {

constexpr double kInterval = 1.0;  // between two error messages [s]

class Guarded : public ros::CallbackInterface {
 public:
  explicit Guarded(const ros::CallbackInterfacePtr& callback) : callback_(callback) {}

  CallResult call() override {
    try {
      return callback_->call();
    } catch (const std::exception& error) {
      ROS_ERROR_THROTTLE(kInterval, "a message or a request was dropped: %s", error.what());
      return Invalid;
    }
  }
  bool ready() override { return callback_->ready(); }

 private:
  ros::CallbackInterfacePtr callback_;
};

}  // namespace

ros::CallbackInterfacePtr guarded(const ros::CallbackInterfacePtr& callback) {
  return boost::make_shared<Guarded>(callback);
}

ros::NodeHandle onQueue(const ros::NodeHandle& handle, ros::CallbackQueueInterface& queue) {
  ros::NodeHandle copy(handle);
  copy.setCallbackQueue(&queue);
  return copy;
}

}  // namespace polyfly_ros
