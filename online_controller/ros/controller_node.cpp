#include "online_controller_ros/controller_node.hpp"

#include <std_msgs/String.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <exception>
#include <limits>

#include "online_controller_ros/conversions.hpp"
#include "online_controller_ros/stage_clock.hpp"
#include "region_maps/error.hpp"

namespace polyfly_ros {
namespace {

constexpr double kLogInterval = 1.0;  // between two warnings [s]
constexpr double kLongGap = 100.0;    // so many control periods without odometry are no loss of single ones
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

ExplicitMpcNode::Setup ExplicitMpcNode::readSetup(const ros::NodeHandle& private_handle) {
  Setup setup;
  ParameterReader reader(private_handle);
  setup.laws = LawSetup::read(reader);
  setup.flight = FlightSetup::read(reader);
  visitNodeOptions(setup.node, reader);
  setup.output = OutputOptions::read(reader);
  visitRealTimeOptions(setup.real_time, reader);
  reader.refuseUnknown({"maps", "robust_maps", "problems", "vehicle", "controller", "linear", "nonlinear",
                        "control_interface", "rc", "output", "real_time"});
  return setup;
}

ExplicitMpcNode::ExplicitMpcNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                 const ForeignNames& names) try
    : ExplicitMpcNode(handle, private_handle, names, readSetup(private_handle)) {
} catch (const std::exception& error) {
  ROS_FATAL("explicit MPC does not start: %s", error.what());
  throw;
}

ExplicitMpcNode::ExplicitMpcNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                 const ForeignNames& names, const Setup& setup)
    : handle_(onQueue(handle, queue_)),
      keeper_(setup.laws),
      flight_(laws(), setup.laws.controller, setup.flight.flight, setup.flight.pilot),
      interface_(handle_, onQueue(private_handle, queue_), flight_, setup.flight, setup.laws),
      output_(handle_, setup.output, setup.laws.controller),
      record_(flight_.preview().size()),
      control_period_(setup.laws.controller.control_period),
      poll_(control_period_, setup.real_time.poll),
      silence_(setup.node.stale_periods * control_period_) {
  connect();
  background_.emplace(handle, private_handle, setup.laws, names, keeper_, record_);
  const auto begin = [real_time = setup.real_time] {
    const std::string refused = becomeRealTime(real_time);
    if (!refused.empty()) ROS_WARN("explicit MPC: %s", refused.c_str());
  };
  control_thread_.emplace(queue_, "mpc_control", begin, [this](double most) {
    const auto now = polyfly::PollWindow::Clock::now();
    if (poll_.rehearses(now)) laws().rehearse();
    return poll_.sleep(now, most);
  });
}

void ExplicitMpcNode::connect() {
  ros::NodeHandle& handle = handle_;
  status_publisher_ = handle.advertise<online_controller::ControllerStatus>("controller_status", 100);
  law_publisher_ = handle.advertise<std_msgs::String>("active_law", 1, true);
  publishLaw();
  law_service_ = handle.advertiseService("select_law", &ExplicitMpcNode::onSelectLaw, this);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  interface_.onManual([this](const ros::Time& now) { onManual(now); });
  odometry_subscriber_ = handle.subscribe("odometry", 1, &ExplicitMpcNode::onOdometry, this, hints);
  watchdog_ =
      handle.createTimer(ros::Duration(control_period_), [this](const ros::TimerEvent&) { onWatchdog(); });
}

void ExplicitMpcNode::onOdometry(const nav_msgs::Odometry::ConstPtr& message) {
  StageClock clock;
  poll_.served(polyfly::PollWindow::Clock::now());
  arrival_ = ros::Time::now();
  // /clock is handled on another thread: simulated time may still stand before the odometry that came with it
  if (ros::Time::isSimTime()) arrival_ = std::max(arrival_, message->header.stamp);
  has_odometry_ = true;
  frame_ = message->header.frame_id;
  odometry_age_ = (arrival_ - message->header.stamp).toSec();
  countLost(message->header.stamp);
  const polyfly::VehicleState state = toVehicleState(*message);
  const bool frame_fits = interface_.frameFits(frame_);
  StageTimes times;
  times.input = clock.lap();
  const polyfly::ControlReport& report = flight_.onOdometry(state, frame_fits);
  times.step = clock.lap();
  if (flight_.sends()) output_.publish(report.command, message->header, yawOf(state));
  times.output = clock.lap();

  // The command is out. What follows is for the next one, and for those who watch.
  finish(report, message->header, times);
  interface_.observe(message->header, state);
  exchangeLaws();
  laws().prepare();
  output_.prepare();
  last_prepare_ = times.prepare = clock.lap();
  record_.latency.record(times.latency());
  record_.step.record(times.step);
  if (times.whole() > static_cast<std::int64_t>(1e9 * control_period_)) ++record_.overruns;
}

void ExplicitMpcNode::exchangeLaws() {
  if (!keeper_.exchange()) return;
  flight_.setLaw(laws(), keeper_.laws().options());
  interface_.setMass(keeper_.laws().options().mass);
}

void ExplicitMpcNode::countLost(const ros::Time& stamp) {
  const double periods = (stamp - last_stamp_).toSec() / control_period_;
  // Half a period late is jitter; a long gap is silence, or another flight.
  if (!last_stamp_.isZero() && periods > 1.5 && periods < kLongGap) record_.lost += std::lround(periods) - 1;
  last_stamp_ = stamp;
}

void ExplicitMpcNode::leaveSnapshot(const polyfly::ControlReport& report, const std_msgs::Header& header,
                                    const StageTimes& times) {
  if (!record_.wanted.exchange(false)) return;
  FlightSnapshot& snapshot = record_.latest.draft();
  snapshot.header = header;
  snapshot.law = laws().active();
  snapshot.report = report;
  snapshot.kkt_residual = laws().kktResidual();
  snapshot.odometry_age = odometry_age_;
  snapshot.times = times;
  const bool tracks = report.status <= polyfly::ControlStatus::kHoldLast;
  const bool shows = record_.show_paths.load(std::memory_order_relaxed);
  snapshot.reference_count = !tracks ? 0 : shows ? laws().previewLength() : 1;
  const std::vector<polyfly::Reference>& reference =
      snapshot.reference_count > 1 ? flight_.wholePreview() : flight_.preview();
  std::copy_n(reference.begin(), snapshot.reference_count, snapshot.reference.begin());
  const bool same_stages = laws().stagePeriod() == laws().previewPeriod();
  snapshot.predicted_count =
      shows && tracks && same_stages
          ? laws().predict(snapshot.reference.data(), snapshot.reference_count, snapshot.predicted.data())
          : 0;
  record_.latest.publish();
}

bool ExplicitMpcNode::onSelectLaw(online_controller::SelectLaw::Request& request,
                                  online_controller::SelectLaw::Response& response) {
  try {
    response.success = static_cast<unsigned char>(laws().select(polyfly::lawOfName(request.law)));
    response.message = (response.success != 0 ? "" : request.law + " is not loaded; ") +
                       std::string(polyfly::lawName(laws().active())) + " flies";
  } catch (const polyfly::Error& error) {
    response.success = 0;
    response.message = error.what();
  }
  publishLaw();
  return true;
}

void ExplicitMpcNode::publishLaw() {
  std_msgs::String message;
  message.data = polyfly::lawName(laws().active());
  law_publisher_.publish(message);
}

void ExplicitMpcNode::onManual(const ros::Time& now) {
  std_msgs::Header header;
  header.stamp = now;
  header.frame_id = frame_;
  output_.publish(flight_.report().command, header, kNan);
  finish(flight_.report(), header, StageTimes{});
}

void ExplicitMpcNode::onWatchdog() {
  const ros::Time now = ros::Time::now();
  flight_.onTime(now.toSec());
  interface_.publishChange();
  if (!has_odometry_) {
    exchangeLaws();
    return;
  }
  if (now < arrival_) arrival_ = now;  // simulated time began anew
  if (now - arrival_ <= silence_) return;
  exchangeLaws();  // nothing is prepared in silence
  StageClock clock;
  StageTimes times;
  const polyfly::ControlReport& report = flight_.onSilence(now.toSec());
  times.step = clock.lap();
  std_msgs::Header header;
  header.stamp = now;
  header.frame_id = frame_;
  odometry_age_ = (now - arrival_).toSec();
  if (flight_.sends()) output_.publish(report.command, header, kNan);
  times.output = clock.lap();
  finish(report, header, times);
}

void ExplicitMpcNode::finish(const polyfly::ControlReport& report, const std_msgs::Header& header,
                             const StageTimes& times) {
  if (status_publisher_.getNumSubscribers() > 0) publishStatus(report, header, times);
  ++sequence_;
  leaveSnapshot(report, header, times);
  interface_.publishChange();
  logChange(report);
}

void ExplicitMpcNode::publishStatus(const polyfly::ControlReport& report, const std_msgs::Header& header,
                                    const StageTimes& times) {
  const auto status = boost::make_shared<online_controller::ControllerStatus>();
  status->header = header;
  status->sequence = sequence_;
  status->law = polyfly::lawName(laws().active());
  status->iterations = report.iterations;
  status->kkt_residual = laws().kktResidual();
  status->odometry_age = odometry_age_;
  status->input_time_ns = times.input;
  status->step_time_ns = times.step;
  status->output_time_ns = times.output;
  status->prepare_time_ns = last_prepare_;
  status->lookup_time_ns = lookupTime(report);
  fillStatus(report, keeper_.laws().parameters(laws().active()), *status);
  status_publisher_.publish(status);
}

std::int64_t ExplicitMpcNode::lookupTime(const polyfly::ControlReport& report) {
  const std::vector<polyfly::RegionMap>& maps = keeper_.laws().maps(laws().active());
  if (maps.empty()) return 0;
  for (const polyfly::AxisReport& axis : report.axis) {
    if (axis.size == 0) return 0;
  }
  double input = 0.0;
  StageClock clock;
  for (std::size_t i = 0; i < maps.size(); ++i) maps[i].evaluate(report.axis[i].theta.data(), &input);
  return clock.lap() / static_cast<std::int64_t>(maps.size());
}

void ExplicitMpcNode::logChange(const polyfly::ControlReport& report) {
  if (report.status == logged_status_ && report.reason == logged_reason_) return;
  logged_status_ = report.status;
  logged_reason_ = report.reason;
  const std::string text = describe(report, keeper_.laws().parameters(laws().active()));
  if (report.status == polyfly::ControlStatus::kOptimal) {
    ROS_INFO_THROTTLE(kLogInterval, "explicit MPC: %s", text.c_str());
  } else {
    ROS_WARN_THROTTLE(kLogInterval, "explicit MPC: %s", text.c_str());
  }
}

}  // namespace polyfly_ros
