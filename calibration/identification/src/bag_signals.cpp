#include "identification/bag_signals.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "polyfly_base/error.hpp"
#include "topic_signals.hpp"

namespace polyfly {
namespace {

using Angle = FieldUse::Angle;

// What a type of message can tell. A lower rank wins where two types tell the same signal.
struct KnownType {
  const char* type;
  const char* topic;  // must be in the name, if not empty
  int rank;
  std::vector<FieldUse> uses;
};

const std::vector<KnownType>& knownTypes() {
  static const std::vector<KnownType> kTypes = {
      {"mav_msgs/RollPitchYawrateThrust",
       "",
       0,
       {{"roll_cmd", "roll"},
        {"pitch_cmd", "pitch"},
        {"yaw_rate_cmd", "yaw_rate"},
        {"thrust_cmd", "thrust.z"}}},
      {"mavros_msgs/AttitudeTarget",
       "",
       1,
       {{"roll_cmd", "orientation", Angle::kRoll},
        {"pitch_cmd", "orientation", Angle::kPitch},
        {"yaw_rate_cmd", "body_rate.z"},
        {"thrust_cmd", "thrust"}}},
      {"geometry_msgs/PoseStamped",
       "attitude",
       1,
       {{"roll_cmd", "pose.orientation", Angle::kRoll}, {"pitch_cmd", "pose.orientation", Angle::kPitch}}},
      {"std_msgs/Float64", "throttle", 1, {{"thrust_cmd", "data"}}},
      {"std_msgs/Float64", "thrust", 1, {{"thrust_cmd", "data"}}},
      {"nav_msgs/Odometry",
       "",
       0,
       {{"roll", "pose.pose.orientation", Angle::kRoll},
        {"pitch", "pose.pose.orientation", Angle::kPitch},
        {"yaw", "pose.pose.orientation", Angle::kYaw},
        {"yaw_rate", "twist.twist.angular.z"},
        {"height", "pose.pose.position.z"}}},
      {"sensor_msgs/Imu",
       "",
       1,
       {{"roll", "orientation", Angle::kRoll},
        {"pitch", "orientation", Angle::kPitch},
        {"yaw", "orientation", Angle::kYaw},
        {"yaw_rate", "angular_velocity.z"},
        {"gyro_x", "angular_velocity.x"},
        {"gyro_y", "angular_velocity.y"},
        {"gyro_z", "angular_velocity.z"},
        {"specific_force_x", "linear_acceleration.x"},
        {"specific_force_y", "linear_acceleration.y"},
        {"specific_force_z", "linear_acceleration.z"}}},
      {"geometry_msgs/TransformStamped",
       "",
       2,
       {{"roll", "transform.rotation", Angle::kRoll},
        {"pitch", "transform.rotation", Angle::kPitch},
        {"yaw", "transform.rotation", Angle::kYaw},
        {"height", "transform.translation.z"}}},
      {"geometry_msgs/PoseStamped",
       "pose",
       3,
       {{"roll", "pose.orientation", Angle::kRoll},
        {"pitch", "pose.orientation", Angle::kPitch},
        {"yaw", "pose.orientation", Angle::kYaw},
        {"height", "pose.position.z"}}},
      {"geometry_msgs/TwistStamped",
       "velocity_local",
       1,
       {{"vx", "twist.linear.x"}, {"vy", "twist.linear.y"}, {"vz", "twist.linear.z"}}},
  };
  return kTypes;
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
constexpr double kRadianOfDegree = 3.14159265358979323846 / 180.0;
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

bool endsWith(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

// `topic:path` and its last part, if that is an angle.
struct Choice {
  std::string topic;
  FieldUse use;
};

Choice parseChoice(const std::string& signal, const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == text.size()) {
    throw Error("--signal " + signal + "=" + text + ": must be SIGNAL=TOPIC:FIELD for a bag");
  }
  Choice choice = {text.substr(0, colon), {signal, text.substr(colon + 1), Angle::kNone}};
  const std::string degrees = ":deg";
  if (endsWith(choice.use.path, degrees)) {
    choice.use.path.resize(choice.use.path.size() - degrees.size());
    choice.use.scale = kRadianOfDegree;
  }
  const std::pair<const char*, Angle> angles[] = {
      {".roll", Angle::kRoll}, {".pitch", Angle::kPitch}, {".yaw", Angle::kYaw}};
  for (const auto& [ending, angle] : angles) {
    if (!endsWith(choice.use.path, ending)) continue;
    choice.use.angle = angle;
    choice.use.path.resize(choice.use.path.size() - std::string(ending).size());
  }
  return choice;
}

class Collector {
 public:
  Collector(const std::string& path, const BagSignalOptions& options) : path_(path), options_(options) {
    for (const auto& [signal, text] : options.choice) {
      if (std::find(signalNames().begin(), signalNames().end(), signal) == signalNames().end()) {
        throw Error("--signal " + signal + ": is no signal");
      }
      choices_.push_back(parseChoice(signal, text));
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
    for (const Choice& choice : choices_) {
      if (topics_.count(choice.topic) == 0)
        throw Error(path_ + ": no topic " + choice.topic + "; there are " + topics());
    }
    gather(&result);
    result.signals.places.assign(topics_.begin(), topics_.end());
    return result;
  }

 private:
  struct Source {
    std::shared_ptr<TopicSignals> reader;
    int rank = 0;
    std::string type;
  };

  struct Offer {
    std::string signal;
    std::string topic;
    int rank = 0;
  };

  std::string topics() const {
    std::string known;
    for (const std::string& topic : topics_) known += (known.empty() ? "" : ", ") + topic;
    return known;
  }

  bool isChosen(const std::string& signal) const { return options_.choice.count(signal) > 0; }

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
    const bool heard = options_.topics.empty() || std::any_of(options_.topics.begin(), options_.topics.end(),
                                                              [&](const std::string& ending) {
                                                                return endsWith(connection.topic, ending);
                                                              });
    for (const KnownType& known : knownTypes()) {
      if (!heard || !isKnown(known, connection)) continue;
      std::vector<FieldUse> uses;
      for (const FieldUse& use : known.uses) {
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

  // The best source of each signal; two of the same rank leave a question that only the user can answer.
  void gather(BagSignals* result) const {
    std::map<std::string, int> ranks;
    std::map<std::string, std::map<std::string, TimeSeries>> taken;
    for (const auto& [topic, sources] : sources_) {
      for (const Source& one : sources) {
        std::map<std::string, TimeSeries> found =
            one.reader->series(result->health.first, &result->health.remarks);
        const auto same = std::find_if(taken.begin(), taken.end(), [&found](const auto& before) {
          return isRepeated(before.second, found);
        });
        if (same != taken.end()) {
          result->health.remarks.push_back("topic " + topic + ": repeats " + same->first +
                                           "; its messages count once");
          continue;
        }
        for (const auto& [signal, series] : found) {
          if (!series.time.empty()) offer({signal, topic, one.rank}, series, &ranks, &result->signals);
        }
        taken[topic] = std::move(found);
      }
    }
  }

  // Takes the series unless there is a better one.
  void offer(const Offer& one, const TimeSeries& series, std::map<std::string, int>* ranks,
             FlightSignals* signals) const {
    const auto before = ranks->find(one.signal);
    if (before != ranks->end() && before->second == one.rank) {
      if (preferred(one.signal, signals->origin[one.signal], one.topic) != one.topic) return;
    }
    if (before != ranks->end() && before->second < one.rank) return;
    (*ranks)[one.signal] = one.rank;
    signals->series[one.signal] = series;
    signals->origin[one.signal] = one.topic;
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
      throw Error(question + ": choose with --topic, or with --signal " + signal + "=TOPIC:FIELD");
    }
    return answers_[pair] = *answer == 0 ? one : other;
  }

  std::string path_;
  const BagSignalOptions& options_;
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
