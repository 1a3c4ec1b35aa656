#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include "online_controller_ros/active_laws.hpp"
#include "online_controller_ros/flight_snapshot.hpp"

namespace polyfly_ros {

/// Publishes status, percentiles of computing times and missed samples on /diagnostics. Lives in
/// the other thread.
class FlightDiagnostics {
 public:
  /// Keeps references. `period`: of control [s].
  FlightDiagnostics(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                    const FlightRecord& record, const ActiveLaws& laws);

  /// Publishes when it is time to. `snapshot` may be nullptr before the first step, and must live until the
  /// next call.
  void update(const FlightSnapshot* snapshot);

 private:
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);
  void summarise(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  diagnostic_updater::Updater updater_;
  const FlightRecord& record_;
  const ActiveLaws& laws_;
  const FlightSnapshot* snapshot_ = nullptr;
  std::int64_t told_overruns_ = 0;
  std::int64_t told_lost_ = 0;
  std::int64_t told_outside_ = 0;
  std::int64_t told_clipped_ = 0;
  std::int64_t told_without_plan_ = 0;
};

}  // namespace polyfly_ros
