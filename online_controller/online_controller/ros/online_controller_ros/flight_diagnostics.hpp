#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include <array>
#include <atomic>
#include <cstdint>

#include "online_controller_ros/active_laws.hpp"
#include "online_controller_ros/flight_record.hpp"

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
  /// A count of the record, with a warning where it has grown.
  struct Counter {
    const std::atomic<std::int64_t>& count;
    const char* name;
    const char* warning;
    std::int64_t told = 0;
  };

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);
  void summarise(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  diagnostic_updater::Updater updater_;
  const FlightRecord& record_;
  const ActiveLaws& laws_;
  const FlightSnapshot* snapshot_ = nullptr;
  std::array<Counter, 5> counters_;
};

}  // namespace polyfly_ros
