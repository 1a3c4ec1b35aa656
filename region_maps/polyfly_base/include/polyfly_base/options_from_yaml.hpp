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

  void operator()(const std::string& key, double& field, const char* unit, const Range& range);
  void operator()(const std::string& key, int& field, const char* unit, const Range& range);
  void operator()(const std::string& key, bool& field);
  void operator()(const std::string& key, std::vector<double>& field);
  void operator()(const std::string& key, std::string& field);
  void operator()(const std::string& key, std::optional<bool>& field);

  /// These keys are known too, and not read.
  void passOver(const std::set<std::string>& keys) { known_.insert(keys.begin(), keys.end()); }

  /// Throws Error on a key of the groups in `checked` that was not visited.
  void refuseUnknownKeys(const std::vector<std::string>& checked) const;
  /// Throws Error on what is neither one of these groups nor of these single options.
  void refuseUnknownGroups(const std::vector<std::string>& groups,
                           const std::vector<std::string>& singles) const;

 private:
  /// The value of a key of one level or two; undefined where there is none.
  YAML::Node find(const std::string& key);
  template <class Value>
  void read(const std::string& key, const char* type, Value& field);
  double numberOf(const YAML::Node& node, const std::string& key) const;
  [[noreturn]] void fail(const YAML::Node& node, const std::string& field, const std::string& rule) const;
  void requireRange(const std::string& key, double value, const char* unit, const Range& range);

  std::string source_;
  YAML::Node root_;
  std::set<std::string> known_;
};

}  // namespace polyfly
