#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace polyfly {

/// A YAML text in which numbers are replaced, while all else stays as it is, comments too. All members
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

  std::string text_;
  std::string source_;
  YAML::Node root_;
  std::vector<Edit> edits_;
  std::vector<std::string> changes_;
  std::vector<std::string> fields_;
};

/// A number in eight digits, as it is written into files.
std::string eightDigits(double value);

}  // namespace polyfly
