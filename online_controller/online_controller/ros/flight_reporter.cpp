#include "online_controller_ros/flight_reporter.hpp"

#include <online_controller/ControllerStatus.h>
#include <online_controller/FoundModel.h>
#include <ros/console.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <string>
#include <vector>

#include "online_controller/types/remark.hpp"
#include "online_controller_ros/conversions.hpp"
#include "online_controller_ros/flight_record.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly_ros {
namespace {

constexpr double kWarningInterval = 1.0;  // between two warnings [s]
constexpr double kRemarkInterval = 10.0;  // between two remarks on answers [s]
constexpr const char* kNothingSent = "; nothing is sent";

// One thread writes.
void raise(std::atomic<std::int64_t>& greatest, std::int64_t value) {
  if (value > greatest.load(std::memory_order_relaxed)) greatest.store(value, std::memory_order_relaxed);
}

bool isIdle(const Answered& answered) {
  return answered.report.status == polyfly::ControlStatus::kNoReference && !answered.sends;
}

}  // namespace

FlightReporter::FlightReporter(ros::NodeHandle& handle, ActiveLaws& laws, polyfly::FlightSupervisor& flight,
                               FlightRecord& record, double control_period)
    : laws_(laws),
      flight_(flight),
      record_(record),
      control_period_(control_period),
      publisher_(handle.advertise<online_controller::ControllerStatus>("controller_status", 100)),
      model_publisher_(handle.advertise<online_controller::FoundModel>("found_model", 100)) {}

void FlightReporter::report(const Answered& answered) {
  if (publisher_.getNumSubscribers() > 0) publishStatus(answered);
  if (model_publisher_.getNumSubscribers() > 0) publishModel(answered);
  leaveSnapshot(answered);
  logChange(answered);
  if (!answered.by_odometry) return;
  if (polyfly::isOutsideMap(answered.report)) ++record_.outside_map;
  if (answered.report.status == polyfly::ControlStatus::kClipped) ++record_.clipped;
  if (answered.report.status == polyfly::ControlStatus::kLeastViolation) ++record_.without_plan;
  ++record_.steps;
  raise(record_.greatest_latency, answered.times.latency());
  raise(record_.greatest_step, answered.times.step);
}

void FlightReporter::prepared(const Answered& answered, std::int64_t time) {
  StageTimes times = answered.times;
  last_prepare_ = times.prepare = time;
  if (times.whole() > static_cast<std::int64_t>(1e9 * control_period_)) ++record_.overruns;
}

void FlightReporter::publishStatus(const Answered& answered) {
  const auto status = boost::make_shared<online_controller::ControllerStatus>();
  status->header = answered.header;
  status->sequence = answered.sequence;
  status->law = polyfly::lawName(answered.law);
  status->iterations = answered.report.iterations;
  polyfly::LawInsight insight;
  laws_.flight().inspect(nullptr, insight);
  status->kkt_residual = insight.kkt_residual;
  status->odometry_age = answered.odometry_age;
  status->input_time_ns = answered.times.input;
  status->step_time_ns = answered.times.step;
  status->output_time_ns = answered.times.output;
  status->prepare_time_ns = last_prepare_;
  status->lookup_time_ns = lookupTime(answered);
  fillStatus(answered.report, laws_.laws().parameters(answered.law), *status);
  status->text += isIdle(answered) ? kNothingSent : "";
  publisher_.publish(status);
}

void FlightReporter::publishModel(const Answered& answered) {
  const auto message = boost::make_shared<online_controller::FoundModel>();
  message->header = answered.header;
  const polyfly::TiltModel& loops = answered.report.loops;
  message->roll_gain = loops.roll_gain;
  message->roll_time = loops.roll_time;
  message->pitch_gain = loops.pitch_gain;
  message->pitch_time = loops.pitch_time;
  std::copy(answered.report.found_drag.begin(), answered.report.found_drag.end(), message->drag.begin());
  model_publisher_.publish(message);
}

void FlightReporter::leaveSnapshot(const Answered& answered) {
  if (!record_.wanted.load(std::memory_order_acquire)) return;
  FlightSnapshot& snapshot = record_.snapshot;
  snapshot.answered = answered;
  snapshot.stage_period = laws_.flight().previewPeriod();
  const bool tracks = polyfly::isAnswer(answered.report.status) ||
                      answered.report.status == polyfly::ControlStatus::kHoldLast;
  const bool shows = record_.show_paths.load(std::memory_order_relaxed);
  snapshot.reference_count = !tracks ? 0 : shows ? laws_.flight().previewLength() : 1;
  const std::vector<polyfly::Reference>& reference =
      snapshot.reference_count > 1 ? flight_.wholePreview() : flight_.preview();
  std::copy_n(reference.begin(), snapshot.reference_count, snapshot.reference.begin());
  const bool same_stages = laws_.flight().stagePeriod() == laws_.flight().previewPeriod();
  polyfly::LawInsight insight;
  insight.room = shows && tracks && same_stages ? snapshot.reference_count : 0;
  insight.positions = snapshot.predicted.data();
  laws_.flight().inspect(snapshot.reference.data(), insight);
  snapshot.kkt_residual = insight.kkt_residual;
  snapshot.predicted_count = insight.count;
  record_.wanted.store(false, std::memory_order_release);
}

std::int64_t FlightReporter::lookupTime(const Answered& answered) {
  const std::vector<polyfly::RegionMap>& maps = laws_.laws().maps(answered.law);
  if (maps.empty()) return 0;
  for (const polyfly::AxisReport& axis : answered.report.axis) {
    if (axis.size == 0) return 0;
  }
  double input = 0.0;
  StageClock clock;
  for (std::size_t i = 0; i < maps.size(); ++i)
    maps[i].evaluate(answered.report.axis[i].theta.data(), &input);
  return clock.lap() / static_cast<std::int64_t>(maps.size());
}

void FlightReporter::logChange(const Answered& answered) {
  const polyfly::ControlReport& report = answered.report;
  if (polyfly::hasRemark(report))
    ROS_WARN_THROTTLE(kRemarkInterval, "MPC: %s", polyfly::remarkOn(report).c_str());
  if (report.status == logged_status_ && report.reason == logged_reason_) return;
  logged_status_ = report.status;
  logged_reason_ = report.reason;
  const std::string text =
      describe(report, &laws_.laws().parameters(answered.law)) + (isIdle(answered) ? kNothingSent : "");
  if (isAsAsked(report)) {
    ROS_INFO_THROTTLE(kWarningInterval, "MPC: %s", text.c_str());
  } else {
    ROS_WARN_THROTTLE(kWarningInterval, "MPC: %s", text.c_str());
  }
}

}  // namespace polyfly_ros
