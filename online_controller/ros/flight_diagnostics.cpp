#include "online_controller_ros/flight_diagnostics.hpp"

#include "online_controller_ros/conversions.hpp"

namespace polyfly_ros {
namespace {

using diagnostic_msgs::DiagnosticStatus;

double microseconds(std::int64_t nanoseconds) { return 1e-3 * static_cast<double>(nanoseconds); }

void addTimes(diagnostic_updater::DiagnosticStatusWrapper& status, const std::string& name,
              const polyfly::LatencyHistogram& times) {
  status.add(name + ", median [us]", microseconds(times.percentile(0.5)));
  status.add(name + ", p99 [us]", microseconds(times.percentile(0.99)));
  status.add(name + ", p99.9 [us]", microseconds(times.percentile(0.999)));
  status.add(name + ", greatest [us]", microseconds(times.greatest()));
}

}  // namespace

FlightDiagnostics::FlightDiagnostics(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                     const FlightRecord& record, const ActiveLaws& laws)
    : updater_(handle, private_handle, private_handle.getNamespace()), record_(record), laws_(laws) {
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
  const polyfly::ControlStatus control = snapshot_->report.status;
  const bool well = isAsAsked(snapshot_->report);
  const bool poor = polyfly::isOutsideMap(snapshot_->report) || control == polyfly::ControlStatus::kClipped ||
                    control == polyfly::ControlStatus::kSuboptimal ||
                    control == polyfly::ControlStatus::kLeastViolation ||
                    control == polyfly::ControlStatus::kNoReference;
  const auto level = well ? DiagnosticStatus::OK : poor ? DiagnosticStatus::WARN : DiagnosticStatus::ERROR;
  status.summary(level, std::string(polyfly::lawName(snapshot_->law)) + ": " + describe(snapshot_->report));
}

void FlightDiagnostics::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  summarise(status);
  const std::int64_t overruns = record_.overruns.load(std::memory_order_relaxed);
  const std::int64_t lost = record_.lost.load(std::memory_order_relaxed);
  if (overruns > told_overruns_) status.mergeSummary(DiagnosticStatus::WARN, "control periods overrun");
  if (lost > told_lost_) status.mergeSummary(DiagnosticStatus::WARN, "odometry missing");
  const std::int64_t outside = record_.outside_map.load(std::memory_order_relaxed);
  if (outside > told_outside_) status.mergeSummary(DiagnosticStatus::WARN, "left the maps");
  const std::int64_t clipped = record_.clipped.load(std::memory_order_relaxed);
  const std::int64_t without_plan = record_.without_plan.load(std::memory_order_relaxed);
  if (clipped > told_clipped_)
    status.mergeSummary(DiagnosticStatus::WARN, "clipped to the ranges of the maps");
  if (without_plan > told_without_plan_)
    status.mergeSummary(DiagnosticStatus::WARN, "no plan meets all bounds of the robust law");
  told_outside_ = outside;
  told_clipped_ = clipped;
  told_without_plan_ = without_plan;
  told_overruns_ = overruns;
  told_lost_ = lost;
  status.add("steps", record_.latency.count());
  addTimes(status, "odometry to command", record_.latency);
  addTimes(status, "control law", record_.step);
  status.add("control periods overrun", overruns);
  status.add("odometry missing", lost);
  status.add("samples outside the maps", outside);
  status.add("samples clipped to the maps", clipped);
  status.add("samples without a plan", without_plan);
  status.add("odometry that waited", record_.waited.load(std::memory_order_relaxed));
  status.add("laws exchanged", laws_.swaps());
  if (snapshot_ == nullptr) return;
  status.add("iterations", snapshot_->report.iterations);
  status.add("KKT residual", snapshot_->kkt_residual);
  status.add("age of odometry [ms]", 1e3 * snapshot_->odometry_age);
  const polyfly::TiltModel& loops = snapshot_->report.loops;
  status.add("roll loop, gain", loops.roll_gain);
  status.add("roll loop, lag [s]", loops.roll_time);
  status.add("pitch loop, gain", loops.pitch_gain);
  status.add("pitch loop, lag [s]", loops.pitch_time);
  status.add("drag beyond the model along x [1/s]", snapshot_->report.found_drag[0]);
  status.add("drag beyond the model along y [1/s]", snapshot_->report.found_drag[1]);
}

}  // namespace polyfly_ros
