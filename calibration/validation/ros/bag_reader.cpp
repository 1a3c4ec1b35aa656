#include "validation_ros/bag_reader.hpp"

#include <geometry_msgs/Vector3Stamped.h>
#include <ros/exception.h>
#include <ros/serialization.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "bags/message_layout.hpp"
#include "bags/scan_bag.hpp"
#include "online_controller_ros/conversions.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"

namespace polyfly_ros {
namespace {

using polyfly::endsWith;
using polyfly::Error;
using polyfly::FlightLog;

template <class Message>
std::string typeOf() {
  return ros::message_traits::DataType<Message>::value();
}

// The namespace in which the bag's only vehicle lives, with slashes on both sides.
std::string findNamespace(const std::string& path, const std::map<std::string, std::string>& types,
                          const std::string& command) {
  std::vector<std::string> found;
  for (const auto& [topic, type] : types) {
    if (type == typeOf<mav_msgs::RollPitchYawrateThrust>() && endsWith(topic, "/" + command)) {
      found.push_back(topic.substr(0, topic.size() - command.size()));
    }
  }
  if (found.size() > 1) {
    std::string names;
    for (const std::string& name : found) names += " " + name;
    throw Error(path + ": holds commands of several vehicles, in the namespaces" + names +
                ": choose one with --namespace");
  }
  return found.empty() ? "/" : found.front();
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
    if (message.status > online_controller::ControllerStatus::NO_REFERENCE ||
        message.reason > online_controller::ControllerStatus::REASON_NO_REFERENCE) {
      throw Error("status or reason is none of those that the message defines");
    }
    FlightLog::Status status;
    status.stamp = message.header.stamp.toSec();
    status.status = static_cast<polyfly::ControlStatus>(message.status);
    status.reason = static_cast<polyfly::ControlReason>(message.reason);
    status.region = {message.longitudinal.region, message.lateral.region, message.vertical.region};
    status.theta = {message.longitudinal.theta, message.lateral.theta, message.vertical.theta};
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

  FlightLog finish() {
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

  // The first reference came between the last step without one and the first step with one.
  void placeFirstReference() {
    // Whether a step had a reference, by the stamp of its odometry.
    std::map<double, bool> tracked;
    for (const FlightLog::Status& status : log_.statuses) {
      if (status.reason != polyfly::ControlReason::kStale) {
        tracked[status.stamp] = status.status != polyfly::ControlStatus::kNoReference;
      }
    }
    std::vector<Event>& events = log_.events;
    const auto first = std::find_if(events.begin(), events.end(),
                                    [](const Event& event) { return event.kind == Kind::kReference; });
    const auto place = std::find_if(events.begin(), events.end(), [&](const Event& event) {
      if (event.kind != Kind::kOdometry) return false;
      const auto found = tracked.find(log_.odometry[event.index].stamp);
      return found != tracked.end() && found->second;
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

// A message as it stands in the bag, until all of them can be put in order.
struct HeldMessage {
  std::string topic;
  // Receive time of the recorder [s].
  double time = 0.0;
  std::vector<std::uint8_t> bytes;
};

class BagReader {
 public:
  BagReader(const std::string& path, const BagTopics& topics, const BagProgress& progress,
            const BagQuestion& ask)
      : path_(path), topics_(topics), ask_(ask), builder_(path) {
    scan(progress);
    if (types_.empty()) throw Error(path_ + ": holds no message" + remarks());
    findPrefix();
    if (!askForTopics()) return;
    // The second scan holds the messages of the topics that were named now.
    held_.clear();
    scan(progress);
    findPrefix();
  }

  FlightLog read() {
    require<nav_msgs::Odometry>(topics_.odometry, "--odometry");
    require<mav_msgs::RollPitchYawrateThrust>(topics_.command, "--command");
    const bool has_trajectory = use<trajectory_msgs::MultiDOFJointTrajectory>(topics_.trajectory);
    const bool has_pose = use<geometry_msgs::PoseStamped>(topics_.pose);
    if (!has_trajectory && !has_pose) {
      missing(fullName(topics_.trajectory) + " nor on " + fullName(topics_.pose));
    }
    use<online_controller::ControllerStatus>(topics_.status);
    use<geometry_msgs::Vector3Stamped>(topics_.disturbance);
    use<std_msgs::String>(parametersTopic());
    readMessages();
    const auto clocks = builder_.clocks(fullName(topics_.odometry), fullName(topics_.command));
    FlightLog log = builder_.finish();
    check(log);
    log.clocks = clocks;
    log.share = share();
    log.remarks = health_.remarks;
    for (const auto& [topic, count] : misfits_) {
      log.remarks.push_back("topic " + topic + ": " + std::to_string(count) +
                            " messages are not what their definition says and were left out");
    }
    return log;
  }

 private:
  using Handler = std::function<void(const HeldMessage&)>;

  void findPrefix() {
    prefix_ = topics_.name_space.empty() ? findNamespace(path_, types_, topics_.command)
                                         : "/" + topics_.name_space + "/";
    while (prefix_.find("//") != std::string::npos) prefix_.erase(prefix_.find("//"), 1);
  }

  template <class Message>
  std::vector<std::string> topicsOf() const {
    std::vector<std::string> names;
    for (const auto& [name, type] : types_) {
      if (type == typeOf<Message>()) names.push_back(name);
    }
    return names;
  }

  // Whether a topic was named by somebody who was asked, in place of one that is not there.
  template <class Message>
  bool askFor(const char* what, std::string* topic) {
    const std::vector<std::string> choices = topicsOf<Message>();
    if (types_.count(fullName(*topic)) > 0 || choices.empty() || !ask_) return false;
    const auto answer =
        ask_(path_ + ": no message on " + fullName(*topic) + ". Which topic is the " + what + "?", choices);
    if (answer) *topic = choices[*answer];
    return answer.has_value();
  }

  bool askForTopics() {
    bool named = askFor<nav_msgs::Odometry>("odometry", &topics_.odometry);
    named = askFor<mav_msgs::RollPitchYawrateThrust>("command", &topics_.command) || named;
    if (types_.count(fullName(topics_.pose)) == 0) {
      named = askFor<trajectory_msgs::MultiDOFJointTrajectory>("reference", &topics_.trajectory) || named;
    }
    if (types_.count(fullName(topics_.trajectory)) == 0) {
      named = askFor<geometry_msgs::PoseStamped>("reference", &topics_.pose) || named;
    }
    return named;
  }

  // Holds the messages of all topics that may be wanted; the namespace is not known before the end.
  void scan(const BagProgress& progress) {
    polyfly::BagVisitor visitor;
    visitor.progress = progress;
    visitor.wants = [this](const polyfly::BagConnection& connection) {
      types_[connection.topic] = connection.type;
      definitions_[connection.topic].insert(connection.md5sum);
      const std::string* names[] = {&topics_.odometry,  &topics_.trajectory, &topics_.pose,
                                    &topics_.command,   &topics_.status,     &topics_.disturbance,
                                    &topics_.parameters};
      return std::any_of(std::begin(names), std::end(names),
                         [&](const std::string* name) { return endsWith("/" + connection.topic, *name); });
    };
    visitor.message = [this](const polyfly::BagMessage& message) {
      held_.push_back(
          {message.connection->topic, message.time(), {message.data, message.data + message.size}});
    };
    health_ = polyfly::scanBag(path_, visitor);
    std::stable_sort(held_.begin(), held_.end(),
                     [](const HeldMessage& one, const HeldMessage& other) { return one.time < other.time; });
  }

  // Of the topics that the flight consists of. Messages that do not fit their definition were not read.
  polyfly::RecordingShare share() const {
    std::set<std::string> topics;
    for (const auto& [topic, handler] : handlers_) topics.insert(topic);
    polyfly::RecordingShare share = polyfly::recordingShare(health_, topics);
    for (const auto& [topic, count] : misfits_) share.messages.read -= static_cast<double>(count);
    return share;
  }

  std::string remarks() const {
    std::string text;
    for (const std::string& remark : health_.remarks) text += "; " + remark;
    return text;
  }

  std::string fullName(const std::string& topic) const {
    return !topic.empty() && topic.front() == '/' ? topic : prefix_ + topic;
  }

  [[noreturn]] void missing(const std::string& topic, const std::string& hint = "") const {
    std::string known;
    for (const auto& [name, type] : types_) known += (known.empty() ? "" : ", ") + name;
    throw Error(path_ + ": no message on " + topic + "; the bag has " + known + hint + remarks());
  }

  // The topic lies in the private namespace of the controller, whose name is free. Of several nodes, which fly beside
  // the one, that on the uppermost level counts.
  std::string parametersTopic() const {
    std::string shortest;
    for (const std::string& name : topicsOf<std_msgs::String>()) {
      const bool fits = name.rfind(prefix_, 0) == 0 && endsWith(name, "/" + topics_.parameters);
      if (fits && (shortest.empty() || name.size() < shortest.size())) shortest = name;
    }
    return shortest.empty() ? fullName(topics_.parameters) : shortest;
  }

  // Whether the topic is in the bag; from then on its messages are read.
  template <class Message>
  bool use(const std::string& topic) {
    const std::string name = fullName(topic);
    const auto found = types_.find(name);
    if (found == types_.end()) return false;
    if (found->second != typeOf<Message>()) {
      throw Error(path_ + ": topic " + name + ": must be " + typeOf<Message>() + ", is " + found->second);
    }
    for (const std::string& md5sum : definitions_.at(name)) {
      if (md5sum != ros::message_traits::MD5Sum<Message>::value()) {
        throw Error(path_ + ": topic " + name + ": recorded with another definition of " + typeOf<Message>());
      }
    }
    // Lengths inside are checked before anything is made that they ask for.
    const auto layout = std::make_shared<polyfly::MessageLayout>(
        typeOf<Message>(), ros::message_traits::Definition<Message>::value());
    handlers_[name] = [this, name, layout](const HeldMessage& held) {
      if (!layout->fits(held.bytes.data(), held.bytes.size())) {
        ++misfits_[name];
        return;
      }
      Message message;
      // The stream reads only, through a pointer that is not const.
      ros::serialization::IStream stream(const_cast<std::uint8_t*>(held.bytes.data()),
                                         static_cast<std::uint32_t>(held.bytes.size()));
      ros::serialization::deserialize(stream, message);
      try {
        builder_.setTime(held.time);
        builder_.add(message);
      } catch (const Error& error) {
        throw Error(path_ + ": topic " + name + ": " + error.what());
      }
    };
    return true;
  }

  template <class Message>
  void require(const std::string& topic, const std::string& option) {
    if (use<Message>(topic)) return;
    std::string names;
    for (const std::string& name : topicsOf<Message>()) names += (names.empty() ? "" : ", ") + name;
    missing(fullName(topic),
            names.empty() ? "" : "; " + typeOf<Message>() + " is on " + names + ": choose with " + option);
  }

  void readMessages() {
    for (HeldMessage& held : held_) {
      const auto handler = handlers_.find(held.topic);
      if (handler != handlers_.end()) handler->second(held);
      held.bytes = {};
    }
  }

  void check(const FlightLog& log) const {
    if (log.odometry.empty()) missing(fullName(topics_.odometry));
    if (log.commands.empty()) missing(fullName(topics_.command));
    if (log.references.empty()) {
      throw Error(path_ + ": no usable reference" +
                  (builder_.refusedReferences() > 0 ? ", the last one: " + builder_.refusal() : "") +
                  remarks());
    }
  }

  std::string path_;
  BagTopics topics_;
  BagQuestion ask_;
  LogBuilder builder_;
  polyfly::BagHealth health_;
  std::map<std::string, std::string> types_;
  // Checksums by topic.
  std::map<std::string, std::set<std::string>> definitions_;
  std::vector<HeldMessage> held_;
  // Number of misfits by topic.
  std::map<std::string, std::size_t> misfits_;
  // Prefix of the topics in the vehicle's namespace, with slashes on both sides.
  std::string prefix_;
  std::map<std::string, Handler> handlers_;
};

}  // namespace

polyfly::FlightLog readBag(const std::string& path, const BagTopics& topics, const BagProgress& progress,
                           const BagQuestion& ask) {
  return BagReader(path, topics, progress, ask).read();
}

}  // namespace polyfly_ros
