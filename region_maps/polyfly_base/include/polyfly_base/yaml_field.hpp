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
  YamlField at(const std::string& key) const;  ///< fails when the key is absent

  bool isList() const;
  std::vector<YamlField> items() const;  ///< elements of a sequence
  std::string text() const;              ///< a non-empty scalar
  std::string name() const;              ///< an identifier: letter or _, then letters, digits, _
  std::string unit() const;              ///< a unit without spaces, such as m/s^2; 1 if dimensionless
  double number() const;                 ///< finite, at most kGreatestNumber in size
  int integer(int least, int greatest) const;
  void range(double* lower, double* upper) const;  ///< [lower, upper], finite, lower < upper

  Eigen::MatrixXd matrix(int rows, int cols) const;  ///< list of rows
  Eigen::MatrixXd weight(int size) const;  ///< symmetric, either a list of rows or the diagonal alone

  [[noreturn]] void fail(const std::string& rule) const;
  [[noreturn]] void failAt(const std::string& field, const std::string& rule) const;  ///< of a member of this

 private:
  YamlField(const YAML::Node& node, std::string source, std::string path, int line);

  YAML::Node node_;
  std::string source_;
  std::string path_;  ///< such as parameters[2].unit
  int line_ = 1;
};

}  // namespace polyfly
