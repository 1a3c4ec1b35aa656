#include "online_controller_ros/flight_diagnostics.hpp"

#include "online_controller_ros/conversions.hpp"

namespace polyfly_ros {
namespace {

using diagnostic_msgs::DiagnosticStatus;

double microseconds(std::int64_t nanoseconds) { return 1e-3 * static_cast<double>(nanoseconds); }

}  // namespace

FlightDiagnostics::FlightDiagnostics(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                     const FlightRecord& record, const ActiveLaws& laws)
    : updater_(handle, private_handle, private_handle.getNamespace()),
      record_(record),
      laws_(laws),
      counters_{
          {{record.overruns, "control periods overrun", "control periods overrun"},
           {record.lost, "odometry missing", "odometry missing"},
           {record.outside_map, "samples outside the maps", "left the maps"},
           {record.clipped, "samples clipped to the maps", "clipped to the ranges of the maps"},
           {record.without_plan, "samples without a plan", "no plan meets all bounds of the robust law"}}} {
  updater_.setHardwareID("none");
  updater_.add("control", this, &FlightDiagnostics::diagnose);
}

void FlightDiagnostics::update(const FlightSnapshot* snapshot) {
  snapshot_ = snapshot;
  updater_.update();
}

void FlightDiagnostics::summarise(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  if (snapshot_ == nullptr) {
    status.summary(DiagnosticStatus::WARN, "no odometry yet");
    return;
  }
  const polyfly::ControlReport& report = snapshot_->answered.report;
  const bool poor = polyfly::isAnswer(report.status) || report.status == polyfly::ControlStatus::kNoReference;
  const auto level = isAsAsked(report) ? DiagnosticStatus::OK
                     : poor            ? DiagnosticStatus::WARN
                                       : DiagnosticStatus::ERROR;
  status.summary(level, std::string(polyfly::lawName(snapshot_->answered.law)) + ": " + describe(report));
}

void FlightDiagnostics::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  summarise(status);
  status.add("steps", record_.steps.load(std::memory_order_relaxed));
  status.add("odometry to command, greatest [us]", microseconds(record_.greatest_latency));
  status.add("control law, greatest [us]", microseconds(record_.greatest_step));
  for (Counter& counter : counters_) {
    const std::int64_t count = counter.count.load(std::memory_order_relaxed);
    if (count > counter.told) status.mergeSummary(DiagnosticStatus::WARN, counter.warning);
    counter.told = count;
    status.add(counter.name, count);
  }
  status.add("laws exchanged", laws_.swaps());
  if (snapshot_ == nullptr) return;
  status.add("iterations", snapshot_->answered.report.iterations);
  status.add("KKT residual", snapshot_->kkt_residual);
  status.add("age of odometry [ms]", 1e3 * snapshot_->answered.odometry_age);
  status.add("commands swing", snapshot_->answered.report.swings);
  status.add("constant force not removed [N]", snapshot_->answered.report.force_left.norm());
}

}  // namespace polyfly_ros
