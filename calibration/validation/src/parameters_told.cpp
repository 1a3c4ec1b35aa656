#include "validation/parameters_told.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "mpc_core/calibration_provenance.hpp"
#include "online_controller/laws/axis.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/load_yaml.hpp"
#include "polyfly_base/options_text.hpp"
#include "polyfly_base/provenance.hpp"
#include "polyfly_base/version.hpp"
#include "region_maps/region_map.hpp"
#include "report/report.hpp"
#include "validation/controller_options.hpp"

namespace polyfly {
namespace {

// Number of options that a warning names.
constexpr std::size_t kMostNamed = 5;

// Values by their keys, with slashes between the levels.
using Values = std::map<std::string, std::string>;

std::string listOf(const YAML::Node& list) {
  std::string text = "[";
  for (const auto& item : list)
    text += (text.size() > 1 ? ", " : "") + (item.IsSequence() ? listOf(item) : item.Scalar());
  return text + "]";
}

void collect(const YAML::Node& node, const std::string& prefix, Values* values) {
  if (!node.IsMap()) {
    (*values)[prefix] = node.IsSequence() ? listOf(node) : node.Scalar();
    return;
  }
  for (const auto& entry : node)
    collect(entry.second, prefix + (prefix.empty() ? "" : "/") + entry.first.Scalar(), values);
}

Values valuesOf(const std::string& text, const std::string& source) {
  const YAML::Node root = loadYaml(text, source + ": parameters in force");
  if (!root.IsMap()) throw Error(source + ": parameters in force: must be a map");
  Values values;
  collect(root, "", &values);
  return values;
}

std::string at(const Values& values, const std::string& key) {
  const auto found = values.find(key);
  return found == values.end() ? std::string() : found->second;
}

std::string told(const std::string& key) { return std::string(kInForceGroup) + "/" + key; }

bool beginsWith(const std::string& text, const std::string& begin) { return text.rfind(begin, 0) == 0; }

// The group in which a law's maps or problems stand; empty for a law without.
std::string sourceOf(const std::string& law) {
  if (law == "explicit_linear") return "maps";
  if (law == "robust_explicit") return "robust_maps";
  return law == "linear" ? law : "";
}

// The replay has the constants of the start, and looks up in one set of maps.
bool bearsOnReplay(const std::string& key) {
  return beginsWith(key, "vehicle/") || beginsWith(key, "controller/") || beginsWith(key, "KF_observer/") ||
         key == "law" || beginsWith(key, told("maps")) || beginsWith(key, told("robust_maps"));
}

ParametersTold::Change changeBetween(const Values& before, const Values& after) {
  ParametersTold::Change change;
  change.cause = at(after, told("change"));
  Values all = before;
  all.insert(after.begin(), after.end());
  for (const auto& [key, ignored] : all) {
    const std::string was = at(before, key), is = at(after, key);
    // The law stands among the parameters too.
    if (was == is || key == told("change") || key == told("law")) continue;
    change.parameters.push_back(key + ": " + (was.empty() ? "none" : was) + " -> " +
                                (is.empty() ? "none" : is));
    change.bears_on_replay = change.bears_on_replay || bearsOnReplay(key);
  }
  return change;
}

// Receive times of the first odometry and of the first command [s].
std::pair<double, double> beginningOf(const FlightLog& log) {
  if (log.clocks.size() < 2) return {0.0, 0.0};
  return {log.clocks[0].start, log.clocks[1].start};
}

std::string describeProblem(const std::string& problem, const std::string& calibration) {
  return "problem " + (problem.empty() ? "made of the options" : problem) + ", " +
         (calibration.empty() ? "not calibrated" : "calibrated: " + calibration);
}

void warnOfMaps(const ParametersTold& parameters, const AxisMaps& maps, std::vector<std::string>* warnings) {
  if (sourceOf(parameters.law).empty()) {
    warnings->push_back("The flight began with the law " + parameters.law +
                        ", which looks nothing up in region maps: the maps did not give its commands.");
    return;
  }
  for (std::size_t axis = 0; axis < maps.size(); ++axis) {
    const ParametersTold::Axis& flew = parameters.axes[axis];
    const std::string problem(maps[axis]->problemText());
    if (checksumOf(problem) == flew.problem) continue;
    warnings->push_back(std::string("The ") + kAxisNames.at(axis).axis +
                        " axis flew another problem than that of " + maps[axis]->path() +
                        ". Flown: " + describeProblem(flew.problem, flew.calibration) +
                        ". Map: " + describeProblem(checksumOf(problem), calibrationsOf(problem)) + ".");
  }
}

void warnOfOptions(const ParametersTold& parameters, const MultirotorOptions& options,
                   std::vector<std::string>* warnings) {
  OptionsText text;
  visitOptions(options, text);
  const Values given = valuesOf(text.yaml(), "options");
  const Values flew = valuesOf(parameters.text, parameters.node);
  std::size_t different = 0;
  std::string named;
  for (const auto& [key, value] : given) {
    if (flew.count(key) == 0 || at(flew, key) == value || ++different > kMostNamed) continue;
    named += (named.empty() ? "" : ", ") + key + " " + value + " (in force " + at(flew, key) + ")";
  }
  if (different == 0) return;
  if (different > kMostNamed) named += " and " + std::to_string(different - kMostNamed) + " more";
  warnings->push_back("The options are not those that were in force: " + named + ".");
}

void warnOfChanges(const ParametersTold& parameters, std::vector<std::string>* warnings) {
  for (const ParametersTold::Change& change : parameters.changes) {
    if (!change.bears_on_replay) continue;
    std::string text;
    for (std::size_t i = 0; i < std::min(change.parameters.size(), kMostNamed); ++i)
      text += (i > 0 ? ", " : "") + change.parameters[i];
    warnings->push_back("Parameters changed in flight at " + number(change.time) + " s" + " (" +
                        change.cause + "): " + text + ". The replay uses those of the start.");
  }
}

}  // namespace

std::optional<ParametersTold> parametersTold(const FlightLog& log) {
  if (log.parameters.empty()) return std::nullopt;
  const auto [start, first_command] = beginningOf(log);
  std::size_t first = 0;
  while (first + 1 < log.parameters.size() && log.parameters[first + 1].time <= first_command) ++first;
  ParametersTold parameters;
  parameters.text = log.parameters[first].text;
  Values values = valuesOf(parameters.text, log.source);
  parameters.node = at(values, told("node"));
  parameters.version = at(values, told("version"));
  parameters.law = at(values, told("law"));
  parameters.provenance = at(values, "provenance");
  const std::string group = sourceOf(parameters.law);
  for (std::size_t axis = 0; axis < kAxisNames.size() && !group.empty(); ++axis) {
    const std::string space = told(group + "/" + kAxisNames.at(axis).axis);
    parameters.axes.at(axis) = {at(values, space + "/name"), at(values, space + "/checksum"),
                                at(values, space + "/problem"), at(values, space + "/calibration")};
  }
  for (std::size_t i = first + 1; i < log.parameters.size(); ++i) {
    Values next = valuesOf(log.parameters[i].text, log.source);
    parameters.changes.push_back(changeBetween(values, next));
    parameters.changes.back().time = log.parameters[i].time - start;
    values = std::move(next);
  }
  return parameters;
}

bool isOfOtherVersion(const FlightLog& log) {
  const std::optional<ParametersTold> parameters = parametersTold(log);
  return parameters && parameters->version != kVersion;
}

MultirotorOptions optionsInForce(const ParametersTold& parameters) {
  return parseControllerOptions(parameters.text, "parameters in force of " + parameters.node, true);
}

std::vector<std::string> parameterWarnings(const ParametersTold& parameters, const AxisMaps& maps,
                                           const MultirotorOptions& options) {
  std::vector<std::string> warnings;
  warnOfMaps(parameters, maps, &warnings);
  warnOfOptions(parameters, options, &warnings);
  warnOfChanges(parameters, &warnings);
  return warnings;
}

}  // namespace polyfly
