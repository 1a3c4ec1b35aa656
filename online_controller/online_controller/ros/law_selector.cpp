#include "online_controller_ros/law_selector.hpp"

#include <std_msgs/String.h>

#include <string>

#include "polyfly_base/error.hpp"

namespace polyfly_ros {

LawSelector::LawSelector(ros::NodeHandle& handle, ActiveLaws& laws)
    : laws_(laws),
      publisher_(handle.advertise<std_msgs::String>("active_law", 1, true)),
      service_(handle.advertiseService("select_law", &LawSelector::onSelect, this)) {
  publish();
}

bool LawSelector::onSelect(online_controller::SelectLaw::Request& request,
                           online_controller::SelectLaw::Response& response) {
  try {
    response.success = static_cast<unsigned char>(laws_.select(polyfly::lawOfName(request.law)));
    response.message = (response.success != 0 ? "" : request.law + " is not loaded; ") +
                       std::string(polyfly::lawName(laws_.active())) + " flies";
  } catch (const polyfly::Error& error) {
    response.success = 0;
    response.message = error.what();
  }
  publish();
  return true;
}

void LawSelector::publish() {
  std_msgs::String message;
  message.data = polyfly::lawName(laws_.active());
  publisher_.publish(message);
}

}  // namespace polyfly_ros
