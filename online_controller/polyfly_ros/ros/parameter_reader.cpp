#include "polyfly_ros/parameter_reader.hpp"

#include <ros/param.h>

#include <algorithm>
#include <sstream>

#include "polyfly_base/closest_name.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

[[noreturn]] void refuseValue(const std::string& name, const std::string& rule) {
  throw polyfly::Error("parameter " + name + ": " + rule);
}

template <class Value>
void requireRange(const std::string& name, Value value, const char* unit, const polyfly::Range& range) {
  // Written so that NaN fails.
  if (value >= range.least && value <= range.greatest) return;
  std::ostringstream rule;
  rule << "must lie in [" << range.least << ", " << range.greatest << "] " << unit << ", got " << value;
  refuseValue(name, rule.str());
}

std::vector<std::string> allNames() {
  std::vector<std::string> names;
  if (!ros::param::getParamNames(names))
    throw polyfly::Error("the parameter server does not list its parameters");
  std::sort(names.begin(), names.end());
  return names;
}

bool startsWith(const std::string& name, const std::string& prefix) {
  return name.compare(0, prefix.size(), prefix) == 0;
}

}  // namespace

bool ParameterReader::given(const std::string& key) {
  read_.insert(handle_.resolveName(key));
  return handle_.hasParam(key);
}

void ParameterReader::operator()(const char* key, double& field, const char* unit,
                                 const polyfly::Range& range) {
  if (given(key) && !handle_.getParam(key, field)) refuseValue(handle_.resolveName(key), "must be a number");
  requireRange(handle_.resolveName(key), field, unit, range);
}

void ParameterReader::operator()(const char* key, int& field, const char* unit, const polyfly::Range& range) {
  if (given(key)) {
    // roscpp would round 2.5 to an integer silently.
    XmlRpc::XmlRpcValue value;
    handle_.getParam(key, value);
    if (value.getType() != XmlRpc::XmlRpcValue::TypeInt)
      refuseValue(handle_.resolveName(key), "must be a whole number");
    field = static_cast<int>(value);
  }
  requireRange(handle_.resolveName(key), field, unit, range);
}

void ParameterReader::operator()(const char* key, bool& field) {
  if (given(key) && !handle_.getParam(key, field))
    refuseValue(handle_.resolveName(key), "must be true or false");
}

void ParameterReader::operator()(const char* key, std::vector<double>& field) {
  if (given(key) && !handle_.getParam(key, field))
    refuseValue(handle_.resolveName(key), "must be a list of numbers");
}

void ParameterReader::operator()(const char* key, std::string& field) {
  if (given(key)) field = requiredText(key, "a text that is not empty");
}

void ParameterReader::passOver(const std::string& group) {
  const std::string prefix = handle_.resolveName(group) + "/";
  for (const std::string& name : allNames()) {
    if (startsWith(name, prefix)) read_.insert(name);
  }
}

bool ParameterReader::flag(const std::string& key, bool& value) {
  const bool is_set = handle_.hasParam(key);
  (*this)(key.c_str(), value);
  return is_set;
}

std::string ParameterReader::requiredText(const std::string& key, const std::string& what) {
  std::string text;
  if (!given(key)) refuseValue(handle_.resolveName(key), "missing, must be " + what);
  if (!handle_.getParam(key, text) || text.empty()) refuseValue(handle_.resolveName(key), "must be " + what);
  return text;
}

std::string ParameterReader::text(const std::string& key, const std::string& what,
                                  const std::string& fallback) {
  return given(key) ? requiredText(key, what) : fallback;
}

void ParameterReader::refuseRemoved(const std::vector<RemovedParameter>& removed) {
  for (const RemovedParameter& parameter : removed) {
    if (given(parameter.name))
      throw polyfly::Error(std::string("parameter ") + parameter.name + " is removed: " + parameter.instead);
  }
}

void ParameterReader::refuseUnknown(const std::vector<std::string>& namespaces) const {
  const std::vector<std::string> names = allNames();
  refuseMisspeltGroups(names, namespaces);
  refuseValuesOfGroups(names, namespaces);
  for (const std::string& space : namespaces) {
    const std::string prefix = handle_.resolveName(space) + "/";
    for (const std::string& name : names) {
      if (startsWith(name, prefix) && read_.count(name) == 0) refuseValue(name, "unknown");
    }
  }
}

void ParameterReader::refuseValuesOfGroups(const std::vector<std::string>& names,
                                           const std::vector<std::string>& namespaces) const {
  std::set<std::string> groups;
  for (const std::string& space : namespaces) groups.insert(handle_.resolveName(space));
  for (const std::string& name : read_) {
    for (std::size_t end = name.rfind('/'); end != 0 && end != std::string::npos;
         end = name.rfind('/', end - 1))
      groups.insert(name.substr(0, end));
  }
  for (const std::string& name : names) {
    if (groups.count(name) != 0) refuseValue(name, "must be a group of parameters, not a value");
  }
}

void ParameterReader::refuseMisspeltGroups(const std::vector<std::string>& names,
                                           std::vector<std::string> groups) const {
  const std::string own = handle_.getNamespace() + "/";
  // What comes before the first slash below the private namespace; empty without one.
  const auto groupOf = [&](const std::string& name) {
    const std::size_t slash = startsWith(name, own) ? name.find('/', own.size()) : std::string::npos;
    return slash == std::string::npos ? std::string() : name.substr(own.size(), slash - own.size());
  };
  for (const std::string& name : read_) {
    if (!groupOf(name).empty()) groups.push_back(groupOf(name));
  }
  for (const std::string& name : names) {
    const std::string group = groupOf(name);
    if (group.empty()) continue;
    if (const auto meant = polyfly::closestName(group, groups))
      refuseValue(name, "there is no group '" + group + "'; is '" + *meant + "' meant?");
  }
}

std::vector<std::string> ParameterReader::unread() const {
  std::vector<std::string> names = allNames();
  const std::string own = handle_.getNamespace() + "/";
  const auto known = [&](const std::string& name) {
    // diagnostic_updater has parameters of its own there
    return !startsWith(name, own) || startsWith(name, own + "diagnostic_") || read_.count(name) != 0;
  };
  names.erase(std::remove_if(names.begin(), names.end(), known), names.end());
  return names;
}

}  // namespace polyfly_ros
