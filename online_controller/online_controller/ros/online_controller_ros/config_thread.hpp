#pragma once

#include <online_controller/SwapMaps.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>
#include <ros/steady_timer.h>

#include <optional>
#include <string>

#include "online_controller_ros/active_laws.hpp"
#include "online_controller_ros/flight_diagnostics.hpp"
#include "online_controller_ros/flight_display.hpp"
#include "online_controller_ros/flight_record.hpp"
#include "polyfly_base/change_bounds.hpp"
#include "polyfly_ros/guarded_queue.hpp"
#include "polyfly_ros/option_table.hpp"
#include "polyfly_ros/parameters_in_force.hpp"
#include "polyfly_ros/reconfigure_server.hpp"

namespace polyfly_ros {

/// The thread for all that control must not wait for: changes of options and maps, display, diagnostics.
class ConfigThread {
 public:
  /// `names` are further names under which options can be changed. Keeps references to the last two.
  ConfigThread(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle, const LawSetup& setup,
               const LegacyNames& names, ActiveLaws& laws, FlightRecord& record);
  ConfigThread(const ConfigThread&) = delete;
  ConfigThread& operator=(const ConfigThread&) = delete;

 private:
  void apply();
  void noteInForce();
  bool onSwapMaps(online_controller::SwapMaps::Request& request,
                  online_controller::SwapMaps::Response& response);
  std::string waitForSwap() const;
  void tellOfLaw();
  const FlightSnapshot* snapshot() const { return snapshot_ ? &*snapshot_ : nullptr; }
  void onTick();

  // Queue of this thread; outlives all that is served on it.
  ThreadQueue queue_;
  ros::NodeHandle handle_;
  ros::NodeHandle private_handle_;
  // Setup that was staged last.
  LawSetup setup_;
  ActiveLaws& laws_;
  FlightRecord& record_;
  // The last one, of at most a tick ago; none before the first odometry.
  std::optional<FlightSnapshot> snapshot_;
  // Options of setup_.
  OptionTable table_;
  // Bounds on changes of the table's values.
  polyfly::ChangeBounds bounds_;
  ReconfigureServer reconfigure_;
  // Law that was told last.
  polyfly::Law law_;
  ParametersInForce in_force_;
  FlightDisplay display_;
  FlightDiagnostics diagnostics_;
  ros::ServiceServer swap_service_;
  int ticks_ = 0;
  ros::SteadyTimer timer_;
  // Last member: ends before the others do.
  ros::AsyncSpinner thread_{1, &queue_};
};

}  // namespace polyfly_ros
