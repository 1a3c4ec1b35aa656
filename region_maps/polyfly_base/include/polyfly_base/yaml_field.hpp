#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <initializer_list>
#include <string>
#include <vector>

namespace polyfly {

/// One value of a YAML file that knows where it stands, so that every complaint reads `file:line: field:
/// rule`. All members throw Error in that form.
class YamlField {
 public:
  /// The one document in `text`.
  static YamlField parse(const std::string& text, const std::string& source);

  /// This must be a map that has every required key, no key twice, and none but the given ones.
  void checkKeys(std::initializer_list<const char*> required,
                 std::initializer_list<const char*> optional) const;

  bool has(const std::string& key) const;
  /// Throws Error when the key is absent.
  YamlField at(const std::string& key) const;

  bool isList() const;
  /// Keys of a map in their order, duplicates too; none for any other value.
  std::vector<std::string> keys() const;
  /// Elements of a sequence.
  std::vector<YamlField> items() const;
  /// A non-empty scalar.
  std::string text() const;
  /// An identifier: letter or _, then letters, digits, _.
  std::string name() const;
  /// A unit without spaces, such as m/s^2. It is 1 if dimensionless.
  std::string unit() const;
  /// A finite number, at most kGreatestNumber in size.
  double number() const;
  int integer(int least, int greatest) const;
  /// A range [lower, upper], finite, lower < upper.
  void range(double* lower, double* upper) const;

  /// A matrix, given as a list of rows.
  Eigen::MatrixXd matrix(int rows, int cols) const;
  /// A symmetric matrix, given as a list of rows or as the diagonal alone.
  Eigen::MatrixXd weight(int size) const;

  [[noreturn]] void fail(const std::string& rule) const;
  /// Fails for member `field` of this value.
  [[noreturn]] void failAt(const std::string& field, const std::string& rule) const;

 private:
  YamlField(const YAML::Node& node, std::string source, std::string path, int line);

  YAML::Node node_;
  std::string source_;
  /// Path of the field, such as parameters[2].unit.
  std::string path_;
  int line_ = 1;
};

}  // namespace polyfly
