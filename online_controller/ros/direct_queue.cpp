#include "online_controller_ros/direct_queue.hpp"

#include <ros/this_node.h>

namespace polyfly_ros {
namespace {

std::string entry(const ros::M_string& header, const char* key) {
  const auto found = header.find(key);
  return found == header.end() ? std::string() : found->second;
}

/// Ends the turn also when the callback throws.
struct Turn {
  bool& runs_here;
  polyfly::Baton& baton;

  ~Turn() {
    runs_here = false;
    baton.give();
  }
};

}  // namespace

void DirectQueue::addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) {
  if (!baton_.tryTake()) {
    left_at_.store(Clock::now(), std::memory_order_relaxed);
    others_.addCallback(callback, owner_id);
    return;
  }
  ros::CallbackInterface::CallResult result;
  runs_here_ = true;
  {
    const Turn turn{runs_here_, baton_};
    result = callback->call();
  }
  if (result == ros::CallbackInterface::TryAgain) others_.addCallback(callback, owner_id);
  if (follow_up_ != nullptr) others_.addCallback(follow_up_, reinterpret_cast<std::uint64_t>(this));
}

bool PublishedHere::operator()(const boost::shared_ptr<ros::M_string>& header) {
  if (header != last_) {
    last_ = header;
    answer_ = header != nullptr && entry(*header, "callerid") == ros::this_node::getName() &&
              entry(*header, "latching") != "1";
  }
  return answer_;
}

}  // namespace polyfly_ros
