#pragma once

#include <ros/node_handle.h>

#include <set>
#include <string>
#include <vector>

#include "polyfly_base/range.hpp"

namespace polyfly_ros {

/// A parameter of earlier versions, and what to use instead.
struct RemovedParameter {
  const char* name;
  const char* instead;
};

/// Reads options from a node's private parameters. It is the visitor of an option list. Each call reads one
/// parameter, or leaves the default where it is not set. It throws Error naming the parameter when its type or range
/// is wrong.
class ParameterReader {
 public:
  explicit ParameterReader(const ros::NodeHandle& private_handle) : handle_(private_handle) {}

  void operator()(const char* key, double& field, const char* unit, const polyfly::Range& range);
  void operator()(const char* key, int& field, const char* unit, const polyfly::Range& range);
  void operator()(const char* key, bool& field);
  void operator()(const char* key, std::vector<double>& field);  ///< a list of numbers

  void operator()(const char* key, std::string& field);  ///< a text that is not empty

  /// What stands below this group counts as read.
  void passOver(const std::string& group);

  /// Whether the parameter is set, of whatever type. It counts as read from then on.
  bool given(const std::string& key);

  /// Whether the parameter is set; then it is true or false, or Error is thrown.
  bool flag(const std::string& key, bool& value);

  /// Throws Error unless the parameter is a text that is not empty. `what` says what it is for.
  std::string requiredText(const std::string& key, const std::string& what);

  /// As requiredText, but `fallback` where the parameter is not set.
  std::string text(const std::string& key, const std::string& what, const std::string& fallback);

  /// Throws Error naming a removed parameter that is set, and what to use instead.
  void refuseRemoved(const std::vector<RemovedParameter>& removed);

  /// Throws Error naming a parameter below one of these namespaces that was never read: a misspelling. So is a value in
  /// place of one of them, and one below a namespace whose name is near to one of these, or of those read: see polyfly::closestName.
  void refuseUnknown(const std::vector<std::string>& namespaces) const;

  /// Private parameters that were never read: perhaps misspelled.
  std::vector<std::string> unread() const;

 private:
  void refuseValuesOfGroups(const std::vector<std::string>& names,
                            const std::vector<std::string>& namespaces) const;
  void refuseMisspeltGroups(const std::vector<std::string>& names, std::vector<std::string> groups) const;

  ros::NodeHandle handle_;
  std::set<std::string> read_;
};

}  // namespace polyfly_ros
