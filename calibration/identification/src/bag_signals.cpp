#include "identification/bag_signals.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
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
  // SIGNAL=FIELD, separated by blanks, as behind --signal.
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
     "yaw_rate=twist.twist.angular.z height=pose.pose.position.z"},
    {"sensor_msgs/Imu", "", 1,
     "roll=orientation.roll pitch=orientation.pitch yaw=orientation.yaw yaw_rate=angular_velocity.z "
     "gyro_x=angular_velocity.x gyro_y=angular_velocity.y gyro_z=angular_velocity.z "
     "specific_force_z=linear_acceleration.z"},
    {"geometry_msgs/TransformStamped", "", 2,
     "roll=transform.rotation.roll pitch=transform.rotation.pitch yaw=transform.rotation.yaw "
     "height=transform.translation.z"},
    {"geometry_msgs/PoseStamped", "pose", 3,
     "roll=pose.orientation.roll pitch=pose.orientation.pitch yaw=pose.orientation.yaw "
     "height=pose.position.z"},
    {"geometry_msgs/TwistStamped", "velocity_local", 1,
     "vx=twist.linear.x vy=twist.linear.y vz=twist.linear.z"}};

// A path of a number, or of a quaternion with the angle that is wanted of it.
FieldUse fieldUse(const std::string& signal, const std::string& path, double scale) {
  FieldUse use = {signal, path, "", scale};
  for (const std::string angle : {"roll", "pitch", "yaw"}) {
    if (!endsWith(path, "." + angle)) continue;
    use.angle = angle;
    use.path.resize(path.size() - angle.size() - 1);
  }
  return use;
}

std::vector<FieldUse> usesOf(const KnownType& known) {
  std::vector<FieldUse> uses;
  std::istringstream words(known.uses);
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    uses.push_back(fieldUse(word.substr(0, equals), word.substr(equals + 1), 1.0));
  }
  return uses;
}

// Whether messages of this type on this topic are what the list means.
bool isKnown(const KnownType& known, const BagConnection& connection) {
  const auto named = [&connection](const char* part) {
    return connection.topic.find(part) != std::string::npos;
  };
  // A pose that was asked for is not one that was measured.
  const bool asked = std::string(known.topic) == "pose" && (named("command") || named("setpoint"));
  return connection.type == known.type && named(known.topic) && !asked;
}

constexpr int kTruthRank = 10;  // added to that of the type
// Times by which two records of one message may differ [s].
constexpr double kSameMessage = 0.1;

// Whether two topics brought the same messages, of which at least one number changes.
bool isRepeated(const std::map<std::string, TimeSeries>& one,
                const std::map<std::string, TimeSeries>& other) {
  bool changes = false;
  if (one.size() != other.size()) return false;
  for (const auto& [name, series] : one) {
    const auto found = other.find(name);
    if (found == other.end() || found->second.value != series.value) return false;
    for (std::size_t i = 0; i < series.time.size(); ++i) {
      if (std::abs(series.time[i] - found->second.time[i]) > kSameMessage) return false;
      changes = changes || series.value[i] != series.value.front();
    }
  }
  return changes;
}

// `topic:path` and its last part, if that is an angle.
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
  return {place.substr(0, colon), fieldUse(signal, place.substr(colon + 1), chosen.factor())};
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
      for (Source& source : sources_.at(message.connection->topic)) source.reader->add(message);
    };
    BagSignals result;
    result.health = scanBag(path_, visitor);
    result.signals.source = path_;
    if (result.health.messages == 0) {
      std::string remarks;
      for (const std::string& remark : result.health.remarks) remarks += "; " + remark;
      throw Error(path_ + ": holds no message" + remarks);
    }
    checkNamespace();
    for (const Choice& choice : choices_) {
      if (topics_.count(choice.topic) == 0)
        throw Error(path_ + ": no topic " + choice.topic + "; there are " + topics());
    }
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
  struct Source {
    std::shared_ptr<TopicSignals> reader;
    int rank = 0;
    std::string type;
  };

  std::string topics() const {
    std::string known;
    for (const std::string& topic : topics_) known += (known.empty() ? "" : ", ") + topic;
    return known;
  }

  bool isChosen(const std::string& signal) const { return options_.choice.count(signal) > 0; }

  // Whether the options admit a topic as a source of signals that they do not place.
  bool isHeard(const std::string& topic) const {
    if (topic.compare(0, prefix_.size(), prefix_) != 0) return false;
    return options_.topics.empty() ||
           std::any_of(options_.topics.begin(), options_.topics.end(),
                       [&topic](const std::string& ending) { return endsWith(topic, ending); });
  }

  // Whether the bag has a topic in the namespace.
  void checkNamespace() const {
    const bool any = std::any_of(topics_.begin(), topics_.end(), [this](const std::string& topic) {
      return topic.compare(0, prefix_.size(), prefix_) == 0;
    });
    if (!any)
      throw Error(path_ + ": no topic in the namespace " + options_.name_space + "; there are " + topics());
  }

  bool listen(const BagConnection& connection) {
    topics_.insert(connection.topic);
    // A second publisher of a topic brings messages of the same kind.
    if (sources_.count(connection.topic) > 0)
      return sources_.at(connection.topic).front().type == connection.type;
    std::vector<Source> sources;
    std::vector<FieldUse> chosen;
    for (const Choice& choice : choices_) {
      if (choice.topic == connection.topic) chosen.push_back(choice.use);
    }
    constexpr int kChosen = -1;
    if (!chosen.empty()) sources.push_back(source(connection, chosen, false, kChosen));
    for (const KnownType& known : kKnownTypes) {
      if (!isHeard(connection.topic) || !isKnown(known, connection)) continue;
      std::vector<FieldUse> uses;
      for (const FieldUse& use : usesOf(known)) {
        if (!isChosen(use.signal)) uses.push_back(use);
      }
      const bool odometry = std::string(known.type) == "nav_msgs/Odometry";
      // What a simulator knows is not what a controller saw.
      const bool truth = connection.topic.find("ground_truth") != std::string::npos;
      sources.push_back(source(connection, uses, odometry, known.rank + (truth ? kTruthRank : 0)));
      break;
    }
    if (sources.empty()) return false;
    sources_[connection.topic] = sources;
    return true;
  }

  Source source(const BagConnection& connection, const std::vector<FieldUse>& uses, bool velocity,
                int rank) const {
    try {
      return {std::make_shared<TopicSignals>(connection, uses, velocity), rank, connection.type};
    } catch (const Error& error) {
      throw Error(path_ + ": " + error.what());
    }
  }

  struct Winner {
    const TopicSignals* reader = nullptr;
    std::string topic;
    int rank = 0;
  };

  // Sources whose messages repeat those of an earlier topic, with that topic.
  using Repeats = std::map<const TopicSignals*, std::string>;

  Repeats findRepeats() const {
    Repeats repeats;
    std::map<std::string, std::map<std::string, TimeSeries>> earlier;
    for (const auto& [topic, sources] : sources_) {
      for (const Source& one : sources) {
        const bool is_steady = one.reader->clock().isSteady();
        auto found = one.reader->series(0.0, is_steady ? SignalClock::kHeaders : SignalClock::kRecorder);
        const auto same = std::find_if(earlier.begin(), earlier.end(), [&found](const auto& before) {
          return isRepeated(before.second, found);
        });
        if (same != earlier.end()) {
          repeats[one.reader.get()] = same->first;
        } else {
          earlier[topic] = std::move(found);
        }
      }
    }
    return repeats;
  }

  // The best source of each signal; two of the same rank leave a question that only the user can answer.
  std::map<std::string, Winner> winners(const Repeats& repeats) const {
    std::map<std::string, Winner> best;
    for (const auto& [topic, sources] : sources_) {
      for (const Source& one : sources) {
        if (repeats.count(one.reader.get()) > 0) continue;
        for (const std::string& signal : one.reader->names()) {
          const auto before = best.find(signal);
          if (before != best.end()) {
            if (before->second.rank < one.rank) continue;
            if (before->second.rank == one.rank && preferred(signal, before->second.topic, topic) != topic)
              continue;
          }
          best[signal] = {one.reader.get(), topic, one.rank};
        }
      }
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
    const Repeats repeats = findRepeats();
    const std::map<std::string, Winner> best = winners(repeats);
    // All readers of a topic have the same stamps.
    std::map<std::string, HeaderClock> clocks;
    for (const auto& [signal, winner] : best) clocks[winner.topic] = winner.reader->clock();
    bool all_steady = true;
    double greatest_lead = 0.0;
    for (const auto& [topic, clock] : clocks) {
      all_steady = all_steady && clock.isSteady();
      if (clock.isSteady()) greatest_lead = std::max(greatest_lead, std::abs(clock.lead));
    }
    const bool one_clock = all_steady || greatest_lead <= kLeastClockStep;
    const auto clock_of = [one_clock](const HeaderClock& clock) {
      return clock.isSteady() && one_clock ? SignalClock::kHeaders : SignalClock::kRecorder;
    };
    const double start = result->health.first;
    for (const auto& [signal, winner] : best) {
      result->signals.series[signal] =
          winner.reader->series(start, clock_of(clocks.at(winner.topic))).at(signal);
      result->signals.origin[signal] = winner.topic;
    }
    for (const auto& [topic, sources] : sources_) {
      const auto repeated = repeats.find(sources.back().reader.get());
      if (repeated != repeats.end()) {
        result->health.remarks.push_back("topic " + topic + ": repeats " + repeated->second +
                                         "; its messages count once");
      }
      const auto clock = clocks.find(topic);
      // Nothing is said of topics that are whole and not used.
      if (clock == clocks.end() && !sources.front().reader->names().empty()) continue;
      std::vector<std::string> clauses = sources.front().reader->remarks(start);
      if (clock != clocks.end())
        clauses.push_back(clauseOn(clock->second, clock_of(clock->second), greatest_lead));
      std::string remark;
      for (const std::string& clause : clauses)
        remark += clause.empty() ? "" : (remark.empty() ? "topic " + topic + ": " : "; ") + clause;
      if (!remark.empty()) result->health.remarks.push_back(remark);
    }
    std::set<std::string> used;
    for (const auto& [topic, clock] : clocks) used.insert(topic);
    return used;
  }

  // Which of two topics gives a signal; the answer holds for everything that both could give.
  std::string preferred(const std::string& signal, const std::string& one, const std::string& other) const {
    const auto pair = std::make_pair(one, other);
    const auto known = answers_.find(pair);
    if (known != answers_.end()) return known->second;
    const std::string question = path_ + ": " + signal + " could come from " + one + " or from " + other;
    std::optional<std::size_t> answer;
    if (options_.ask) answer = options_.ask(question + ". Which?", {one, other});
    if (!answer) {
      throw Error(question + ": choose with --namespace, with --topic, or with --signal " + signal +
                  "=TOPIC:FIELD");
    }
    return answers_[pair] = *answer == 0 ? one : other;
  }

  std::string path_;
  const BagSignalOptions& options_;
  // Beginning of the topics in the namespace, with slashes on both sides. Empty: all.
  std::string prefix_;
  mutable std::map<std::pair<std::string, std::string>, std::string> answers_;
  std::vector<Choice> choices_;
  std::set<std::string> topics_;
  std::map<std::string, std::vector<Source>> sources_;
};

}  // namespace

BagSignals signalsFromBag(const std::string& path, const BagSignalOptions& options) {
  return Collector(path, options).read();
}

}  // namespace polyfly
