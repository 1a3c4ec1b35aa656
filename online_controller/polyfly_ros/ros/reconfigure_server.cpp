#include "polyfly_ros/reconfigure_server.hpp"

#include <dynamic_reconfigure/config_tools.h>
#include <ros/console.h>

#include <cmath>
#include <type_traits>

#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigTools;
using dynamic_reconfigure::Group;
using dynamic_reconfigure::GroupState;
using dynamic_reconfigure::ParamDescription;
using Option = OptionTable::Option;

// Group of the aliases, which are names of mav_control_rw.
constexpr const char* kAliasGroup = "mav_control_rw";

const char* typeOf(const Option& option) {
  if (std::holds_alternative<double*>(option.field)) return "double";
  return std::holds_alternative<int*>(option.field) ? "int" : "bool";
}

ParamDescription describe(const std::string& name, const std::string& type, const std::string& text) {
  ParamDescription description;
  description.name = name;
  description.type = type;
  description.description = text;
  return description;
}

Group makeGroup(const std::string& name, int id) {
  Group group;
  group.name = name;
  group.id = id;
  group.parent = 0;
  return group;
}

}  // namespace

ReconfigureServer::ReconfigureServer(const ros::NodeHandle& private_handle, OptionTable& table, Apply apply)
    : handle_(private_handle), table_(table), apply_(std::move(apply)) {
  description_publisher_ =
      handle_.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true);
  description_publisher_.publish(description());
  update_publisher_ = handle_.advertise<Config>("parameter_updates", 1, true);
  publish();
  service_ = handle_.advertiseService("set_parameters", &ReconfigureServer::onRequest, this);
}

void ReconfigureServer::publish() {
  if (told_) return;
  told_ = true;
  update_publisher_.publish(current());
}

bool ReconfigureServer::onRequest(dynamic_reconfigure::Reconfigure::Request& request,
                                  dynamic_reconfigure::Reconfigure::Response& response) {
  const std::vector<double> before = table_.values();
  try {
    take(request.config, before);
    if (table_.values() != before) apply_();
  } catch (const polyfly::Error& error) {
    table_.restore(before);
    ROS_ERROR("reconfigure refused, the values in force stay: %s", error.what());
  }
  response.config = current();
  hasChanged();
  return true;
}

void ReconfigureServer::take(const Config& wanted, const std::vector<double>& before) {
  for (const auto& entry : wanted.doubles) take(entry.name, entry.value, before);
  for (const auto& entry : wanted.ints) take(entry.name, entry.value, before);
  for (const auto& entry : wanted.bools) take(entry.name, entry.value != 0 ? 1.0 : 0.0, before);
}

void ReconfigureServer::take(const std::string& name, double value, const std::vector<double>& before) {
  if (const Option* option = table_.find(name)) {
    change(*option, value);
    return;
  }
  for (const OptionTable::Alias& alias : table_.aliases()) {
    if (alias.name != name) continue;
    // Who sends all values back has not changed those that are as they were.
    const OptionTable::Alias::Link& first = alias.links.front();
    if (value != first.name.toTheirs(before[first.option])) take(alias, value);
    return;
  }
  ROS_WARN("reconfigure: there is no '%s'", name.c_str());
}

void ReconfigureServer::take(const OptionTable::Alias& alias, double value) {
  for (const OptionTable::Alias::Link& link : alias.links) {
    const Option& option = table_.options()[link.option];
    const double ours = link.name.toOurs(value);
    if (!link.name.raises || ours > OptionTable::get(option)) change(option, ours);
  }
}

void ReconfigureServer::change(const Option& option, double value) {
  if (std::isnan(value)) throw polyfly::Error(option.parameter + ": must be a number");
  if (OptionTable::set(option, value)) changed_.insert(option.name);
}

void ReconfigureServer::writeParameters() {
  for (const std::string& name : changed_) {
    const Option* option = table_.find(name);
    std::visit([&](const auto* field) { handle_.setParam(option->parameter, *field); }, option->field);
  }
  changed_.clear();
}

Config ReconfigureServer::current() const { return config(OptionTable::get); }

Config ReconfigureServer::config(const std::function<double(const Option&)>& value) const {
  Config all;
  const auto add = [&](const Option& option, const std::string& name, double shown) {
    const auto append = [&](const auto* field) {
      ConfigTools::appendParameter(all, name, static_cast<std::decay_t<decltype(*field)>>(shown));
    };
    std::visit(append, option.field);
  };
  for (const Option& option : table_.options()) add(option, option.name, value(option));
  for (const OptionTable::Alias& alias : table_.aliases()) {
    const Option& option = table_.first(alias);
    add(option, alias.name, alias.links.front().name.toTheirs(value(option)));
  }
  int id = 0;
  GroupState shown;
  shown.state = 1;
  ConfigTools::appendGroup(all, "Default", id++, 0, shown);
  for (const std::string& name : table_.groups()) ConfigTools::appendGroup(all, name, id++, 0, shown);
  if (!table_.aliases().empty()) ConfigTools::appendGroup(all, kAliasGroup, id++, 0, shown);
  return all;
}

dynamic_reconfigure::ConfigDescription ReconfigureServer::description() const {
  dynamic_reconfigure::ConfigDescription all;
  all.groups.push_back(makeGroup("Default", 0));
  for (const std::string& name : table_.groups()) {
    Group group = makeGroup(name, static_cast<int>(all.groups.size()));
    for (const Option& option : table_.options()) {
      if (option.group == name)
        group.parameters.push_back(describe(option.name, typeOf(option), "[" + option.unit + "]"));
    }
    all.groups.push_back(group);
  }
  if (!table_.aliases().empty()) {
    Group group = makeGroup(kAliasGroup, static_cast<int>(all.groups.size()));
    for (const OptionTable::Alias& alias : table_.aliases())
      group.parameters.push_back(
          describe(alias.name, typeOf(table_.first(alias)), "another name of " + table_.first(alias).name));
    all.groups.push_back(group);
  }
  all.min = config([](const Option& option) { return option.range.least; });
  all.max = config([](const Option& option) { return option.range.greatest; });
  all.dflt = current();
  return all;
}

}  // namespace polyfly_ros
