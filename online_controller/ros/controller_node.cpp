#include "online_controller_ros/controller_node.hpp"

#include <sched.h>
#include <std_msgs/String.h>
#include <unistd.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <utility>

#include "online_controller/types/option_groups.hpp"
#include "online_controller_ros/conversions.hpp"
#include "online_controller_ros/stage_clock.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

constexpr double kLongGap = 100.0;  // so many control periods without odometry are no loss of single ones
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A function as a callback.
class Task : public ros::CallbackInterface {
 public:
  explicit Task(std::function<void()> function) : function_(std::move(function)) {}
  CallResult call() override {
    function_();
    return Success;
  }

 private:
  std::function<void()> function_;
};

double seconds(polyfly::PollWindow::Clock::time_point time) noexcept {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

pid_t thisThread() noexcept {
  static thread_local const pid_t thread = gettid();
  return thread;
}

}  // namespace

ExplicitMpcNode::Setup ExplicitMpcNode::readSetup(const ros::NodeHandle& private_handle,
                                                  const ForeignNames& names, Household household) {
  Setup setup;
  setup.alone = household == Household::kAlone;
  ParameterReader reader(private_handle);
  setup.laws = LawSetup::read(reader);
  setup.flight = FlightSetup::read(reader);
  visitNodeOptions(setup.node, reader);
  setup.output = OutputOptions::read(reader);
  visitRealTimeOptions(setup.real_time, reader);
  setup.in_publisher = answersInPublisher(
      reader.text("real_time/answer", "auto, publisher or thread", "auto"), setup.real_time);
  setup.real_time.rehearse = rehearsalLead(setup.real_time, setup.in_publisher);
  setup.laws.understudies = setup.real_time.rehearse > 0.0;
  std::vector<std::string> groups(polyfly::kOptionGroups.begin(), polyfly::kOptionGroups.end());
  groups.erase(std::find(groups.begin(), groups.end(), polyfly::kSharedGroup));
  reader.refuseUnknown(groups);
  if (names.empty()) {  // else the adoption has told
    for (const std::string& name : reader.unread())
      ROS_WARN("MPC does not know the parameter %s", name.c_str());
  }
  return setup;
}

ExplicitMpcNode::ExplicitMpcNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                 const ForeignNames& names, Household household) try
    : ExplicitMpcNode(handle, private_handle, names, readSetup(private_handle, names, household)) {
} catch (const std::exception& error) {
  ROS_FATAL("MPC does not start: %s", error.what());
  throw;
}

ExplicitMpcNode::ExplicitMpcNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                 const ForeignNames& names, const Setup& setup)
    : at_once_(baton_, queue_, boost::make_shared<Task>([this] { onFollowUp(); })),
      handle_(onQueue(handle, queue_)),
      keeper_(setup.laws),
      time_(ros::Time::isSimTime()),
      flight_(laws(), setup.laws.controller, setup.flight.flight, setup.flight.pilot),
      interface_(handle_, onQueue(private_handle, queue_), flight_, time_, setup.flight, setup.laws),
      output_(handle_, setup.output, setup.laws.controller),
      record_(flight_.preview().size()),
      reporter_(handle_, keeper_, flight_, record_, setup.laws.controller.control_period),
      in_publisher_(setup.in_publisher),
      alone_(setup.alone),
      control_period_(setup.laws.controller.control_period),
      poll_(control_period_, setup.real_time.poll, setup.real_time.rehearse),
      follows_core_(in_publisher_ && setup.real_time.rehearse > 0.0 && setup.real_time.core < 0),
      follows_priority_(setup.real_time.priority < 0),
      silence_(setup.node.stale_periods * control_period_) {
  if (setup.real_time.rehearse > 0.0) {
    topics_.emplace(onQueue(private_handle, queue_),
                    [this](const nav_msgs::Odometry& like) { rehearseWith(like); });
    if (setup.real_time.poll == 0.0) vigil_.emplace();
  }
  connect();
  timer_thread_.emplace(timer_queue_, "mpc_timer", std::function<void()>());
  background_.emplace(handle, private_handle, setup.laws, names, keeper_, record_);
  const auto begin = [real_time = setup.real_time] {
    const std::string refused = becomeRealTime(real_time);
    if (!refused.empty()) ROS_WARN("MPC: %s", refused.c_str());
  };
  control_thread_.emplace(
      queue_, "mpc_control", begin, [this](double most) { return sleep(most); }, &baton_);
}

// Between two callbacks of the control thread.
double ExplicitMpcNode::sleep(double most) {
  const auto now = polyfly::PollWindow::Clock::now();
  if (poll_.rehearses(now) && baton_.tryTake()) {
    rehearse();
    baton_.give();
  }
  return poll_.sleep(now, most);
}

void ExplicitMpcNode::connect() {
  law_publisher_ = handle_.advertise<std_msgs::String>("active_law", 1, true);
  publishLaw();
  law_service_ = handle_.advertiseService("select_law", &ExplicitMpcNode::onSelectLaw, this);
  interface_.onManual([this](const ros::Time& now) { onManual(now); });
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const OdometryEvent&>(
      "odometry", 1, [this](const OdometryEvent& event) { onOdometry(event); });
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  if (in_publisher_) options.callback_queue = &at_once_;
  odometry_subscriber_ = handle_.subscribe(options);
  startWatchdog();
}

// A timer of ROS time never fires where its clock is dead.
void ExplicitMpcNode::startWatchdog() {
  const auto task = [this](std::atomic<bool>& waits, void (ExplicitMpcNode::*function)()) {
    return boost::make_shared<Task>([this, &waits, function] {
      waits = false;
      (this->*function)();
    });
  };
  const auto post = [this](const ros::CallbackInterfacePtr& what, std::atomic<bool>& waits) {
    if (!waits.exchange(true)) queue_.addCallback(what, reinterpret_cast<std::uint64_t>(this));
  };
  watchdog_task_ = task(watchdog_waits_, &ExplicitMpcNode::onWatchdog);
  wall_time_task_ = task(wall_time_waits_, &ExplicitMpcNode::onWallTime);
  ros::NodeHandle timers = onQueue(handle_, timer_queue_);
  watchdog_ = timers.createTimer(ros::Duration(control_period_), [this, post](const ros::TimerEvent&) {
    post(watchdog_task_, watchdog_waits_);
  });
  if (!ros::Time::isSimTime()) return;
  wall_watchdog_ = timers.createSteadyTimer(
      ros::WallDuration(control_period_),
      [this, post](const ros::SteadyTimerEvent&) { post(wall_time_task_, wall_time_waits_); });
}

void ExplicitMpcNode::onOdometry(const OdometryEvent& event) {
  const bool in_publisher = at_once_.runsHere();
  const bool fit = left_ == nullptr && (alone_ || published_here_(event.getConnectionHeaderPtr()));
  if (in_publisher && !fit) {
    left_ = event.getConstMessage();
    return;  // the follow-up comes in any case
  }
  answer(*event.getConstMessage());
  if (!in_publisher) finish();
}

void ExplicitMpcNode::onFollowUp() {
  if (left_ != nullptr) answer(*std::exchange(left_, nullptr));
  finish();
}

void ExplicitMpcNode::answer(const nav_msgs::Odometry& message) {
  StageClock clock;
  served_at_ = arrivalOfThis();
  if (at_once_.runsHere()) {
    publisher_ = {thisThread(), sched_getcpu()};
  } else if (in_publisher_) {
    poll_.disturbed();
  }
  arrival_ = ros::Time::now();
  // /clock is handled on another thread: simulated time may still stand before the odometry that came with it
  time_.onOdometry(arrival_.toSec(), seconds(served_at_), message.header.stamp.toSec());
  if (ros::Time::isSimTime()) arrival_ = std::max(arrival_, message.header.stamp);
  has_odometry_ = true;
  frame_ = message.header.frame_id;
  odometry_age_ = (arrival_ - message.header.stamp).toSec();
  countLost(message.header.stamp);
  const polyfly::VehicleState state = toVehicleState(message);
  const bool frame_fits = interface_.frameFits(frame_);
  StageTimes times;
  times.input = clock.lap();
  const polyfly::ControlReport& report = flight_.onOdometry(state, frame_fits);
  times.step = clock.lap();
  // A yaw that was refused must not reach the autopilot either: then the last one stays.
  const bool accepted = flight_.lastRefusal() == polyfly::ControlReason::kNone;
  if (flight_.sends()) output_.publish(report.command, message.header, accepted ? yawOf(state) : kNan);
  times.output = clock.lap();

  Answered& answered = remember(report, message.header, times);
  answered.by_odometry = true;
  answered.state = state;
  answered.accepted = accepted;
  answered.restarted = flight_.restarted();
}

// Rehearsals are timed by it. What had to wait for one came before it is answered; taken for its arrival, its
// answer would have the next rehearsal as late, and in the way again.
polyfly::PollWindow::Clock::time_point ExplicitMpcNode::arrivalOfThis() {
  const auto left = at_once_.runsHere() ? DirectQueue::kNever : at_once_.takeLeft();
  if (left == DirectQueue::kNever) return polyfly::PollWindow::Clock::now();
  ++record_.waited;
  return left;
}

Answered& ExplicitMpcNode::remember(const polyfly::ControlReport& report, const std_msgs::Header& header,
                                    const StageTimes& times) {
  Answered& answered = answered_.add();
  answered.header = header;
  answered.law = laws().active();
  answered.report = report;
  answered.sends = flight_.sends();
  if (answered.sends)
    record_.commands.store(report.status != polyfly::ControlStatus::kMotorsOff, std::memory_order_relaxed);
  answered.times = times;
  answered.odometry_age = odometry_age_;
  answered.sequence = sequence_++;
  answered.by_odometry = false;
  return answered;
}

// In the control thread. The command is out; this is for the next one, and for those who watch.
void ExplicitMpcNode::finish() {
  if (answered_.size() == 0) return;
  if (vigil_) vigil_->end();
  StageClock clock;
  const Answered& last = *(answered_.end() - 1);
  for (const Answered& answered : answered_) {
    reporter_.tell(answered, &answered == &last);
    if (answered.by_odometry) interface_.observe(answered);
  }
  interface_.publishChange();
  if (last.by_odometry) {
    exchangeLaws();
    poll_.served(served_at_);
    prepare();
    reporter_.prepared(last, clock.lap());
    followPublisher();
  }
  answered_.clear();
}

void ExplicitMpcNode::prepare() {
  polyfly::LawSwitch* const understudy = keeper_.laws().understudy();
  if (understudy != nullptr && poll_.awaitsRehearsal()) {
    understudy->takeOver(laws());
    understudy->prepare();
  }
  laws().prepare();
  output_.prepare();
}

// A rehearsal serves the processor on which it is done, and who holds a lock that the publisher may wait for
// must not be kept from giving it back.
void ExplicitMpcNode::followPublisher() {
  const int core = follows_core_ && poll_.awaitsRehearsal() ? publisher_.core : -1;
  if (core != core_) {
    core_ = core;
    const std::string refused = runOn(core);
    if (!refused.empty()) ROS_WARN_ONCE("MPC: rehearsals may serve another processor: %s", refused.c_str());
  }
  if (follows_priority_ && publisher_.thread != followed_) {
    followed_ = publisher_.thread;
    std::string refused = runBelow(publisher_.thread, 1, pthread_self());
    if (refused.empty()) refused = background_->runBelow(publisher_.thread, 2);
    if (!refused.empty())
      ROS_WARN_ONCE("MPC: has no priority beside who publishes odometry: %s", refused.c_str());
  }
}

// With the baton: what the next answer will do, changing nothing that has not been told of.
void ExplicitMpcNode::rehearse() {
  if (answered_.size() > 0 || left_ != nullptr) return;
  if (topics_) {
    topics_->publish(arrival_, frame_);
  } else {
    flight_.rehearse(nullptr);
  }
  if (vigil_) vigil_->keep(sched_getcpu(), poll_.expects());
}

void ExplicitMpcNode::rehearseWith(const nav_msgs::Odometry& like) {
  static_cast<void>(toVehicleState(like));
  flight_.rehearse(keeper_.laws().understudy());
  topics_->answer(flight_.report().command, like.header);
  output_.rehearse(flight_.report().command, like.header);
}

void ExplicitMpcNode::exchangeLaws() {
  if (!keeper_.exchange()) return;
  flight_.setLaw(laws(), keeper_.laws().options());
  interface_.setObserver(keeper_.laws().observer());
}

void ExplicitMpcNode::countLost(const ros::Time& stamp) {
  const double periods = (stamp - last_stamp_).toSec() / control_period_;
  // Half a period late is jitter; a long gap is silence, or another flight.
  if (!last_stamp_.isZero() && periods > 1.5 && periods < kLongGap) record_.lost += std::lround(periods) - 1;
  last_stamp_ = stamp;
}

bool ExplicitMpcNode::onSelectLaw(online_controller::SelectLaw::Request& request,
                                  online_controller::SelectLaw::Response& response) {
  finish();
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
  remember(flight_.report(), header, StageTimes{});
  finish();
}

void ExplicitMpcNode::onWallTime() {
  time_.advance(ros::Time::now().toSec(), seconds(polyfly::PollWindow::Clock::now()));
  tellOfClock();
  if (time_.byWall()) onWatchdog();
}

void ExplicitMpcNode::tellOfClock() {
  if (time_.byWall() == told_of_wall_time_) return;
  told_of_wall_time_ = time_.byWall();
  if (told_of_wall_time_) {
    ROS_WARN(
        "MPC: odometry comes, but simulated time stands still: wall time decides when odometry is silent. "
        "Does anybody publish /clock, as /use_sim_time asks for?");
  } else {
    ROS_WARN("MPC: simulated time runs again, and decides when odometry is silent");
  }
}

void ExplicitMpcNode::onWatchdog() {
  ros::Time now = ros::Time::now();
  time_.advance(now.toSec(), seconds(polyfly::PollWindow::Clock::now()));
  flight_.onTime(now.toSec() + time_.ahead());
  interface_.publishChange();
  if (!has_odometry_) {
    exchangeLaws();
    return;
  }
  if (time_.silence() <= silence_) return;
  finish();
  exchangeLaws();  // nothing is prepared in silence
  // Stamps go on from those of the odometry.
  if (time_.byWall()) now = arrival_ + ros::Duration(time_.silence());
  StageClock clock;
  StageTimes times;
  const polyfly::ControlReport& report = flight_.onSilence(now.toSec());
  times.step = clock.lap();
  std_msgs::Header header;
  header.stamp = now;
  header.frame_id = frame_;
  odometry_age_ = time_.silence();
  if (flight_.sends()) output_.publish(report.command, header, kNan);
  times.output = clock.lap();
  remember(report, header, times);
  finish();
}

}  // namespace polyfly_ros
