#pragma once

#include <online_controller/SwapMaps.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <optional>
#include <string>

#include "online_controller/parameters/multirotor_parameters.hpp"
#include "online_controller_ros/active_laws.hpp"
#include "online_controller_ros/callback_thread.hpp"
#include "online_controller_ros/flight_diagnostics.hpp"
#include "online_controller_ros/flight_display.hpp"
#include "online_controller_ros/flight_snapshot.hpp"
#include "polyfly_base/change_bounds.hpp"
#include "polyfly_ros/option_table.hpp"
#include "polyfly_ros/parameters_in_force.hpp"
#include "polyfly_ros/reconfigure_server.hpp"

namespace polyfly_ros {

/// The thread for all that control must not wait for: changes of options and maps, display, diagnostics.
class ConfigThread {
 public:
  /// How the node starts.
  struct Start {
    const LawSetup& setup;
    /// Tells what of the parameters does not change in flight.
    const polyfly::MultirotorParameters& parameters;
    /// Further names under which options can be changed.
    const LegacyNames& names;
  };

  /// Keeps references to the last two.
  ConfigThread(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle, const Start& start,
               ActiveLaws& laws, FlightRecord& record);
  ConfigThread(const ConfigThread&) = delete;
  ConfigThread& operator=(const ConfigThread&) = delete;

 private:
  void apply();
  void noteInForce();
  std::string fixedInMaps() const;
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
  polyfly::MultirotorParameters start_;
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
  // Last member: begins when all others exist, and ends before they do.
  CallbackThread thread_;
};

}  // namespace polyfly_ros
