#pragma once

#include <ros/node_handle.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "polyfly_base/options_from_yaml.hpp"

namespace polyfly_ros {

/// What another program calls an option of ours. It is ours = sign theirs + offset, with sign 1 or -1. Or ours is the
/// root of theirs: a standard deviation where they have a variance.
struct LegacyName {
  std::string theirs;
  std::string ours;
  double sign = 1.0;
  double offset = 0.0;
  bool raises = false;  ///< changed in flight, it raises ours and never lowers it
  bool root = false;
  int element = -1;  ///< place in a list of theirs; -1: theirs is no list

  double toOurs(double value) const { return root ? std::sqrt(std::max(value, 0.0)) : sign * value + offset; }
  double toTheirs(double value) const { return root ? value * value : (value - offset) * sign; }
};

using LegacyNames = std::vector<LegacyName>;

/// Reads options from a node's private parameters, by the rules of a YAML file. It is the visitor of an option list. It
/// throws Error naming the parameter when its type or range is wrong.
class ParameterReader : public polyfly::OptionsFromYaml {
 public:
  /// `names` are further names of numbers and flags. They count where ours is not set, of several the greatest number.
  explicit ParameterReader(const ros::NodeHandle& private_handle, LegacyNames names = {});

  using OptionsFromYaml::operator();
  void operator()(const std::string& key, double& field, const char* unit, const polyfly::Range& range);
  void operator()(const std::string& key, bool& field);

  /// Whether the parameter is set, of whatever type. It counts as read from then on.
  bool given(const std::string& key) { return find(key).IsDefined(); }
  /// Throws Error unless the parameter is a text that is not empty. `what` says what it is for.
  std::string requiredText(const std::string& key, const std::string& what);
  /// As requiredText, but `fallback` where the parameter is not set.
  std::string text(const std::string& key, const std::string& what, const std::string& fallback);
  /// Throws Error naming a parameter below one of these groups that was never read: a misspelling. So is a value in
  /// place of one of them, and a group whose name is near to one of these, or of those read.
  void refuseUnknown(const std::vector<std::string>& groups) const;
  /// Private parameters that were never read, perhaps misspelt; without those of `in_force` and of the diagnostics.
  std::vector<std::string> unread() const;
  /// What was read by a further name: "theirs -> ours", separated by commas.
  const std::string& adopted() const noexcept { return adopted_; }

 private:
  template <class Read>
  void adopt(const std::string& ours, const Read& read);

  LegacyNames names_;
  std::string adopted_;
};

}  // namespace polyfly_ros
