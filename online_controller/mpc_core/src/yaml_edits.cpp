#include "mpc_core/yaml_edits.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <optional>
#include <sstream>

#include "polyfly_base/decimal.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/provenance.hpp"

namespace polyfly {
namespace {

constexpr double kSameNumber = 1e-12;  // relative, of numbers that are written alike

}  // namespace

std::string eightDigits(double value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << std::setprecision(8) << value;
  return out.str();
}

YamlEdits::YamlEdits(std::string text, std::string source)
    : text_(std::move(text)), source_(std::move(source)) {
  try {
    root_ = YAML::Load(text_);
  } catch (const YAML::Exception& failure) {
    throw Error(source_ + ": is no YAML: " + failure.what());
  }
  if (!root_.IsMap()) throw Error(source_ + ": must be a map");
  if (root_.Style() == YAML::EmitterStyle::Flow) throw Error(source_ + ": must not begin with a brace");
}

void YamlEdits::refuse(const std::string& field, const std::string& rule) const {
  throw Error(source_ + ": " + field + ": " + rule);
}

double YamlEdits::numberOf(const YAML::Node& scalar, const std::string& field) const {
  const std::optional<double> value = scalar.IsScalar() ? decimalNumber(scalar.Scalar()) : std::nullopt;
  if (!value) refuse(field, std::string("must be a number") + kDecimalRule);
  return *value;
}

void YamlEdits::replaceScalar(const YAML::Node& scalar, const std::string& text) {
  const auto place = static_cast<std::size_t>(scalar.Mark().pos);
  const bool quoted = place < text_.size() && text_[place] == '"';
  const std::size_t end = quoted ? text_.find('"', place + 1) + 1
                                 : std::min(text_.find_first_of(",]} \t\r\n#", place), text_.size());
  edits_.push_back({place, end - place, text});
}

void YamlEdits::setNumber(const YAML::Node& scalar, const std::string& field, double value) {
  const double before = numberOf(scalar, field);
  fields_.push_back(field);
  if (std::abs(before - value) <= kSameNumber * std::abs(value)) return;
  replaceScalar(scalar, eightDigits(value));
  changes_.push_back(field + ": " + eightDigits(before) + " to " + eightDigits(value));
}

void YamlEdits::insert(const YAML::Node& group, const std::string& name, const std::string& line) {
  if (!group.IsMap()) refuse(name, "must be a map");
  if (group.Style() == YAML::EmitterStyle::Flow) {
    const auto brace = static_cast<std::size_t>(group.Mark().pos);
    edits_.push_back({brace + 1, 0, line + (group.size() > 0 ? ", " : "")});
    return;
  }
  // Before the first entry, with its indentation.
  const YAML::Mark first = group.begin()->first.Mark();
  const auto column = static_cast<std::size_t>(first.column);
  edits_.push_back({static_cast<std::size_t>(first.pos), 0, line + "\n" + std::string(column, ' ')});
}

void YamlEdits::putNumber(const std::string& group, const std::string& key, double value) {
  const std::string field = group + "/" + key;
  const YAML::Node map = root_[group];
  if (map && map.IsMap() && map[key]) return setNumber(map[key], field, value);
  fields_.push_back(field);
  changes_.push_back(field + ": " + eightDigits(value) + ", which was not stated");
  add(group, key + ": " + eightDigits(value));
}

void YamlEdits::add(const std::string& group, const std::string& line) {
  const YAML::Node map = root_[group];
  if (map) return insert(map, group, line);
  const auto known = std::find_if(added_groups_.begin(), added_groups_.end(),
                                  [&group](const auto& one) { return one.first == group; });
  if (known != added_groups_.end()) {
    known->second += "  " + line + "\n";
  } else {
    added_groups_.emplace_back(group, "  " + line + "\n");
  }
}

void YamlEdits::replaceList(const YAML::Node& list, bool in_braces, const std::string& text,
                            const std::string& comment) {
  const auto place = static_cast<std::size_t>(list.Mark().pos);
  const std::size_t bracket = text_.find(']', place);
  if (in_braces) {
    edits_.push_back({place, bracket + 1 - place, text});
    return;
  }
  const std::size_t end = std::min(text_.find_first_of("\r\n", bracket), text_.size());
  edits_.push_back({place, end - place, text + comment});
}

void YamlEdits::putNumbers(const std::string& group, const std::string& key,
                           const std::vector<double>& values, const std::string& comment) {
  const std::string field = group + "/" + key;
  std::string text;
  for (const double value : values) text += (text.empty() ? "[" : ", ") + eightDigits(value);
  text += "]";
  const std::string behind = comment.empty() ? "" : "  # " + comment;
  const YAML::Node map = root_[group];
  const bool in_braces = map && map.IsMap() && map.Style() == YAML::EmitterStyle::Flow;
  fields_.push_back(field);
  if (!(map && map.IsMap() && map[key])) {
    changes_.push_back(field + ": " + text + ", which was not stated");
    return add(group, key + ": " + text + (in_braces ? "" : behind));
  }
  const YAML::Node list = map[key];
  if (!list.IsSequence() || list.Style() != YAML::EmitterStyle::Flow)
    refuse(field, "must be a list in brackets");
  std::string before;
  for (const YAML::Node& value : list)
    before += (before.empty() ? "[" : ", ") + eightDigits(numberOf(value, field));
  before = before.empty() ? "[]" : before + "]";
  replaceList(list, in_braces, text, behind);
  if (before != text) changes_.push_back(field + ": " + before + " to " + text);
}

void YamlEdits::putFlag(const std::string& group, const std::string& key, bool value) {
  const std::string field = group + "/" + key;
  const std::string text = value ? "true" : "false";
  const YAML::Node map = root_[group];
  fields_.push_back(field);
  if (!(map && map.IsMap() && map[key])) {
    changes_.push_back(field + ": " + text + ", which was not stated");
    return add(group, key + ": " + text);
  }
  bool before = false;
  if (!YAML::convert<bool>::decode(map[key], before)) refuse(field, "must be true or false");
  if (before == value) return;
  replaceScalar(map[key], text);
  changes_.push_back(field + ": " + (before ? "true" : "false") + " to " + text);
}

void YamlEdits::putText(const std::string& key, const std::string& value) {
  const YAML::Node scalar = root_[key];
  if (!scalar) {
    added_groups_.emplace_back(key, yamlString(value));
    return;
  }
  if (!scalar.IsScalar() || scalar.Tag() != "!") refuse(key, "must be a text in double quotes");
  replaceScalar(scalar, yamlString(value));
}

std::vector<std::string> YamlEdits::takeFields() {
  std::vector<std::string> fields;
  fields.swap(fields_);
  return fields;
}

std::string YamlEdits::finish() const {
  std::vector<Edit> edits = edits_;
  // Behind first; of those at one place the later one goes in first, so that the order is that of the calls.
  std::reverse(edits.begin(), edits.end());
  std::stable_sort(edits.begin(), edits.end(),
                   [](const Edit& one, const Edit& other) { return one.place > other.place; });
  std::string text = text_;
  for (const Edit& edit : edits) text.replace(edit.place, edit.length, edit.text);
  if (!text.empty() && text.back() != '\n') text += "\n";
  for (const auto& [name, lines] : added_groups_)
    text += name + (lines.front() == '"' ? ": " + lines + "\n" : ":\n" + lines);
  return text;
}

}  // namespace polyfly
