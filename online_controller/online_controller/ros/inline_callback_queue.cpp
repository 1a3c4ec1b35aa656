#include "online_controller_ros/inline_callback_queue.hpp"

#include <ros/this_node.h>

#include <mutex>

#include "polyfly_ros/guarded_queue.hpp"

namespace polyfly_ros {
namespace {

std::string entry(const ros::M_string& header, const char* key) {
  const auto found = header.find(key);
  return found == header.end() ? std::string() : found->second;
}

/// Marks a callback as inline, until it returns.
class InlineMark {
 public:
  explicit InlineMark(bool& mark) : mark_(mark) { mark_ = true; }
  InlineMark(const InlineMark&) = delete;
  InlineMark& operator=(const InlineMark&) = delete;
  ~InlineMark() { mark_ = false; }

 private:
  bool& mark_;
};

}  // namespace

void InlineCallbackQueue::addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) {
  std::unique_lock<polyfly::TryLock> owned(lock_, std::try_to_lock);
  if (!owned.owns_lock()) {
    fallback_.addCallback(callback, owner_id);
    return;
  }
  ros::CallbackInterface::CallResult result;
  {
    const InlineMark mark(runs_inline_);
    result = callGuarded(*callback);
  }
  owned.unlock();
  if (result == ros::CallbackInterface::TryAgain) fallback_.addCallback(callback, owner_id);
  if (follow_up_ != nullptr) fallback_.addCallback(follow_up_, reinterpret_cast<std::uint64_t>(this));
}

bool IsIntraProcess::operator()(const boost::shared_ptr<ros::M_string>& header) {
  if (header != last_) {
    last_ = header;
    result_ = header != nullptr && entry(*header, "callerid") == ros::this_node::getName() &&
              entry(*header, "latching") != "1";
  }
  return result_;
}

}  // namespace polyfly_ros
