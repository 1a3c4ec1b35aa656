#include "polyfly_ros/parameter_reader.hpp"

#include <ros/param.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "polyfly_base/options_text.hpp"
#include "polyfly_base/range_check.hpp"

namespace polyfly_ros {
namespace {

// diagnostic_updater has parameters of its own there.
constexpr const char* kDiagnostics = "diagnostic_";
// A tag by which a text is never taken for a number.
constexpr const char* kText = "!";

YAML::Node toYaml(XmlRpc::XmlRpcValue& value) {
  YAML::Node node;
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeStruct:
      node = YAML::Node(YAML::NodeType::Map);
      for (auto& [name, member] : value) node[name] = toYaml(member);
      break;
    case XmlRpc::XmlRpcValue::TypeArray:
      node = YAML::Node(YAML::NodeType::Sequence);
      for (int i = 0; i < value.size(); ++i) node.push_back(toYaml(value[i]));
      break;
    case XmlRpc::XmlRpcValue::TypeInt:
      node = std::to_string(static_cast<int>(value));
      break;
    case XmlRpc::XmlRpcValue::TypeDouble:
      node = polyfly::exactNumber(static_cast<double>(value));
      break;
    case XmlRpc::XmlRpcValue::TypeBoolean:
      node = static_cast<bool>(value) ? "true" : "false";
      break;
    case XmlRpc::XmlRpcValue::TypeString:
      node = static_cast<std::string&>(value);
      node.SetTag(kText);
      break;
    case XmlRpc::XmlRpcValue::TypeInvalid:
    case XmlRpc::XmlRpcValue::TypeDateTime:
    case XmlRpc::XmlRpcValue::TypeBase64:
      break;
  }
  return node;
}

YAML::Node parametersOf(const ros::NodeHandle& handle) {
  XmlRpc::XmlRpcValue tree;
  const bool any = ros::param::get(handle.getNamespace(), tree);
  return any && tree.getType() == XmlRpc::XmlRpcValue::TypeStruct ? toYaml(tree)
                                                                  : YAML::Node(YAML::NodeType::Map);
}

// The keys below a node that holds no group.
void addKeys(const YAML::Node& node, const std::string& prefix, std::vector<std::string>& keys) {
  for (const auto& entry : node) {
    const std::string key = prefix + entry.first.Scalar();
    if (entry.second.IsMap()) {
      addKeys(entry.second, key + "/", keys);
    } else {
      keys.push_back(key);
    }
  }
}

}  // namespace

ParameterReader::ParameterReader(const ros::NodeHandle& private_handle, LegacyNames names)
    : OptionsFromYaml(parametersOf(private_handle), "parameter " + private_handle.getNamespace()),
      names_(std::move(names)) {}

template <class Read>
void ParameterReader::adopt(const std::string& ours, const Read& read) {
  if (given(ours)) return;
  for (const LegacyName& name : names_) {
    if (name.ours != ours || !given(name.theirs)) continue;
    read(name);
    const std::string text = name.theirs + " -> " + ours;
    if (adopted_.find(text) == std::string::npos) adopted_ += (adopted_.empty() ? "" : ", ") + text;
  }
}

void ParameterReader::operator()(const std::string& key, double& field, const char* unit,
                                 const polyfly::Range& range) {
  constexpr double kMost = std::numeric_limits<double>::max();
  OptionsFromYaml::operator()(key, field, unit, range);
  bool found = false;
  adopt(key, [&](const LegacyName& name) {
    std::vector<double> theirs(1);
    if (name.element < 0) {
      OptionsFromYaml::operator()(name.theirs, theirs.front(), unit, polyfly::Range{-kMost, kMost});
    } else {
      OptionsFromYaml::operator()(name.theirs, theirs);
    }
    const auto element = static_cast<std::size_t>(std::max(name.element, 0));
    if (element >= theirs.size()) fail(find(name.theirs), name.theirs, "must be a list of three numbers");
    const double value = name.toOurs(theirs[element]);
    field = found ? std::max(field, value) : value;
    found = true;
    polyfly::RangeCheck{}((name.theirs + ", " + key).c_str(), field, unit, range);
  });
}

void ParameterReader::operator()(const std::string& key, bool& field) {
  OptionsFromYaml::operator()(key, field);
  adopt(key, [&](const LegacyName& name) { OptionsFromYaml::operator()(name.theirs, field); });
}

std::string ParameterReader::requiredText(const std::string& key, const std::string& what) {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) fail(root(), key, "missing, must be " + what);
  if (node.Tag() != kText || node.Scalar().empty()) fail(node, key, "must be " + what);
  return node.Scalar();
}

std::string ParameterReader::text(const std::string& key, const std::string& what,
                                  const std::string& fallback) {
  return given(key) ? requiredText(key, what) : fallback;
}

void ParameterReader::refuseUnknown(const std::vector<std::string>& groups) const {
  refuseMisspeltGroups(groups);
  refuseUnknownKeys(groups);
}

std::vector<std::string> ParameterReader::unread() const {
  std::vector<std::string> keys;
  addKeys(root(), "", keys);
  const std::string told = std::string(polyfly::kInForceGroup) + "/";
  const auto is_known = [&](const std::string& key) {
    return isKnown(key) || key.rfind(kDiagnostics, 0) == 0 || key.rfind(told, 0) == 0;
  };
  keys.erase(std::remove_if(keys.begin(), keys.end(), is_known), keys.end());
  return keys;
}

}  // namespace polyfly_ros
