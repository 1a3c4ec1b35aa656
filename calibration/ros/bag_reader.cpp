#include "calibration_ros/bag_reader.hpp"

#include <geometry_msgs/Vector3Stamped.h>
#include <ros/exception.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "online_controller_ros/conversions.hpp"
#include "region_maps/error.hpp"

namespace polyfly_ros {
namespace {

using polyfly::Error;
using polyfly::FlightLog;

template <class Message>
std::string typeOf() {
  return ros::message_traits::DataType<Message>::value();
}

void openBag(const std::string& path, rosbag::Bag* bag) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure)) throw Error(path + ": no such file");
  if (!std::filesystem::is_regular_file(path, failure)) throw Error(path + ": not a file");
  if (std::filesystem::file_size(path, failure) == 0) throw Error(path + ": is empty (0 bytes), not a bag");
  try {
    bag->open(path, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw Error(path +
                ": has no index, because its recording was cut off; `rosbag reindex` keeps what was written");
  } catch (const rosbag::BagIOException& error) {
    throw Error(path + ": cannot be read as a bag: " + error.what() +
                "; if its recording was cut off, `rosbag reindex` keeps what was written");
  } catch (const std::exception& error) {
    throw Error(path + ": cannot be read as a bag: " + error.what());
  }
}

std::map<std::string, std::string> typesByTopic(const rosbag::Bag& bag) {
  std::map<std::string, std::string> types;
  for (const rosbag::ConnectionInfo* connection : rosbag::View(bag).getConnections()) {
    types[connection->topic] = connection->datatype;
  }
  return types;
}

bool endsWith(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
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
    throw Error(path + ": holds commands of several vehicles, in the namespaces" + names + ": choose one");
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
    std::map<double, bool> tracked;  // by the stamp of the odometry
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
    std::map<double, std::vector<double>> silences;  // by the stamp of the odometry before
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
  std::vector<double> times_;  // of log_.events, as received
  double time_ = 0.0;
  std::size_t refused_ = 0;
  std::string refusal_;
};

class BagReader {
 public:
  BagReader(const std::string& path, const BagTopics& topics) : path_(path), topics_(topics), builder_(path) {
    openBag(path_, &bag_);
    types_ = typesByTopic(bag_);
    if (types_.empty()) throw Error(path_ + ": holds no message");
    prefix_ = topics.name_space.empty() ? findNamespace(path_, types_, topics.command)
                                        : "/" + topics.name_space + "/";
    while (prefix_.find("//") != std::string::npos) prefix_.erase(prefix_.find("//"), 1);
  }

  FlightLog read() {
    require<nav_msgs::Odometry>(topics_.odometry);
    require<mav_msgs::RollPitchYawrateThrust>(topics_.command);
    const bool has_trajectory = use<trajectory_msgs::MultiDOFJointTrajectory>(topics_.trajectory);
    const bool has_pose = use<geometry_msgs::PoseStamped>(topics_.pose);
    if (!has_trajectory && !has_pose) {
      missing(fullName(topics_.trajectory) + " nor on " + fullName(topics_.pose));
    }
    use<online_controller::ControllerStatus>(topics_.status);
    use<geometry_msgs::Vector3Stamped>(topics_.disturbance);
    readMessages();
    FlightLog log = builder_.finish();
    check(log);
    return log;
  }

 private:
  using Handler = std::function<void(const rosbag::MessageInstance&)>;

  std::string fullName(const std::string& topic) const {
    return !topic.empty() && topic.front() == '/' ? topic : prefix_ + topic;
  }

  [[noreturn]] void missing(const std::string& topic) const {
    std::string known;
    for (const auto& [name, type] : types_) known += (known.empty() ? "" : ", ") + name;
    throw Error(path_ + ": no message on " + topic + "; the bag has " + known);
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
    handlers_[name] = [this, name](const rosbag::MessageInstance& instance) {
      const auto message = instance.instantiate<Message>();
      if (!message) {
        throw Error(path_ + ": topic " + name + ": recorded with another definition of " + typeOf<Message>());
      }
      try {
        builder_.setTime(instance.getTime().toSec());
        builder_.add(*message);
      } catch (const Error& error) {
        throw Error(path_ + ": topic " + name + ": " + error.what());
      }
    };
    return true;
  }

  template <class Message>
  void require(const std::string& topic) {
    if (!use<Message>(topic)) missing(fullName(topic));
  }

  void readMessages() {
    std::vector<std::string> names;
    for (const auto& [name, handler] : handlers_) names.push_back(name);
    try {
      for (const rosbag::MessageInstance& instance : rosbag::View(bag_, rosbag::TopicQuery(names))) {
        handlers_.at(instance.getTopic())(instance);
      }
    } catch (const Error&) {
      throw;
    } catch (const std::exception& error) {
      throw Error(path_ + ": is damaged: " + error.what());
    }
  }

  void check(const FlightLog& log) const {
    if (log.odometry.empty()) missing(fullName(topics_.odometry));
    if (log.commands.empty()) missing(fullName(topics_.command));
    if (log.references.empty()) {
      throw Error(path_ + ": no usable reference" +
                  (builder_.refusedReferences() > 0 ? ", the last one: " + builder_.refusal() : ""));
    }
  }

  std::string path_;
  BagTopics topics_;
  LogBuilder builder_;
  rosbag::Bag bag_;
  std::map<std::string, std::string> types_;
  std::string prefix_;  // of topics in the vehicle's namespace, with slashes on both sides
  std::map<std::string, Handler> handlers_;
};

}  // namespace

polyfly::FlightLog readBag(const std::string& path, const BagTopics& topics) {
  return BagReader(path, topics).read();
}

polyfly::FlightLog readBagGuarded(const std::string& path, const BagTopics& topics) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      readBag(path, topics);
    } catch (...) {
      // The parent meets the same error and tells it.
    }
    _exit(0);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child) throw Error(path + ": no process to try it in");
  if (WIFSIGNALED(status)) {
    throw Error(path + ": is damaged: rosbag crashes on it (" + strsignal(WTERMSIG(status)) + ")");
  }
  return readBag(path, topics);
}

}  // namespace polyfly_ros
