// Changes options of a node at a fixed rate, through dynamic_reconfigure. Parameters: ~node, ~rate [1/s],
// ~names (options of type double), ~least, ~greatest: the values between which each of them goes back and
// forth, and ~turn [s]: so long it does, and as long it rests, in turn (probe_times.hpp); 0: without a rest.
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/ros.h>

#include <string>
#include <vector>

#include "probe_times.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "reconfigure_load");
  const ros::NodeHandle private_handle("~");
  ros::NodeHandle handle;
  const auto node = private_handle.param<std::string>("node", "controller");
  const auto names = private_handle.param<std::vector<std::string>>(
      "names", {"controller/yaw_gain", "nonlinear/thrust_weight"});
  const double least = private_handle.param("least", 1.0);
  const double greatest = private_handle.param("greatest", 2.0);
  const std::string service = node + "/set_parameters";
  ros::service::waitForService(handle.resolveName(service));
  ros::ServiceClient client = handle.serviceClient<dynamic_reconfigure::Reconfigure>(service, true);
  const polyfly_ros::Turns turns(private_handle.param("turn", 0.0));
  ros::WallRate rate(private_handle.param("rate", 100.0));
  long calls = 0, failed = 0;
  double seconds = 0.0;  // at work
  ros::WallTime before;
  for (; ros::ok(); rate.sleep()) {
    const ros::WallTime now = ros::WallTime::now();
    const bool loaded = turns.loadedAt(now.toSec());
    if (loaded && !before.isZero()) seconds += (now - before).toSec();
    before = loaded ? now : ros::WallTime();
    if (!loaded) continue;
    dynamic_reconfigure::Reconfigure change;
    change.request.config.doubles.resize(1);
    change.request.config.doubles[0].name = names[static_cast<std::size_t>(calls / 2) % names.size()];
    change.request.config.doubles[0].value = calls % 2 == 0 ? least : greatest;
    if (!client.call(change) && ros::ok()) ++failed;
    ++calls;
  }
  std::printf("%ld reconfigurations in %.3f s, %ld failed\n", calls, seconds, failed);
}
