#include "polyfly_base/options_from_yaml.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "polyfly_base/closest_name.hpp"
#include "polyfly_base/decimal.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/load_yaml.hpp"
#include "polyfly_base/range_check.hpp"

namespace polyfly {
namespace {

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

OptionsFromYaml::OptionsFromYaml(const std::string& text, const std::string& source)
    : source_(source), root_(loadYaml(text, source)) {
  if (!root_.IsMap()) throw Error(source + ": must be a map with the groups of a node's options");
}

void OptionsFromYaml::fail(const YAML::Node& node, const std::string& field, const std::string& rule) const {
  throw Error(placeOf(node, field) + ": " + rule);
}

std::string OptionsFromYaml::placeOf(const YAML::Node& node, const std::string& key) const {
  if (node.Mark().is_null()) return source_ + "/" + key;
  return source_ + ":" + std::to_string(node.Mark().line + 1) + ": " + key;
}

// The tree is read only as constant: the other access to a node adds what is not there.
YAML::Node OptionsFromYaml::find(const std::string& key) {
  known_.insert(key);
  const YAML::Node& root = root_;
  const std::size_t slash = key.find('/');
  if (slash == std::string::npos) return root[key];
  const YAML::Node group = root[key.substr(0, slash)];
  if (!group.IsDefined() || !group.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
  return group[key.substr(slash + 1)];
}

template <class Value>
void OptionsFromYaml::read(const std::string& key, const char* type, Value& field) {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  try {
    field = node.as<Value>();
  } catch (const YAML::Exception&) {
    fail(node, key, std::string("must be ") + type);
  }
}

void OptionsFromYaml::requireRange(const std::string& key, double value, const char* unit,
                                   const Range& range) {
  const YAML::Node node = find(key);
  // What the file does not state may be out of range: some defaults come from other files.
  if (!node.IsDefined()) return;
  RangeCheck{}(placeOf(node, key).c_str(), value, unit, range);
}

double OptionsFromYaml::numberOf(const YAML::Node& node, const std::string& key) const {
  const bool quoted = node.Tag() == "!";
  const std::optional<double> value =
      node.IsScalar() && !quoted ? decimalNumber(node.Scalar()) : std::nullopt;
  if (!value) fail(node, key, std::string("must be a number") + kDecimalRule);
  return *value;
}

void OptionsFromYaml::operator()(const std::string& key, double& field, const char* unit,
                                 const Range& range) {
  const YAML::Node node = find(key);
  if (node.IsDefined()) field = numberOf(node, key);
  requireRange(key, field, unit, range);
}

void OptionsFromYaml::operator()(const std::string& key, int& field, const char* unit, const Range& range) {
  const YAML::Node node = find(key);
  double value = field;
  if (node.IsDefined()) value = numberOf(node, key);
  // Before the conversion, which is undefined for numbers beyond an int.
  requireRange(key, value, unit, range);
  if (node.IsDefined() && value != std::floor(value)) fail(node, key, "must be a whole number");
  field = static_cast<int>(value);
}

void OptionsFromYaml::operator()(const std::string& key, bool& field) { read(key, "true or false", field); }

void OptionsFromYaml::operator()(const std::string& key, std::vector<double>& field) {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  if (!node.IsSequence()) fail(node, key, "must be a list of numbers");
  field.clear();
  for (const YAML::Node& entry : node) field.push_back(numberOf(entry, key));
}

void OptionsFromYaml::operator()(const std::string& key, std::string& field) {
  const YAML::Node node = find(key);
  read(key, "a text", field);
  if (node.IsDefined() && field.empty()) fail(node, key, "must be a text that is not empty");
}

void OptionsFromYaml::operator()(const std::string& key, std::optional<bool>& field) {
  bool value = false;
  if (!find(key).IsDefined()) return;
  read(key, "true or false", value);
  field = value;
}

void OptionsFromYaml::refuseRemoved(const std::vector<RemovedOption>& removed) {
  for (const RemovedOption& option : removed) {
    const YAML::Node node = find(option.name);
    if (node.IsDefined()) fail(node, option.name, std::string("is removed: ") + option.instead);
  }
}

void OptionsFromYaml::refuseUnknownKeys(const std::vector<std::string>& checked) const {
  for (const std::string& name : checked) {
    const YAML::Node& root = root_;
    const YAML::Node group = root[name];
    if (!group.IsDefined()) continue;
    if (!group.IsMap()) fail(group, name, "must be a map");
    for (const auto& entry : group) {
      const std::string key = name + "/" + entry.first.Scalar();
      if (known_.count(key) == 0) fail(entry.first, key, "unknown key");
    }
  }
}

void OptionsFromYaml::refuseUnknownGroups(const std::vector<std::string>& groups,
                                          const std::vector<std::string>& singles) const {
  for (const auto& entry : root_) {
    const std::string name = entry.first.Scalar();
    if (holds(groups, name) || holds(singles, name)) continue;
    const auto meant = entry.second.IsMap() ? closestName(name, groups) : std::nullopt;
    fail(entry.first, name, "unknown group" + (meant ? "; is '" + *meant + "' meant?" : std::string()));
  }
}

void OptionsFromYaml::refuseMisspeltGroups(std::vector<std::string> groups) const {
  for (const std::string& key : known_) {
    if (key.find('/') != std::string::npos) groups.push_back(key.substr(0, key.find('/')));
  }
  for (const auto& entry : root_) {
    const std::string name = entry.first.Scalar();
    const auto meant = entry.second.IsMap() ? closestName(name, groups) : std::nullopt;
    if (meant) fail(entry.first, name, "unknown group; is '" + *meant + "' meant?");
  }
}

}  // namespace polyfly
