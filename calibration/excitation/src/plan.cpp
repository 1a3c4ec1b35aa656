#include "excitation/plan.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iterator>
#include <locale>
#include <sstream>

#include "polyfly_base/read_text.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kMostManoeuvres = 1000;

struct Channel {
  const char* name;
  const char* unit;
  // The greatest amplitude that can be meant: more is a value in degrees.
  double greatest;
};
constexpr Channel kChannels[] = {
    {"roll", "rad", 0.8}, {"pitch", "rad", 0.8}, {"yaw_rate", "rad/s", 3.0}, {"thrust", "m/s^2", 8.0}};
constexpr const char* kShapes[] = {"2-1-1", "multisine"};

const Channel& of(ExcitedChannel channel) { return kChannels[static_cast<std::size_t>(channel)]; }

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

// The enumerator whose name stands in the field.
template <class Value>
Value namedBy(const YamlField& field, std::size_t count) {
  std::string known;
  for (std::size_t index = 0; index < count; ++index) {
    const auto value = static_cast<Value>(index);
    if (field.text() == nameOf(value)) return value;
    known += std::string(index > 0 ? ", " : "") + nameOf(value);
  }
  field.fail("'" + field.text() + "' is none of " + known);
}

// What all manoeuvres of an entry have in common.
Manoeuvre manoeuvreOf(const YamlField& entry) {
  // The shape decides which keys there are.
  if (!entry.has("shape")) entry.failAt("shape", "missing");
  Manoeuvre manoeuvre;
  manoeuvre.shape = namedBy<ExcitationShape>(entry.at("shape"), std::size(kShapes));
  if (manoeuvre.shape == ExcitationShape::kTwoOneOne) {
    entry.checkKeys({"shape", "channels", "amplitudes"}, {"both_signs", "repeat", "unit_time"});
    manoeuvre.unit_time = numberAt(entry, "unit_time", manoeuvre.unit_time, 0.02, 10.0);
    return manoeuvre;
  }
  entry.checkKeys({"shape", "channels", "amplitudes"},
                  {"both_signs", "repeat", "length", "frequency_from", "frequency_to", "tones"});
  if (entry.has("tones")) manoeuvre.tones = entry.at("tones").integer(1, 200);
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
  for (const YamlField& channel : oneOrMore(entry.at("channels"))) {
    manoeuvre.channel = namedBy<ExcitedChannel>(channel, kExcitedChannels);
    std::vector<double> deviations;
    for (const YamlField& field : oneOrMore(entry.at("amplitudes"))) {
      const double amplitude = numberOf(field, 0.0, of(manoeuvre.channel).greatest);
      if (!(amplitude > 0.0)) field.fail("must be above 0");
      deviations.push_back(amplitude);
      if (both) deviations.push_back(-amplitude);
    }
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      for (const double deviation : deviations) {
        manoeuvre.amplitude = deviation;
        manoeuvre.start = plan->duration();
        plan->manoeuvres.push_back(manoeuvre);
        if (plan->manoeuvres.size() > kMostManoeuvres) entry.fail("more than 1000 manoeuvres");
      }
    }
  }
}

double pulses(const Manoeuvre& manoeuvre, double time) {
  const double units = time / manoeuvre.unit_time;
  return units < 2.0 || units >= 3.0 ? 1.0 : -1.0;
}

// Schroeder: phase of tone k is -pi k (k - 1) / n. The sum is scaled by its greatest value that the phases
// allow, n, halved, and what would still exceed the amplitude is cut: with these phases that is rare.
double multisine(const Manoeuvre& manoeuvre, double time) {
  const double ratio = manoeuvre.frequency_to / manoeuvre.frequency_from;
  double sum = 0.0;
  for (int tone = 0; tone < manoeuvre.tones; ++tone) {
    const double share = static_cast<double>(tone) / std::max(1, manoeuvre.tones - 1);
    const double phase = -kPi * tone * (tone - 1.0) / manoeuvre.tones;
    sum += std::sin(2.0 * kPi * manoeuvre.frequency_from * std::pow(ratio, share) * time + phase);
  }
  return std::clamp(sum / std::sqrt(2.0 * manoeuvre.tones), -1.0, 1.0);
}

}  // namespace

const char* nameOf(ExcitedChannel channel) { return of(channel).name; }
const char* unitOf(ExcitedChannel channel) { return of(channel).unit; }
const char* nameOf(ExcitationShape shape) { return kShapes[static_cast<std::size_t>(shape)]; }

double Manoeuvre::duration() const { return shape == ExcitationShape::kTwoOneOne ? 4.0 * unit_time : length; }

double Manoeuvre::at(double time) const noexcept {
  if (!(time >= 0.0 && time < duration())) return 0.0;
  return amplitude * (shape == ExcitationShape::kTwoOneOne ? pulses(*this, time) : multisine(*this, time));
}

double ExcitationPlan::duration() const {
  return manoeuvres.empty() ? rest : manoeuvres.back().start + manoeuvres.back().duration() + rest;
}

int ExcitationPlan::running(double time) const noexcept {
  for (std::size_t index = 0; index < manoeuvres.size(); ++index) {
    const double since = time - manoeuvres[index].start;
    if (since >= 0.0 && since < manoeuvres[index].duration()) return static_cast<int>(index);
  }
  return -1;
}

std::array<double, kExcitedChannels> ExcitationPlan::at(double time) const noexcept {
  std::array<double, kExcitedChannels> deviation{};
  const int index = running(time);
  if (index >= 0) {
    const Manoeuvre& manoeuvre = manoeuvres[static_cast<std::size_t>(index)];
    deviation[static_cast<std::size_t>(manoeuvre.channel)] = manoeuvre.at(time - manoeuvre.start);
  }
  return deviation;
}

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

std::string describe(const ExcitationPlan& plan) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << plan.manoeuvres.size() << " manoeuvres, " << plan.duration() << " s with rests of " << plan.rest
      << " s\n";
  for (const Manoeuvre& manoeuvre : plan.manoeuvres) {
    out << "  at " << std::setw(7) << manoeuvre.start << " s  " << nameOf(manoeuvre.channel) << " "
        << nameOf(manoeuvre.shape) << ", amplitude " << manoeuvre.amplitude << " "
        << unitOf(manoeuvre.channel) << ", " << manoeuvre.duration() << " s\n";
  }
  return out.str();
}

}  // namespace polyfly
