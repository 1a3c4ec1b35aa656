#pragma once

#include <online_controller/SwapMaps.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <string>

#include "online_controller_ros/callback_thread.hpp"
#include "online_controller_ros/flight_diagnostics.hpp"
#include "online_controller_ros/flight_display.hpp"
#include "online_controller_ros/flight_snapshot.hpp"
#include "online_controller_ros/law_keeper.hpp"
#include "online_controller_ros/workshop.hpp"
#include "polyfly_base/change_bounds.hpp"
#include "polyfly_ros/option_table.hpp"
#include "polyfly_ros/reconfigure_server.hpp"

namespace polyfly_ros {

/// All that a flight needs and its control thread must not wait for, in a thread of its own: options and maps
/// that change, display, diagnostics.
class Background {
 public:
  /// `names`: under which options can be changed besides ours. Keeps references to the last two.
  Background(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle, const LawSetup& setup,
             const ForeignNames& names, LawKeeper& keeper, FlightRecord& record);
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  /// As the function of that name, for this thread.
  std::string runBelow(pid_t thread, int steps) {
    return polyfly_ros::runBelow(thread, steps, thread_.handle());
  }

 private:
  void apply();
  void noteInForce();
  std::string bakedIn() const;
  bool onSwapMaps(online_controller::SwapMaps::Request& request,
                  online_controller::SwapMaps::Response& response);
  std::string waitForExchange() const;
  void onTick();

  WatchedQueue queue_;  // outlives all that is served on it
  ros::NodeHandle handle_;
  ros::NodeHandle private_handle_;
  LawSetup setup_;  // what was offered last
  LawKeeper& keeper_;
  FlightRecord& record_;
  OptionTable table_;             // of setup_
  polyfly::ChangeBounds bounds_;  // of its values
  ReconfigureServer reconfigure_;
  FlightDisplay display_;
  FlightDiagnostics diagnostics_;
  ros::ServiceServer swap_service_;
  Workshop workshop_;
  ros::SteadyTimer tick_;
  int ticks_ = 0;
  CallbackThread thread_;  // last: begins when all is there, ends before it goes
};

}  // namespace polyfly_ros
