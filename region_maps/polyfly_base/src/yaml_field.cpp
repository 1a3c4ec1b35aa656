#include "polyfly_base/yaml_field.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "polyfly_base/decimal.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/load_yaml.hpp"
#include "polyfly_base/read_text.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMaxNameLength = 63;
constexpr double kSymmetryTolerance = 1e-12;  // relative to the greatest entry

std::string format(const std::string& source, int line, const std::string& field, const std::string& rule) {
  return source + ":" + std::to_string(line) + ": " + field + ": " + rule;
}

std::string quoted(const std::string& text) { return "'" + text + "'"; }

bool contains(std::initializer_list<const char*> keys, const std::string& key) {
  return std::any_of(keys.begin(), keys.end(), [&](const char* known) { return key == known; });
}

std::string list(std::initializer_list<const char*> required, std::initializer_list<const char*> optional) {
  std::string text;
  for (const auto& keys : {required, optional}) {
    for (const char* key : keys) text += (text.empty() ? "" : ", ") + std::string(key);
  }
  return text;
}

}  // namespace

YamlField::YamlField(const YAML::Node& node, std::string source, std::string path, int line)
    : node_(node), source_(std::move(source)), path_(std::move(path)), line_(line) {
  // An empty value carries the mark of whatever follows it; the line of its key is the useful one.
  if (!node_.IsNull() && node_.Mark().line >= 0) line_ = node_.Mark().line + 1;
}

YamlField YamlField::parse(const std::string& text, const std::string& source) {
  const YAML::Node root = loadYaml(text, source);
  if (root.IsNull()) throw Error(format(source, 1, "file", "must not be empty"));
  return YamlField(root, source, "", 1);
}

void YamlField::checkKeys(std::initializer_list<const char*> required,
                          std::initializer_list<const char*> optional) const {
  if (!node_.IsMap()) fail("must be a map with the keys " + list(required, optional));
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    const int line = std::max(entry.first.Mark().line, 0) + 1;
    if (!entry.first.IsScalar())
      throw Error(format(source_, line, path_.empty() ? "file" : path_, "keys must be plain names"));
    const std::string key = entry.first.Scalar();
    const std::string field = path_.empty() ? key : path_ + "." + key;
    if (!contains(required, key) && !contains(optional, key)) {
      throw Error(format(source_, line, field, "unknown key; known are " + list(required, optional)));
    }
    if (!seen.insert(key).second) throw Error(format(source_, line, field, "duplicate key"));
  }
  for (const char* key : required) {
    if (seen.count(key) == 0) failAt(key, "missing");
  }
}

bool YamlField::has(const std::string& key) const {
  if (!node_.IsMap()) return false;
  return std::any_of(node_.begin(), node_.end(), [&](const auto& entry) {
    return entry.first.IsScalar() && entry.first.Scalar() == key;
  });
}

YamlField YamlField::at(const std::string& key) const {
  if (node_.IsMap()) {
    for (const auto& entry : node_) {
      if (!entry.first.IsScalar() || entry.first.Scalar() != key) continue;
      const std::string path = path_.empty() ? key : path_ + "." + key;
      return YamlField(entry.second, source_, path, std::max(entry.first.Mark().line, 0) + 1);
    }
  }
  failAt(key, "missing");
}

bool YamlField::isList() const { return node_.IsSequence(); }

std::vector<std::string> YamlField::keys() const {
  std::vector<std::string> names;
  if (!node_.IsMap()) return names;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) fail("keys must be plain names");
    names.push_back(entry.first.Scalar());
  }
  return names;
}

std::vector<YamlField> YamlField::items() const {
  if (!node_.IsSequence()) fail("must be a list");
  std::vector<YamlField> fields;
  for (std::size_t i = 0; i < node_.size(); ++i) {
    fields.push_back(YamlField(node_[i], source_, path_ + "[" + std::to_string(i) + "]", line_));
  }
  return fields;
}

std::string YamlField::text() const {
  if (!node_.IsScalar()) fail("must be text");
  if (node_.Scalar().empty()) fail("must not be empty");
  return node_.Scalar();
}

std::string YamlField::name() const {
  std::string value = text();
  const auto inner = [](unsigned char c) { return c < 128 && (std::isalnum(c) != 0 || c == '_'); };
  const bool valid = std::all_of(value.begin(), value.end(), inner) &&
                     std::isdigit(static_cast<unsigned char>(value.front())) == 0;
  if (!valid) fail("must consist of letters, digits and _ and not begin with a digit, got " + quoted(value));
  if (value.size() > kMaxNameLength) {
    fail("must not exceed " + std::to_string(kMaxNameLength) + " characters");
  }
  return value;
}

std::string YamlField::unit() const {
  std::string value = text();
  const auto printable = [](unsigned char c) { return c > ' ' && c < 127; };
  if (!std::all_of(value.begin(), value.end(), printable) || value.size() > kMaxNameLength) {
    fail("must be a unit in ASCII without spaces, such as m/s^2, got " + quoted(value));
  }
  return value;
}

double YamlField::number() const {
  if (!node_.IsScalar() || node_.Tag() == "!") fail("must be a number");  // "!" marks a quoted scalar
  const std::string& scalar = node_.Scalar();
  const std::optional<double> value = decimalNumber(scalar);
  if (!value) fail("must be a finite number, got " + quoted(scalar) + kDecimalRule);
  if (std::abs(*value) > kGreatestNumber) {
    std::ostringstream rule;
    rule << "must not exceed " << kGreatestNumber << " in size, got " << *value;
    fail(rule.str());
  }
  return *value;
}

int YamlField::integer(int least, int greatest) const {
  const double value = number();
  if (value != std::floor(value) || value < least || value > greatest) {
    fail("must be a whole number from " + std::to_string(least) + " to " + std::to_string(greatest) +
         ", got " + node_.Scalar());
  }
  return static_cast<int>(value);
}

void YamlField::range(double* lower, double* upper) const {
  const std::vector<YamlField> ends = items();
  if (ends.size() != 2) fail("must be [lower, upper]");
  *lower = ends[0].number();
  *upper = ends[1].number();
  if (!(*lower < *upper)) fail("lower end must be below the upper end");
}

Eigen::MatrixXd YamlField::matrix(int rows, int cols) const {
  const std::string shape =
      "must have " + std::to_string(rows) + " rows of " + std::to_string(cols) + " numbers";
  const std::vector<YamlField> lines = items();
  if (static_cast<int>(lines.size()) != rows) fail(shape + ", got " + std::to_string(lines.size()) + " rows");
  Eigen::MatrixXd value(rows, cols);
  for (int row = 0; row < rows; ++row) {
    const YamlField& line = lines[static_cast<std::size_t>(row)];
    if (!line.node_.IsSequence()) line.fail("must be a list of " + std::to_string(cols) + " numbers");
    const std::vector<YamlField> entries = line.items();
    if (static_cast<int>(entries.size()) != cols) {
      line.fail("must have " + std::to_string(cols) + " numbers, got " + std::to_string(entries.size()));
    }
    for (int col = 0; col < cols; ++col) value(row, col) = entries[static_cast<std::size_t>(col)].number();
  }
  return value;
}

Eigen::MatrixXd YamlField::weight(int size) const {
  const std::vector<YamlField> entries = items();
  const bool nested = !entries.empty() && entries.front().node_.IsSequence();
  if (nested) {
    const Eigen::MatrixXd full = matrix(size, size);
    const double scale = full.cwiseAbs().maxCoeff();
    if ((full - full.transpose()).cwiseAbs().maxCoeff() > kSymmetryTolerance * scale)
      fail("must be symmetric");
    return 0.5 * (full + full.transpose());
  }
  if (static_cast<int>(entries.size()) != size) {
    fail("must have " + std::to_string(size) + " diagonal entries or rows, got " +
         std::to_string(entries.size()));
  }
  Eigen::MatrixXd value = Eigen::MatrixXd::Zero(size, size);
  for (int i = 0; i < size; ++i) value(i, i) = entries[static_cast<std::size_t>(i)].number();
  return value;
}

void YamlField::fail(const std::string& rule) const {
  throw Error(format(source_, line_, path_.empty() ? "file" : path_, rule));
}

void YamlField::failAt(const std::string& field, const std::string& rule) const {
  throw Error(format(source_, line_, path_.empty() ? field : path_ + "." + field, rule));
}

}  // namespace polyfly
