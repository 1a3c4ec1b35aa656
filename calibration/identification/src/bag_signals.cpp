#include "identification/bag_signals.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <sstream>

#include "bags/recording_share.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "sentence.hpp"
#include "topic_signals.hpp"

namespace polyfly {
namespace {

// What a type of message can tell. A lower rank wins where two types tell the same signal.
struct KnownType {
  const char* type;
  // Must be in the name of the topic, if not empty.
  const char* topic;
  int rank;
  // SIGNAL=FIELD, separated by blanks, as fieldUse reads it.
  const char* uses;
};

constexpr KnownType kKnownTypes[] = {
    {"mav_msgs/RollPitchYawrateThrust", "", 0,
     "roll_cmd=roll pitch_cmd=pitch yaw_rate_cmd=yaw_rate thrust_cmd=thrust.z"},
    {"mavros_msgs/AttitudeTarget", "", 1,
     "roll_cmd=orientation.roll pitch_cmd=orientation.pitch yaw_rate_cmd=body_rate.z thrust_cmd=thrust"},
    {"geometry_msgs/PoseStamped", "attitude", 1,
     "roll_cmd=pose.orientation.roll pitch_cmd=pose.orientation.pitch"},
    {"std_msgs/Float64", "throttle", 1, "thrust_cmd=data"},
    {"std_msgs/Float64", "thrust", 1, "thrust_cmd=data"},
    {"nav_msgs/Odometry", "", 0,
     "roll=pose.pose.orientation.roll pitch=pose.pose.orientation.pitch yaw=pose.pose.orientation.yaw "
     "yaw_rate=twist.twist.angular.z vx=pose.pose.orientation*twist.twist.linear.x "
     "vy=pose.pose.orientation*twist.twist.linear.y vz=pose.pose.orientation*twist.twist.linear.z"},
    {"sensor_msgs/Imu", "", 1,
     "roll=orientation.roll pitch=orientation.pitch yaw=orientation.yaw yaw_rate=angular_velocity.z "
     "specific_force_z=linear_acceleration.z"},
    {"geometry_msgs/TransformStamped", "", 2,
     "roll=transform.rotation.roll pitch=transform.rotation.pitch yaw=transform.rotation.yaw"},
    {"geometry_msgs/PoseStamped", "pose", 3,
     "roll=pose.orientation.roll pitch=pose.orientation.pitch yaw=pose.orientation.yaw"},
    {"geometry_msgs/TwistStamped", "velocity_local", 1,
     "vx=twist.linear.x vy=twist.linear.y vz=twist.linear.z"}};

// Ranks of a place that the user chose, and what is added to that of a simulator's truth, which no controller saw.
constexpr int kChosenRank = -1;
constexpr int kTruthRank = 10;

// Whether messages of this type on this topic are what the list means.
bool isKnown(const KnownType& known, const BagConnection& connection) {
  const auto named = [&connection](const char* part) {
    return connection.topic.find(part) != std::string::npos;
  };
  // A pose that was asked for is not one that was measured.
  const bool asked = std::string(known.topic) == "pose" && (named("command") || named("setpoint"));
  return connection.type == known.type && named(known.topic) && !asked;
}

// `topic:path` of a signal.
struct Choice {
  std::string topic;
  FieldUse use;
};

Choice parseChoice(const std::string& signal, const std::string& text) {
  const ChosenPlace chosen = chosenPlace(signal, text);
  const std::string& place = chosen.place;
  const std::size_t colon = place.find(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == place.size()) {
    throw Error("--signal " + signal + "=" + text + ": must be SIGNAL=TOPIC:FIELD for a bag");
  }
  return {place.substr(0, colon), fieldUse(signal, place.substr(colon + 1), chosen.factor(), kChosenRank)};
}

// The namespace with a slash on both sides. Empty if none is given.
std::string prefixOf(const std::string& name_space) {
  const std::size_t first = name_space.find_first_not_of('/');
  if (first == std::string::npos) return {};
  return "/" + name_space.substr(first, name_space.find_last_not_of('/') - first + 1) + "/";
}

class Collector {
 public:
  Collector(const std::string& path, const BagSignalOptions& options)
      : path_(path), options_(options), prefix_(prefixOf(options.name_space)) {
    for (const auto& [signal, text] : options.choice) {
      choices_.push_back(parseChoice(signal, text));
      // As in validate_bag: a name without a leading slash is one of the namespace.
      std::string& topic = choices_.back().topic;
      if (!prefix_.empty() && topic.front() != '/') topic.insert(0, prefix_);
    }
  }

  BagSignals read() {
    BagVisitor visitor;
    visitor.progress = options_.progress;
    visitor.wants = [this](const BagConnection& connection) { return listen(connection); };
    visitor.message = [this](const BagMessage& message) {
      readers_.at(message.connection->topic).add(message);
    };
    BagSignals result;
    result.health = scanBag(path_, visitor);
    result.signals.source = path_;
    if (result.health.messages == 0) {
      const std::string why = listOf(result.health.remarks, "; ");
      throw Error(path_ + ": holds no message" + (why.empty() ? "" : "; " + why));
    }
    checkTopics();
    const std::set<std::string> used = gather(&result);
    const std::string loss = lossSentence(recordingShare(result.health, used));
    if (!loss.empty()) result.health.remarks.push_back(loss);
    const BagHealth& health = result.health;
    result.signals.lossy =
        !loss.empty() || !health.indexed || health.damaged_chunks > 0 || health.unread_bytes > 0;
    result.signals.places.assign(topics_.begin(), topics_.end());
    return result;
  }

 private:
  bool isInNamespace(const std::string& topic) const {
    return topic.compare(0, prefix_.size(), prefix_) == 0;
  }

  // Whether the options admit a topic as a source of signals that they do not place.
  bool isHeard(const std::string& topic) const {
    return isInNamespace(topic) &&
           (options_.topics.empty() ||
            std::any_of(options_.topics.begin(), options_.topics.end(),
                        [&topic](const std::string& ending) { return endsWith(topic, ending); }));
  }

  // Whether the bag has what the options name.
  void checkTopics() const {
    const std::string known = "; there are " + listOf(topics_);
    if (std::none_of(topics_.begin(), topics_.end(),
                     [this](const std::string& topic) { return isInNamespace(topic); }))
      throw Error(path_ + ": no topic in the namespace " + options_.name_space + known);
    for (const Choice& choice : choices_) {
      if (topics_.count(choice.topic) == 0) throw Error(path_ + ": no topic " + choice.topic + known);
    }
  }

  bool listen(const BagConnection& connection) {
    topics_.insert(connection.topic);
    // A second publisher of a topic brings messages of the same kind.
    const auto before = readers_.find(connection.topic);
    if (before != readers_.end()) return before->second.type() == connection.type;
    std::vector<FieldUse> uses;
    for (const Choice& choice : choices_) {
      if (choice.topic == connection.topic) uses.push_back(choice.use);
    }
    const auto known = std::find_if(std::begin(kKnownTypes), std::end(kKnownTypes),
                                    [&connection](const KnownType& one) { return isKnown(one, connection); });
    if (known != std::end(kKnownTypes) && isHeard(connection.topic)) {
      const bool truth = connection.topic.find("ground_truth") != std::string::npos;
      std::istringstream words(known->uses);
      for (std::string word; words >> word;) {
        const std::size_t equals = word.find('=');
        const std::string signal = word.substr(0, equals);
        if (options_.choice.count(signal) == 0)
          uses.push_back(
              fieldUse(signal, word.substr(equals + 1), 1.0, known->rank + (truth ? kTruthRank : 0)));
      }
    }
    if (uses.empty()) return false;
    try {
      readers_.try_emplace(connection.topic, connection, std::move(uses));
    } catch (const Error& error) {
      throw Error(path_ + ": " + error.what());
    }
    return true;
  }

  // Where a signal comes from; and another topic that could give it as well.
  struct Winner {
    std::string topic;
    std::size_t use = 0;
    int rank = 0;
    std::string other;
  };

  // The best source of each signal. Throws Error where there are two: only the user knows which.
  std::map<std::string, Winner> winners() const {
    std::map<std::string, Winner> best;
    for (const auto& [topic, reader] : readers_) {
      for (std::size_t i = 0; i < reader.uses().size() && !reader.isEmpty(); ++i) {
        const FieldUse& use = reader.uses()[i];
        const auto [found, is_new] = best.try_emplace(use.signal, Winner{topic, i, use.rank, ""});
        if (!is_new && use.rank == found->second.rank) found->second.other = topic;
        if (use.rank < found->second.rank) found->second = {topic, i, use.rank, ""};
      }
    }
    for (const auto& [signal, winner] : best) {
      if (!winner.other.empty())
        throw Error(path_ + ": " + signal + " could come from " + winner.topic + " or from " + winner.other +
                    ": choose with --namespace, with --topic, or with --signal " + signal + "=TOPIC:FIELD");
    }
    return best;
  }

  // Why the clock is used, and what that means for a delay. Empty where nothing is to be said.
  static std::string clauseOn(const HeaderClock& clock, SignalClock which, double greatest_lead) {
    if (which == SignalClock::kHeaders) return clock.steps.empty() ? "" : "the times of the headers are used";
    std::string clause = "the times of the recorder are used";
    if (clock.isSteady())
      return clause + ": the headers have another clock, and other topics have no usable stamps";
    if (greatest_lead > 0.0 && greatest_lead <= kLeastClockStep) {
      clause += sentence(
          "; other messages reached it up to %.3g s after their stamps, and a delay may be off by as much",
          greatest_lead);
    }
    return clause;
  }

  // A topic has the times of its headers. Where stamps cannot be used it has the recorder's; then the others keep their
  // stamps only if these are of the recorder's clock too. Returns the topics that give a signal.
  std::set<std::string> gather(BagSignals* result) const {
    const std::map<std::string, Winner> best = winners();
    std::map<std::string, HeaderClock> clocks;
    for (const auto& [signal, winner] : best) clocks[winner.topic] = readers_.at(winner.topic).clock();
    bool all_steady = true;
    double greatest_lead = 0.0;
    for (const auto& [topic, clock] : clocks) {
      all_steady = all_steady && clock.isSteady();
      if (clock.isSteady()) greatest_lead = std::max(greatest_lead, std::abs(clock.lead));
    }
    const bool one_clock = all_steady || greatest_lead <= kLeastClockStep;
    const auto clock_of = [&](const std::string& topic) {
      return clocks.at(topic).isSteady() && one_clock ? SignalClock::kHeaders : SignalClock::kRecorder;
    };
    const double start = result->health.first;
    for (const auto& [signal, winner] : best) {
      result->signals.series[signal] =
          readers_.at(winner.topic).series(winner.use, start, clock_of(winner.topic));
      result->signals.origin[signal] = winner.topic;
    }
    std::set<std::string> used;
    for (const auto& [topic, reader] : readers_) {
      const auto clock = clocks.find(topic);
      // Nothing is said of topics that are whole and not used.
      if (clock == clocks.end() && !reader.isEmpty()) continue;
      std::vector<std::string> clauses = reader.remarks(start);
      if (clock != clocks.end()) {
        used.insert(topic);
        const std::string clause = clauseOn(clock->second, clock_of(topic), greatest_lead);
        if (!clause.empty()) clauses.push_back(clause);
      }
      if (!clauses.empty()) result->health.remarks.push_back("topic " + topic + ": " + listOf(clauses, "; "));
    }
    return used;
  }

  std::string path_;
  const BagSignalOptions& options_;
  // Beginning of the topics in the namespace, with slashes on both sides. Empty: all.
  std::string prefix_;
  std::vector<Choice> choices_;
  std::set<std::string> topics_;
  std::map<std::string, TopicSignals> readers_;
};

}  // namespace

BagSignals signalsFromBag(const std::string& path, const BagSignalOptions& options) {
  return Collector(path, options).read();
}

}  // namespace polyfly
