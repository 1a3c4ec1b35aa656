#include "validation/controller_options.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "online_controller/types/option_groups.hpp"
#include "polyfly_base/closest_name.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"

namespace polyfly {
namespace {

// Of the node around the controller: they decide when it is called, which the bag tells.
const std::set<std::string> kNodeKeys = {"controller/stale_periods"};

std::string place(const std::string& path, const YAML::Node& node) {
  return path + ":" + std::to_string(node.Mark().line + 1) + ": ";
}

// Visitor of visitOptions that takes values from the file.
class OptionsFromYaml {
 public:
  OptionsFromYaml(const std::string& path, const YAML::Node& root) : path_(path), root_(root) {}

  template <class Value>
  void operator()(const std::string& key, Value& field, const char*, const Range&) {
    read(key, field);
  }
  void operator()(const std::string& key, bool& field) { read(key, field); }

  void refuseUnknown() const {
    refuseUnknownGroups();
    for (const char* section : {"vehicle", "controller"}) {
      const YAML::Node group = root_[section];
      if (!group) continue;
      if (!group.IsMap()) throw Error(place(path_, group) + section + ": must be a map");
      for (const auto& entry : group) {
        const std::string key = std::string(section) + "/" + entry.first.as<std::string>();
        if (known_.count(key) == 0 && kNodeKeys.count(key) == 0) {
          throw Error(place(path_, entry.first) + key + ": unknown key");
        }
      }
    }
  }

 private:
  void refuseUnknownGroups() const {
    const std::vector<std::string> groups(kOptionGroups.begin(), kOptionGroups.end());
    for (const auto& entry : root_) {
      const std::string name = entry.first.Scalar();
      const auto is_name = [&](const std::string& known) { return known == name; };
      if (std::any_of(groups.begin(), groups.end(), is_name) ||
          std::any_of(kSingleOptions.begin(), kSingleOptions.end(), is_name))
        continue;
      const auto meant = entry.second.IsMap() ? closestName(name, groups) : std::nullopt;
      throw Error(place(path_, entry.first) + name + ": unknown group" +
                  (meant ? "; is '" + *meant + "' meant?" : ""));
    }
  }

  template <class Value>
  void read(const std::string& key, Value& field) {
    known_.insert(key);
    const std::size_t slash = key.find('/');
    const YAML::Node group = root_[key.substr(0, slash)];
    if (!group || !group.IsMap()) return;
    const YAML::Node node = group[key.substr(slash + 1)];
    if (!node) return;
    try {
      field = node.as<Value>();
    } catch (const YAML::Exception&) {
      throw Error(place(path_, node) + key + ": is not a value of the right kind");
    }
  }

  std::string path_;
  YAML::Node root_;
  std::set<std::string> known_;
};

}  // namespace

MultirotorOptions loadControllerOptions(const std::string& path) {
  YAML::Node root;
  try {
    root = YAML::Load(readText(path));
  } catch (const YAML::Exception& error) {
    throw Error(path + ": is not YAML: " + error.what());
  }
  if (!root.IsMap()) throw Error(path + ": must be a map with vehicle and controller");
  MultirotorOptions options;
  OptionsFromYaml reader(path, root);
  visitOptions(options, reader);
  reader.refuseUnknown();
  try {
    checkOptions(options);
  } catch (const Error& error) {
    throw Error(path + ": " + error.what());
  }
  return options;
}

}  // namespace polyfly
