#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <utility>
#include <vector>

namespace polyfly {

/// A YAML text in which values are replaced or added, while all else stays as it is, comments too. All members
/// throw Error naming file, field and rule.
class YamlEdits {
 public:
  YamlEdits(std::string text, std::string source);

  const YAML::Node& root() const { return root_; }
  const std::string& source() const { return source_; }
  [[noreturn]] void refuse(const std::string& field, const std::string& rule) const;

  double numberOf(const YAML::Node& scalar, const std::string& field) const;

  /// Replaces a number of the text.
  void setNumber(const YAML::Node& scalar, const std::string& field, double value);
  /// Sets `key` of the map `group` at the top; adds key and group where they are missing.
  void putNumber(const std::string& group, const std::string& key, double value);
  /// The same for a list of numbers in brackets. The comment stands behind it where the group is not in braces, in place
  /// of one that stands there.
  void putNumbers(const std::string& group, const std::string& key, const std::vector<double>& values,
                  const std::string& comment);
  /// The same for true or false.
  void putFlag(const std::string& group, const std::string& key, bool value);
  /// The same for a text of one line at the top, which is given in double quotes.
  void putText(const std::string& key, const std::string& value);

  /// Sentences on what changed.
  const std::vector<std::string>& changes() const { return changes_; }
  /// Fields that were set since the last call.
  std::vector<std::string> takeFields();

  /// The text with all edits.
  std::string finish() const;

 private:
  struct Edit {
    std::size_t place;
    std::size_t length;
    std::string text;
  };

  void replaceScalar(const YAML::Node& scalar, const std::string& text);
  void replaceList(const YAML::Node& list, bool in_braces, const std::string& text,
                   const std::string& comment);
  // A line for a key that the group lacks; adds the group where it is missing.
  void add(const std::string& group, const std::string& line);
  void insert(const YAML::Node& group, const std::string& name, const std::string& line);

  std::string text_;
  std::string source_;
  YAML::Node root_;
  std::vector<Edit> edits_;
  std::vector<std::string> changes_;
  std::vector<std::string> fields_;
  /// Groups that the text lacks, in their order, with their lines.
  std::vector<std::pair<std::string, std::string>> added_groups_;
};

/// A number in eight digits, as it is written into files.
std::string eightDigits(double value);

}  // namespace polyfly
