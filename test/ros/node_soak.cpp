#include "node_soak.hpp"

#include <dynamic_reconfigure/Reconfigure.h>
#include <nav_msgs/Odometry.h>
#include <online_controller/SelectLaw.h>
#include <online_controller/SwapMaps.h>
#include <trajectory_msgs/MultiDOFJointTrajectory.h>

#include <boost/make_shared.hpp>
#include <chrono>
#include <set>
#include <utility>

#include "conversions.hpp"
#include "online_controller/laws/law_registry.hpp"

namespace polyfly_ros {
namespace {

using polyfly_test::SoakAnswer;
using polyfly_test::SoakTuning;
using Clock = std::chrono::steady_clock;

constexpr int kStalePeriods = 10;
// Wall time to wait for an answer.
constexpr auto kPatience = std::chrono::seconds(2);
// Simulated time at the plant's zero [s].
constexpr double kEpoch = 1000.0;
constexpr const char* kAxes[] = {"longitudinal", "lateral", "vertical"};

/// All numbers of some options, for dynamic_reconfigure.
struct Numbers {
  dynamic_reconfigure::Config config;
  std::set<std::string> fixed{"controller/control_period", "nonlinear/horizon", "nonlinear/period"};

  void operator()(const char* name, const double& value, const char*, const polyfly::Range&) {
    if (fixed.count(name) != 0) return;
    config.doubles.emplace_back();
    config.doubles.back().name = name;
    config.doubles.back().value = value;
  }
  void operator()(const char*, const int&, const char*, const polyfly::Range&) {}
  void operator()(const char*, const bool&) {}
};

online_controller::SwapMaps swapRequest(const std::string& folder, bool robust) {
  const std::string start = folder + (robust ? "/aslquad_" : "/multirotor_");
  online_controller::SwapMaps swap;
  swap.request.law = robust ? "robust_explicit" : "explicit_linear";
  swap.request.longitudinal = start + "longitudinal.map";
  swap.request.lateral = start + "lateral.map";
  swap.request.vertical = start + "vertical.map";
  return swap;
}

}  // namespace

ros::Time NodeSoak::toTime(double seconds) { return addSeconds(ros::Time(kEpoch), seconds); }

NodeSoak::NodeSoak(std::vector<std::string> maps, const SoakTuning& tuning)
    : maps_(std::move(maps)), in_force_(tuning.options), offered_(tuning.options) {
  ros::NodeHandle private_handle("~");
  for (const char* axis : kAxes) {
    private_handle.setParam(std::string("maps/") + axis, maps_.at(0) + "/multirotor_" + axis + ".map");
    private_handle.setParam(std::string("robust_maps/") + axis, maps_.at(0) + "/aslquad_" + axis + ".map");
  }
  private_handle.setParam("controller/robust_estimate_time", tuning.options.robust_estimate_time);
  private_handle.setParam("use_rc_teleop", false);
  private_handle.setParam("odometry_frame", "world");
  private_handle.setParam("controller/stale_periods", kStalePeriods);
  ros::Time::setNow(toTime(0.0));
  handle_.setCallbackQueue(&queue_);
  odometry_ = handle_.advertise<nav_msgs::Odometry>("odometry", 1);
  trajectory_ = handle_.advertise<trajectory_msgs::MultiDOFJointTrajectory>("command/trajectory", 1);
  node_ = std::make_unique<ControllerNode>(ros::NodeHandle(), private_handle);
  command_subscriber_ = handle_.subscribe<mav_msgs::RollPitchYawrateThrust>(
      "command/roll_pitch_yawrate_thrust", 10,
      [this](const mav_msgs::RollPitchYawrateThrust::ConstPtr& message) { command_ = message; });
  status_subscriber_ = handle_.subscribe<online_controller::ControllerStatus>(
      "controller_status", 10,
      [this](const online_controller::ControllerStatus::ConstPtr& message) { status_ = message; });
  reconfigure_ = private_handle.serviceClient<dynamic_reconfigure::Reconfigure>("set_parameters", true);
  reconfigure_.waitForExistence();
  select_ = handle_.serviceClient<online_controller::SelectLaw>("select_law");
  const auto connected = [this] {
    return odometry_.getNumSubscribers() > 0 && trajectory_.getNumSubscribers() > 0 &&
           command_subscriber_.getNumPublishers() > 0 && status_subscriber_.getNumPublishers() > 0;
  };
  while (ros::ok() && !connected()) ros::WallDuration(0.01).sleep();
}

bool NodeSoak::await(const ros::Time& stamp) {
  const Clock::time_point end = Clock::now() + kPatience;
  while (ros::ok() && Clock::now() < end) {
    queue_.callAvailable(ros::WallDuration(0.002));
    if (status_ && status_->header.stamp == stamp) return true;
  }
  ++unanswered_;
  return false;
}

SoakAnswer NodeSoak::answer(bool came) {
  SoakAnswer result;
  if (!came) return result;
  result.status = static_cast<polyfly::ControlStatus>(status_->status);
  result.limits = in_force_;
  result.sends = command_ && command_->header.stamp == status_->header.stamp;
  if (result.sends) result.command = fromCommand(*command_);
  return result;
}

SoakAnswer NodeSoak::onOdometry(const polyfly::VehicleState& state, bool frame_fits) {
  // The sample's own stamp may lie in the past; time goes on.
  ros::Time now = toTime(state.stamp);
  if (now > ros::Time::now()) ros::Time::setNow(now);
  const auto odometry = boost::make_shared<nav_msgs::Odometry>(
      toOdometry(state, now, frame_fits ? "world" : "map", "base_link"));
  command_.reset();
  status_.reset();
  odometry_.publish(odometry);
  const SoakAnswer result = answer(await(now));
  in_force_ = offered_;  // laws are exchanged when the command is out
  return result;
}

SoakAnswer NodeSoak::onSilence(double now, int periods) {
  command_.reset();
  status_.reset();
  ros::Time::setNow(toTime(now));
  // On the last one before, whether silence is noticed is a matter of rounding.
  if (periods <= kStalePeriods + 1) return {};
  in_force_ = offered_;  // exchanged before what is sent in silence
  return answer(await(toTime(now)));
}

void NodeSoak::setReference(const std::vector<polyfly::Reference>& points, double period, double start) {
  trajectory_.publish(boost::make_shared<trajectory_msgs::MultiDOFJointTrajectory>(
      toTrajectory(points, period, toTime(start), "world")));
}

void NodeSoak::reconfigure(const SoakTuning& tuning) {
  Numbers numbers;
  polyfly::visitOptions(tuning.options, numbers);
  polyfly::visitNonlinearOptions(tuning.nonlinear, numbers);
  polyfly::visitLinearTuning(tuning.linear, numbers);
  dynamic_reconfigure::Reconfigure change;
  change.request.config = numbers.config;
  if (!reconfigure_.call(change)) {
    failures_.push_back("set_parameters does not answer");
    return;
  }
  for (const auto& asked : numbers.config.doubles) {
    for (const auto& got : change.response.config.doubles) {
      if (got.name == asked.name && got.value != asked.value)
        failures_.push_back(asked.name + " was not taken");
    }
  }
  offered_ = tuning.options;
}

// It answers when the maps fly, which takes a sample: so it is called aside.
void NodeSoak::swapMaps(std::size_t set) {
  finishSwap();
  swaps_robust_ = !swaps_robust_;
  swap_ = std::async(std::launch::async, [this, folder = maps_.at(set), robust = swaps_robust_] {
    online_controller::SwapMaps swap = swapRequest(folder, robust);
    if (!ros::service::call(handle_.resolveName("swap_maps"), swap)) return std::string("no answer");
    return swap.response.success != 0 ? std::string() : swap.response.message;
  });
}

// A swap may be refused: where the maps answer differently at the present state, or the next has no answer.
void NodeSoak::finishSwap() {
  if (!swap_.valid()) return;
  const std::string refusal = swap_.get();
  if (refusal == "no answer") failures_.push_back("swap_maps: no answer");
  if (refusal.empty()) ++(swaps_robust_ ? swapped_robust_ : swapped_);
}

void NodeSoak::select(polyfly::Law law) {
  online_controller::SelectLaw request;
  request.request.law = polyfly::lawName(law);
  if (!select_.call(request) || request.response.success == 0)
    failures_.push_back("select_law: " + request.response.message);
}

}  // namespace polyfly_ros
