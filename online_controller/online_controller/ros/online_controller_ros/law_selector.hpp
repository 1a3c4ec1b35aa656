#pragma once

#include <online_controller/SelectLaw.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/service_server.h>

#include "online_controller_ros/active_laws.hpp"

namespace polyfly_ros {

/// The topic `active_law` and the service `select_law`.
class LawSelector {
 public:
  /// Keeps a reference to `laws`.
  LawSelector(ros::NodeHandle& handle, ActiveLaws& laws);

 private:
  bool onSelect(online_controller::SelectLaw::Request& request,
                online_controller::SelectLaw::Response& response);
  void publish();

  ActiveLaws& laws_;
  ros::Publisher publisher_;
  ros::ServiceServer service_;
};

}  // namespace polyfly_ros
