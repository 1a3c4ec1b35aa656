#include "excitation/plan.hpp"

#include <cmath>
#include <iterator>
#include <sstream>

#include "polyfly_base/read_text.hpp"
#include "polyfly_base/yaml_field.hpp"

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

double numberOf(const YamlField& field, double least, double greatest) {
  const double value = field.number();
  if (value >= least && value <= greatest) return value;
  std::ostringstream rule;
  rule << "must lie in [" << least << ", " << greatest << "], got " << value;
  field.fail(rule.str());
}

double numberAt(const YamlField& entry, const char* key, double fallback, double least, double greatest) {
  return entry.has(key) ? numberOf(entry.at(key), least, greatest) : fallback;
}

// A value alone, or a list of at least one.
std::vector<YamlField> oneOrMore(const YamlField& field) {
  std::vector<YamlField> items = field.isList() ? field.items() : std::vector<YamlField>{field};
  if (items.empty()) field.fail("must not be empty");
  return items;
}

bool flagAt(const YamlField& entry, const char* key, bool fallback) {
  if (!entry.has(key)) return fallback;
  const std::string text = entry.at(key).text();
  if (text != "true" && text != "false") entry.failAt(key, "must be true or false");
  return text == "true";
}

ExcitedChannel channelOf(const YamlField& field) {
  const std::string name = field.text();
  for (std::size_t index = 0; index < kExcitedChannels; ++index) {
    if (name == kChannels[index].name) return static_cast<ExcitedChannel>(index);
  }
  field.fail("'" + name + "' is none of roll, pitch, yaw_rate, thrust");
}

ExcitationShape shapeOf(const YamlField& field) {
  const std::string name = field.text();
  for (std::size_t index = 0; index < std::size(kShapes); ++index) {
    if (name == kShapes[index]) return static_cast<ExcitationShape>(index);
  }
  field.fail("'" + name + "' is none of 2-1-1, doublet, multisine, chirp");
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

// What all manoeuvres of an entry have in common.
Manoeuvre manoeuvreOf(const YamlField& entry) {
  // The shape decides which keys there are.
  if (!entry.has("shape")) entry.failAt("shape", "missing");
  Manoeuvre manoeuvre;
  manoeuvre.shape = shapeOf(entry.at("shape"));
  const bool pulsed =
      manoeuvre.shape == ExcitationShape::kTwoOneOne || manoeuvre.shape == ExcitationShape::kDoublet;
  if (pulsed) {
    entry.checkKeys({"shape", "channels", "amplitudes"}, {"both_signs", "repeat", "unit_time"});
    manoeuvre.unit_time = numberAt(entry, "unit_time", manoeuvre.unit_time, 0.02, 10.0);
    return manoeuvre;
  }
  if (manoeuvre.shape == ExcitationShape::kMultisine) {
    entry.checkKeys({"shape", "channels", "amplitudes"},
                    {"both_signs", "repeat", "length", "frequency_from", "frequency_to", "tones"});
    if (entry.has("tones")) manoeuvre.tones = entry.at("tones").integer(1, 200);
  } else {
    entry.checkKeys({"shape", "channels", "amplitudes"},
                    {"both_signs", "repeat", "length", "frequency_from", "frequency_to"});
  }
  manoeuvre.length = numberAt(entry, "length", manoeuvre.length, 0.5, 600.0);
  manoeuvre.frequency_from = numberAt(entry, "frequency_from", manoeuvre.frequency_from, 0.01, 25.0);
  manoeuvre.frequency_to = numberAt(entry, "frequency_to", manoeuvre.frequency_to, 0.01, 25.0);
  if (manoeuvre.frequency_to < manoeuvre.frequency_from)
    entry.failAt("frequency_to", "must not be below frequency_from");
  return manoeuvre;
}

// All manoeuvres of one entry: every channel, repetition, amplitude and sign.
void addEntry(const YamlField& entry, ExcitationPlan* plan) {
  Manoeuvre manoeuvre = manoeuvreOf(entry);
  const bool both = flagAt(entry, "both_signs", true);
  const int repetitions = entry.has("repeat") ? entry.at("repeat").integer(1, 100) : 1;
  std::vector<double> deviations;
  for (const YamlField& field : oneOrMore(entry.at("amplitudes"))) {
    const double amplitude = numberOf(field, 0.0, 10.0);
    deviations.push_back(amplitude);
    if (both) deviations.push_back(-amplitude);
  }
  for (const YamlField& channel : oneOrMore(entry.at("channels"))) {
    manoeuvre.channel = channelOf(channel);
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      for (const double deviation : deviations) {
        const double greatest = greatestAmplitude(manoeuvre.channel);
        if (!(std::abs(deviation) > 0.0 && std::abs(deviation) <= greatest)) {
          std::ostringstream rule;
          rule << "of " << nameOf(manoeuvre.channel) << " must lie above 0 and up to " << greatest << " "
               << unitOf(manoeuvre.channel) << ", got " << std::abs(deviation);
          entry.failAt("amplitudes", rule.str());
        }
        manoeuvre.amplitude = deviation;
        manoeuvre.start = plan->duration();
        plan->manoeuvres.push_back(manoeuvre);
        if (plan->manoeuvres.size() > kMostManoeuvres) entry.fail("more than 1000 manoeuvres");
      }
    }
  }
}

}  // namespace

const char* nameOf(ExcitedChannel channel) { return kChannels[static_cast<std::size_t>(channel)].name; }
const char* unitOf(ExcitedChannel channel) { return kChannels[static_cast<std::size_t>(channel)].unit; }
const char* nameOf(ExcitationShape shape) { return kShapes[static_cast<std::size_t>(shape)]; }

ExcitationPlan parsePlan(const std::string& text, const std::string& source) {
  const YamlField root = YamlField::parse(text, source);
  root.checkKeys({"manoeuvres"}, {"rest"});
  ExcitationPlan plan;
  plan.rest = numberAt(root, "rest", plan.rest, 0.0, 60.0);
  const YamlField entries = root.at("manoeuvres");
  if (!entries.isList() || entries.items().empty()) entries.fail("must be a list with one entry or more");
  for (const YamlField& entry : entries.items()) addEntry(entry, &plan);
  return plan;
}

ExcitationPlan loadPlan(const std::string& path) { return parsePlan(readText(path), path); }

}  // namespace polyfly
