#include "validation_ros/bag_reader.hpp"

#include <geometry_msgs/Vector3Stamped.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "online_controller_ros/conversions.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "validation_ros/topic_reader.hpp"

namespace polyfly_ros {
namespace {

using polyfly::Error;
using polyfly::FlightLog;

// Whether a law was asked for a command, or would have been had the sample been good.
bool hasReference(polyfly::ControlStatus status) {
  using polyfly::ControlStatus;
  return polyfly::isAnswer(status) || status == ControlStatus::kHoldLast || status == ControlStatus::kLevel ||
         status == ControlStatus::kDescend;
}

// Collects the log while messages come in the order of the record, then settles what that order leaves open:
// messages of different topics reach a recorder in another order than they reached the node. The node's own
// account tells more.
class LogBuilder {
 public:
  explicit LogBuilder(const std::string& path) { log_.source = path; }

  // When the recorder received what is added next [s].
  void setTime(double time) { time_ = time; }

  void add(const nav_msgs::Odometry& message) {
    log_.add(toVehicleState(message));
    times_.push_back(time_);
    odometry_times_.push_back(time_);
  }

  void add(const trajectory_msgs::MultiDOFJointTrajectory& message) {
    addReference([&message] { return std::make_pair(toReferenceTrajectory(message), startOf(message)); });
  }

  void add(const geometry_msgs::PoseStamped& message) {
    addReference(
        [&message] { return std::make_pair(toReferenceTrajectory(message), std::optional<double>()); });
  }

  void add(const mav_msgs::RollPitchYawrateThrust& message) {
    FlightLog::Command command;
    command.stamp = message.header.stamp.toSec();
    command.command = {message.roll, message.pitch, message.yaw_rate, message.thrust.z};
    log_.commands.push_back(command);
    command_times_.push_back(time_);
  }

  void add(const online_controller::ControllerStatus& message) {
    if (message.status >= polyfly::kControlStatusCount || message.reason >= polyfly::kControlReasonCount) {
      throw Error("status or reason is none of those that the message defines");
    }
    FlightLog::Status status;
    status.stamp = message.header.stamp.toSec();
    status.sequence = message.sequence;
    status.status = static_cast<polyfly::ControlStatus>(message.status);
    status.reason = static_cast<polyfly::ControlReason>(message.reason);
    status.region = {message.longitudinal.region, message.lateral.region, message.vertical.region};
    status.theta = {message.longitudinal.theta, message.lateral.theta, message.vertical.theta};
    status.input = {message.longitudinal.input, message.lateral.input, message.vertical.input};
    status.disturbance = {message.longitudinal.disturbance, message.lateral.disturbance,
                          message.vertical.disturbance};
    status.step_time = 1e-9 * static_cast<double>(message.step_time_ns);
    log_.statuses.push_back(std::move(status));
  }

  void add(const geometry_msgs::Vector3Stamped& message) {
    log_.disturbances.push_back(
        {message.header.stamp.toSec(), {message.vector.x, message.vector.y, message.vector.z}});
  }

  void add(const std_msgs::String& message) { log_.parameters.push_back({time_, message.data}); }

  // What the stamps of odometry and commands are worth; the topics are those they came on.
  std::vector<FlightLog::TopicClock> clocks(const std::string& odometry, const std::string& command) const {
    std::vector<double> of_odometry, of_commands;
    for (const polyfly::VehicleState& state : log_.odometry) of_odometry.push_back(state.stamp);
    for (const FlightLog::Command& sent : log_.commands) of_commands.push_back(sent.stamp);
    return {{odometry, polyfly::headerClock(of_odometry, odometry_times_), firstOf(odometry_times_)},
            {command, polyfly::headerClock(of_commands, command_times_), firstOf(command_times_)}};
  }

  // `lost` are the receive times of what is known to be lost [s].
  FlightLog finish(const std::vector<polyfly::TimeSpan>& lost) {
    placeLosses(lost);
    putReferencesFirst();
    placeFirstReference();
    placeSilences();
    return std::move(log_);
  }

  std::size_t refusedReferences() const { return refused_; }
  const std::string& refusal() const { return refusal_; }

 private:
  using Event = FlightLog::Event;
  using Kind = FlightLog::EventKind;

  static double firstOf(const std::vector<double>& times) { return times.empty() ? 0.0 : times.front(); }

  void placeLosses(const std::vector<polyfly::TimeSpan>& lost) {
    if (log_.odometry.empty()) return;
    const auto stampAt = [this](auto place) {
      return log_.odometry[static_cast<std::size_t>(place - odometry_times_.begin())].stamp;
    };
    for (const polyfly::TimeSpan& span : lost) {
      const auto next = std::upper_bound(odometry_times_.begin(), odometry_times_.end(), span.to);
      const auto before = std::lower_bound(odometry_times_.begin(), next, span.from);
      log_.lost.push_back({stampAt(before == odometry_times_.begin() ? before : before - 1),
                           stampAt(next == odometry_times_.end() ? next - 1 : next)});
    }
  }

  // In simulated time many messages bear one time; the node had the reference before it answered.
  void putReferencesFirst() {
    std::vector<std::size_t> order(log_.events.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [this](std::size_t one, std::size_t other) {
      const auto late = [this](std::size_t index) { return log_.events[index].kind != Kind::kReference; };
      return std::make_pair(times_[one], late(one)) < std::make_pair(times_[other], late(other));
    });
    std::vector<Event> sorted;
    sorted.reserve(order.size());
    for (const std::size_t index : order) sorted.push_back(log_.events[index]);
    log_.events = std::move(sorted);
  }

  // The first reference came between the last step without one and the first step with one. Not in a record that begins
  // in flight: the one of its begin is not in it.
  void placeFirstReference() {
    if (!log_.statuses.empty() && log_.statuses.front().sequence > 0 &&
        hasReference(log_.statuses.front().status))
      return;
    const auto steps = log_.statusesByStamp();
    std::vector<Event>& events = log_.events;
    const auto first = std::find_if(events.begin(), events.end(),
                                    [](const Event& event) { return event.kind == Kind::kReference; });
    const auto place = std::find_if(events.begin(), events.end(), [&](const Event& event) {
      if (event.kind != Kind::kOdometry) return false;
      const auto found = steps.find(log_.odometry[event.index].stamp);
      return found != steps.end() && hasReference(found->second->status);
    });
    if (first == events.end() || place == events.end()) return;
    if (place < first) {
      std::rotate(place, first, first + 1);
    } else {
      std::rotate(first, first + 1, place);
    }
  }

  // Silence was noticed after the odometry that the node answered before it.
  void placeSilences() {
    // Times of the silences, by the stamp of the odometry before them.
    std::map<double, std::vector<double>> silences;
    const FlightLog::Status* before = nullptr;
    for (const FlightLog::Status& status : log_.statuses) {
      if (status.reason != polyfly::ControlReason::kStale) {
        before = &status;
      } else if (before != nullptr) {
        silences[before->stamp].push_back(status.stamp);
      }
    }
    const std::vector<Event> heard = std::exchange(log_.events, {});
    for (const Event& event : heard) {
      log_.events.push_back(event);
      if (event.kind != Kind::kOdometry) continue;
      const auto after = silences.find(log_.odometry[event.index].stamp);
      if (after == silences.end()) continue;
      for (const double stamp : after->second) log_.addSilence(stamp);
      silences.erase(after);
    }
  }

  // The node keeps its reference when a new one breaks a rule, and so does the log.
  template <class Convert>
  void addReference(Convert convert) {
    try {
      auto [trajectory, start] = convert();
      log_.add(std::move(trajectory), start);
      times_.push_back(time_);
    } catch (const Error& error) {
      ++refused_;
      refusal_ = error.what();
    }
  }

  FlightLog log_;
  // Receive times of log_.events, of odometry and of commands [s].
  std::vector<double> times_;
  std::vector<double> odometry_times_;
  std::vector<double> command_times_;
  double time_ = 0.0;
  std::size_t refused_ = 0;
  std::string refusal_;
};

// One clause for all topics, since one recorder received them all. Empty where it was in time.
std::string latenessClause(const std::vector<FlightLog::TopicClock>& clocks) {
  double late = 0.0;
  for (const FlightLog::TopicClock& topic : clocks) late = std::max(late, topic.clock.late);
  if (late == 0.0) return "";
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "the recorder was late by up to %.2g s and caught up", late);
  return text.data();
}

class BagReader {
 public:
  BagReader(const std::vector<std::string>& paths, const BagTopics& topics, const BagProgress& progress)
      : path_(paths.front()), topics_(topics), reader_(paths), builder_(path_) {
    reader_.scan({topics_.odometry, topics_.trajectory, topics_.pose, topics_.command, topics_.status,
                  topics_.disturbance, topics_.parameters},
                 progress);
    reader_.findNamespace(topics_.name_space, topics_.command);
  }

  FlightLog read() {
    require<nav_msgs::Odometry>(topics_.odometry, "--odometry");
    require<mav_msgs::RollPitchYawrateThrust>(topics_.command, "--command");
    const bool has_trajectory = use<trajectory_msgs::MultiDOFJointTrajectory>(topics_.trajectory);
    const bool has_pose = use<geometry_msgs::PoseStamped>(topics_.pose);
    if (!has_trajectory && !has_pose) {
      reader_.missing(fullName(topics_.trajectory) + " nor on " + fullName(topics_.pose));
    }
    use<online_controller::ControllerStatus>(topics_.status);
    use<geometry_msgs::Vector3Stamped>(topics_.disturbance);
    use<std_msgs::String>(parametersTopic());
    reader_.read();
    const auto clocks = builder_.clocks(fullName(topics_.odometry), fullName(topics_.command));
    FlightLog log = builder_.finish(reader_.lost());
    check(log);
    log.clocks = clocks;
    log.share = reader_.share();
    log.remarks = reader_.remarks();
    const std::string lateness = latenessClause(clocks);
    if (!lateness.empty()) log.remarks.push_back(lateness);
    return log;
  }

 private:
  std::string fullName(const std::string& topic) const { return reader_.fullName(topic); }

  template <class Message>
  std::function<void(const Message&, double)> addToLog() {
    return [this](const Message& message, double time) {
      builder_.setTime(time);
      builder_.add(message);
    };
  }

  // The topic lies in the private namespace of the controller, whose name is free. Of several nodes, which fly beside
  // the one, that on the uppermost level counts.
  std::string parametersTopic() const {
    std::string shortest;
    for (const std::string& name : reader_.topicsOf<std_msgs::String>()) {
      const bool fits = reader_.isOfVehicle(name) && polyfly::endsWith(name, "/" + topics_.parameters);
      if (fits && (shortest.empty() || name.size() < shortest.size())) shortest = name;
    }
    return shortest.empty() ? fullName(topics_.parameters) : shortest;
  }

  template <class Message>
  bool use(const std::string& topic) {
    return reader_.use<Message>(fullName(topic), addToLog<Message>());
  }

  template <class Message>
  void require(const std::string& topic, const std::string& option) {
    reader_.require<Message>(fullName(topic), option, addToLog<Message>());
  }

  void check(const FlightLog& log) const {
    if (log.odometry.empty()) reader_.missing(fullName(topics_.odometry));
    if (log.commands.empty()) reader_.missing(fullName(topics_.command));
    if (log.references.empty()) {
      throw Error(path_ + ": no usable reference" +
                  (builder_.refusedReferences() > 0 ? ", the last one: " + builder_.refusal() : "") +
                  reader_.remarkText());
    }
  }

  std::string path_;
  BagTopics topics_;
  TopicReader reader_;
  LogBuilder builder_;
};

}  // namespace

polyfly::FlightLog readBag(const std::vector<std::string>& pieces, const BagTopics& topics,
                           const BagProgress& progress) {
  return BagReader(pieces, topics, progress).read();
}

std::vector<std::vector<std::string>> recordingsOf(const std::vector<std::string>& bags) {
  if (bags.size() == 1) return {bags};
  std::vector<polyfly::TimeSpan> times;
  for (const std::string& bag : bags) times.push_back(polyfly::timesOf(bag));
  std::vector<std::vector<std::string>> recordings;
  for (const std::vector<std::size_t>& pieces : polyfly::recordingsOf(times)) {
    recordings.emplace_back();
    for (const std::size_t piece : pieces) recordings.back().push_back(bags[piece]);
  }
  return recordings;
}

}  // namespace polyfly_ros
