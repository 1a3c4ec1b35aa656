#include "excitation/plan.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <optional>
#include <set>
#include <sstream>

#include "polyfly_base/decimal.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/load_yaml.hpp"
#include "polyfly_base/read_text.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMostManoeuvres = 1000;

struct Names {
  const char* name;
  const char* unit;
};
constexpr Names kChannels[kExcitedChannels] = {
    {"roll", "rad"}, {"pitch", "rad"}, {"yaw_rate", "rad/s"}, {"thrust", "m/s^2"}};
constexpr const char* kShapes[4] = {"2-1-1", "doublet", "multisine", "chirp"};

// One map of the YAML, read key by key; what is left over is refused.
class Fields {
 public:
  Fields(const YAML::Node& node, std::string place) : node_(node), place_(std::move(place)) {
    if (!node_.IsMap()) throw Error(place_ + ": must be a map");
  }

  double number(const std::string& key, double fallback, double least, double greatest) {
    known_.insert(key);
    if (!node_[key]) return fallback;
    return numberOf(key, node_[key], least, greatest);
  }

  std::vector<double> numbers(const std::string& key, double least, double greatest) {
    known_.insert(key);
    if (!node_[key]) refuse(key, "missing");
    std::vector<double> values;
    if (node_[key].IsSequence()) {
      for (const YAML::Node& entry : node_[key]) values.push_back(numberOf(key, entry, least, greatest));
    } else {
      values.push_back(numberOf(key, node_[key], least, greatest));
    }
    if (values.empty()) refuse(key, "must not be empty");
    return values;
  }

  std::vector<std::string> texts(const std::string& key) {
    known_.insert(key);
    if (!node_[key]) refuse(key, "missing");
    std::vector<std::string> values;
    try {
      values = node_[key].IsSequence() ? node_[key].as<std::vector<std::string>>()
                                       : std::vector<std::string>{node_[key].as<std::string>()};
    } catch (const YAML::Exception&) {
      refuse(key, "must be a name or a list of names");
    }
    if (values.empty()) refuse(key, "must not be empty");
    return values;
  }

  bool flag(const std::string& key, bool fallback) {
    known_.insert(key);
    if (!node_[key]) return fallback;
    try {
      return node_[key].as<bool>();
    } catch (const YAML::Exception&) {
      refuse(key, "must be true or false");
    }
  }

  void refuseUnknown() const {
    for (const auto& entry : node_) {
      const std::string key = entry.first.as<std::string>();
      if (known_.count(key) == 0) refuse(key, "unknown");
    }
  }

  void know(const std::string& key) { known_.insert(key); }
  [[noreturn]] void refuse(const std::string& key, const std::string& rule) const {
    throw Error(place_ + ": " + key + ": " + rule);
  }

 private:
  double numberOf(const std::string& key, const YAML::Node& node, double least, double greatest) const {
    const std::optional<double> value = node.IsScalar() ? decimalNumber(node.Scalar()) : std::nullopt;
    if (!value) refuse(key, std::string("must be a number") + kDecimalRule);
    requireRange(key, *value, least, greatest);
    return *value;
  }

  // Written so that NaN fails.
  void requireRange(const std::string& key, double value, double least, double greatest) const {
    if (value >= least && value <= greatest) return;
    std::ostringstream rule;
    rule << "must lie in [" << least << ", " << greatest << "], got " << value;
    refuse(key, rule.str());
  }

  YAML::Node node_;
  std::string place_;
  std::set<std::string> known_;
};

ExcitedChannel channelOf(const std::string& name, const Fields& fields) {
  for (std::size_t index = 0; index < kExcitedChannels; ++index) {
    if (name == kChannels[index].name) return static_cast<ExcitedChannel>(index);
  }
  fields.refuse("channels", "'" + name + "' is none of roll, pitch, yaw_rate, thrust");
}

ExcitationShape shapeOf(const std::string& name, const Fields& fields) {
  for (std::size_t index = 0; index < std::size(kShapes); ++index) {
    if (name == kShapes[index]) return static_cast<ExcitationShape>(index);
  }
  fields.refuse("shape", "'" + name + "' is none of 2-1-1, doublet, multisine, chirp");
}

// The greatest amplitude that can be meant: more is a value in degrees.
double greatestAmplitude(ExcitedChannel channel) {
  switch (channel) {
    case ExcitedChannel::kRoll:
    case ExcitedChannel::kPitch:
      return 0.8;
    case ExcitedChannel::kYawRate:
      return 3.0;
    case ExcitedChannel::kThrust:
      return 8.0;
  }
  return 0.0;
}

// All manoeuvres of one entry: every channel, repetition, amplitude and sign.
void addEntry(const YAML::Node& node, const std::string& place, ExcitationPlan* plan) {
  Fields fields(node, place);
  const std::vector<std::string> shapes = fields.texts("shape");
  if (shapes.size() != 1) fields.refuse("shape", "must be one name");
  Manoeuvre manoeuvre;
  manoeuvre.shape = shapeOf(shapes.front(), fields);
  const bool pulsed =
      manoeuvre.shape == ExcitationShape::kTwoOneOne || manoeuvre.shape == ExcitationShape::kDoublet;
  if (pulsed) {
    manoeuvre.unit_time = fields.number("unit_time", manoeuvre.unit_time, 0.02, 10.0);
  } else {
    manoeuvre.length = fields.number("length", manoeuvre.length, 0.5, 600.0);
    manoeuvre.frequency_from = fields.number("frequency_from", manoeuvre.frequency_from, 0.01, 25.0);
    manoeuvre.frequency_to = fields.number("frequency_to", manoeuvre.frequency_to, 0.01, 25.0);
    if (manoeuvre.frequency_to < manoeuvre.frequency_from)
      fields.refuse("frequency_to", "must not be below frequency_from");
  }
  if (manoeuvre.shape == ExcitationShape::kMultisine) {
    const double tones = fields.number("tones", manoeuvre.tones, 1.0, 200.0);
    if (tones != std::floor(tones)) fields.refuse("tones", "must be a whole number");
    manoeuvre.tones = static_cast<int>(tones);
  }
  const std::vector<std::string> channels = fields.texts("channels");
  const std::vector<double> amplitudes = fields.numbers("amplitudes", 0.0, 10.0);
  const bool both = fields.flag("both_signs", true);
  const double repetitions = fields.number("repeat", 1.0, 1.0, 100.0);
  if (repetitions != std::floor(repetitions)) fields.refuse("repeat", "must be a whole number");
  fields.refuseUnknown();
  for (const std::string& name : channels) {
    manoeuvre.channel = channelOf(name, fields);
    for (int repetition = 0; repetition < static_cast<int>(repetitions); ++repetition) {
      for (const double amplitude : amplitudes) {
        if (!(amplitude > 0.0 && amplitude <= greatestAmplitude(manoeuvre.channel))) {
          std::ostringstream rule;
          rule << "of " << name << " must lie above 0 and up to " << greatestAmplitude(manoeuvre.channel)
               << " " << unitOf(manoeuvre.channel) << ", got " << amplitude;
          fields.refuse("amplitudes", rule.str());
        }
        for (const double sign : {1.0, -1.0}) {
          if (sign < 0.0 && !both) continue;
          manoeuvre.amplitude = sign * amplitude;
          manoeuvre.start = plan->duration();
          plan->manoeuvres.push_back(manoeuvre);
          if (plan->manoeuvres.size() > kMostManoeuvres) throw Error(place + ": more than 1000 manoeuvres");
        }
      }
    }
  }
}

}  // namespace

const char* nameOf(ExcitedChannel channel) { return kChannels[static_cast<std::size_t>(channel)].name; }
const char* unitOf(ExcitedChannel channel) { return kChannels[static_cast<std::size_t>(channel)].unit; }
const char* nameOf(ExcitationShape shape) { return kShapes[static_cast<std::size_t>(shape)]; }

ExcitationPlan parsePlan(const std::string& text, const std::string& source) {
  const YAML::Node root = loadYaml(text, source);
  Fields fields(root, source);
  ExcitationPlan plan;
  plan.rest = fields.number("rest", plan.rest, 0.0, 60.0);
  fields.know("manoeuvres");
  fields.refuseUnknown();
  const YAML::Node entries = root["manoeuvres"];
  if (!entries || !entries.IsSequence() || entries.size() == 0) {
    throw Error(source + ": manoeuvres: must be a list with one entry or more");
  }
  for (std::size_t index = 0; index < entries.size(); ++index) {
    addEntry(entries[index], source + ": manoeuvres[" + std::to_string(index) + "]", &plan);
  }
  return plan;
}

ExcitationPlan loadPlan(const std::string& path) { return parsePlan(readText(path), path); }

}  // namespace polyfly
