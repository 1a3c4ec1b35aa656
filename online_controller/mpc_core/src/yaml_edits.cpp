#include "mpc_core/yaml_edits.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <optional>
#include <sstream>

#include "polyfly_base/decimal.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/load_yaml.hpp"

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
    : text_(std::move(text)), source_(std::move(source)), root_(loadYaml(text_, source_)) {
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
  return text;
}

}  // namespace polyfly
