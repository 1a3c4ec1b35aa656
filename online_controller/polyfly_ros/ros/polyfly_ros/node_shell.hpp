#pragma once

#include <nodelet/nodelet.h>
#include <ros/callback_queue.h>
#include <ros/spinner.h>

#include <memory>

#include "polyfly_ros/guarded_queue.hpp"

namespace polyfly_ros {

/// A nodelet that is nothing but the node it holds, with a queue and a thread of its own. The manager's queue of nodelet
/// 1.10.0 (Debian 11) loses what comes during onInit(), such as a latched message, and its subscriber hears nothing more.
template <class Node>
class NodeShell : public nodelet::Nodelet {
 protected:
  void onInit() override {
    node_ = std::make_unique<Node>(onQueue(getNodeHandle(), queue_), onQueue(getPrivateNodeHandle(), queue_));
    spinner_.start();
  }

 private:
  ros::CallbackQueue queue_;
  std::unique_ptr<Node> node_;
  /// Ends before the node does.
  ros::AsyncSpinner spinner_{1, &queue_};
};

}  // namespace polyfly_ros
