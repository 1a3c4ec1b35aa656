#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "polyfly_base/range.hpp"

namespace polyfly {

/// The visitor of an option list that takes values from a YAML file of a node's parameters. It follows the rules of
/// the node: an option that is not there keeps its value. Throws Error `file:line: key: rule` on a value of another
/// type or out of its range.
class OptionsFromYaml {
 public:
  /// Throws Error when the text is no map.
  OptionsFromYaml(const std::string& text, const std::string& source);
  /// Options that stand in no file. Errors then begin with `source/key: `.
  OptionsFromYaml(YAML::Node root, std::string source) : source_(std::move(source)), root_(std::move(root)) {}

  void operator()(const std::string& key, double& field, const char* unit, const Range& range);
  void operator()(const std::string& key, int& field, const char* unit, const Range& range);
  void operator()(const std::string& key, bool& field);
  void operator()(const std::string& key, std::vector<double>& field);
  void operator()(const std::string& key, std::string& field);
  void operator()(const std::string& key, std::optional<bool>& field);

  /// Removed options count as known: the text is what a node of an earlier version told.
  void passOverRemoved(const std::vector<RemovedOption>& removed) {
    for (const RemovedOption& option : removed) known_.insert(option.name);
  }

  /// Throws Error on a removed option, with what to use instead.
  void refuseRemoved(const std::vector<RemovedOption>& removed);
  /// Throws Error on a key of the groups in `checked` that was not visited.
  void refuseUnknownKeys(const std::vector<std::string>& checked) const;
  /// Throws Error on what is neither one of these groups nor of these single options.
  void refuseUnknownGroups(const std::vector<std::string>& groups,
                           const std::vector<std::string>& singles) const;
  /// Throws Error on a group that is misspelt: its name is near to one of these, or of those that were visited.
  void refuseMisspeltGroups(std::vector<std::string> groups) const;

 protected:
  [[noreturn]] void fail(const YAML::Node& node, const std::string& field, const std::string& rule) const;
  /// The value of a key of one level or two; undefined where there is none.
  YAML::Node find(const std::string& key);
  const YAML::Node& root() const noexcept { return root_; }
  bool isKnown(const std::string& key) const { return known_.count(key) != 0; }

 private:
  template <class Value>
  void read(const std::string& key, const char* type, Value& field);
  double numberOf(const YAML::Node& node, const std::string& key) const;
  std::string placeOf(const YAML::Node& node, const std::string& key) const;
  void requireRange(const std::string& key, double value, const char* unit, const Range& range);

  std::string source_;
  YAML::Node root_;
  std::set<std::string> known_;
};

}  // namespace polyfly
