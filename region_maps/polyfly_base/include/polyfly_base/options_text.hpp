#pragma once

#include <optional>
#include <string>
#include <vector>

#include "polyfly_base/range.hpp"

namespace polyfly {

/// Group of a node's parameters that tells what is in force. A node that starts reads nothing of it.
constexpr const char* kInForceGroup = "in_force";

/// The visitor of an option list that writes its options as YAML, with units and ranges in comments. The slashes
/// of a key separate the levels of the text. `rosparam load` and `<rosparam>` read the text, and numbers in it are
/// exactly those that were given. Groups come in the order of their first keys.
class OptionsText {
 public:
  void operator()(const char* key, double value, const char* unit, const Range& range);
  void operator()(const char* key, int value, const char* unit, const Range& range);
  void operator()(const char* key, bool value) { add(key, value ? "true" : "false", ""); }
  /// Left out where the list is empty: a node takes that for a mistake.
  void operator()(const char* key, const std::vector<double>& values);
  /// Left out where the text is empty, for the same reason.
  void operator()(const char* key, const std::string& value);
  /// Left out where there is no value.
  void operator()(const char* key, const std::optional<bool>& value) {
    if (value) (*this)(key, *value);
  }

  /// A number without unit and range.
  void number(const std::string& key, double value);
  void text(const std::string& key, const std::string& value);
  /// A matrix by its rows.
  void matrix(const std::string& key, const std::vector<std::vector<double>>& rows);

  std::string yaml() const;

 private:
  struct Level {
    std::string name;
    /// Value of a key; empty for a group.
    std::string value;
    std::string comment;
    std::vector<Level> members;
  };

  void add(const std::string& key, const std::string& value, const std::string& comment);
  static void write(const Level& level, int depth, std::string* out);

  Level root_;
};

/// The shortest decimal number that is exactly `value`, with a point and, where there is an exponent, its sign.
/// YAML 1.1, which ROS reads, takes 1e-06 for a text.
std::string exactNumber(double value);

}  // namespace polyfly
