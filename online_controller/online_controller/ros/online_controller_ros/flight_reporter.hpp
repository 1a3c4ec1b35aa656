#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <cstdint>

#include "online_controller/flight/flight_supervisor.hpp"
#include "online_controller_ros/active_laws.hpp"
#include "online_controller_ros/flight_record.hpp"

namespace polyfly_ros {

/// Reports each command after it was sent: `controller_status`, `found_model`, the log, the snapshot for the other thread, the counted
/// times. Used by the control thread only, like all that it reads.
class FlightReporter {
 public:
  /// Keeps references. `control_period` [s]: longer than that is an overrun.
  FlightReporter(ros::NodeHandle& handle, ActiveLaws& laws, polyfly::FlightSupervisor& flight,
                 FlightRecord& record, double control_period);

  /// Before the next step is prepared.
  void report(const Answered& answered);

  /// The time of the work since the command of `answered` [ns].
  void prepared(const Answered& answered, std::int64_t time);

 private:
  void publishStatus(const Answered& answered);
  void publishModel(const Answered& answered);
  void leaveSnapshot(const Answered& answered);
  std::int64_t lookupTime(const Answered& answered);
  void logChange(const Answered& answered);

  ActiveLaws& laws_;
  polyfly::FlightSupervisor& flight_;
  FlightRecord& record_;
  double control_period_;  // [s]
  ros::Publisher publisher_;
  ros::Publisher model_publisher_;

  // Preparation time of the sample before [ns].
  std::int64_t last_prepare_ = 0;
  polyfly::ControlStatus logged_status_ = polyfly::ControlStatus::kOptimal;
  polyfly::ControlReason logged_reason_ = polyfly::ControlReason::kNone;
};

}  // namespace polyfly_ros
