#include "polyfly_base/options_text.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

#include "polyfly_base/provenance.hpp"

namespace polyfly {
namespace {

// Digits of any decimal number that a double keeps, and digits with which each double is read back as it was.
constexpr int kKeptDigits = 15;
constexpr int kExactDigits = 17;
constexpr int kIndent = 2;

std::string plain(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

std::string rangeComment(const char* unit, const Range& range) {
  const std::string name = unit;
  return (name.empty() ? "" : "[" + name + "] ") + plain(range.least) + " .. " + plain(range.greatest);
}

std::string listText(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + exactNumber(value);
  return text + "]";
}

}  // namespace

std::string exactNumber(double value) {
  std::array<char, 40> digits{};
  for (int count = kKeptDigits; count <= kExactDigits; ++count) {
    std::snprintf(digits.data(), digits.size(), "%.*g", count, value);
    if (std::strtod(digits.data(), nullptr) == value) break;
  }
  std::string text = digits.data();
  const std::size_t exponent = text.find('e');
  if (text.find('.') == std::string::npos)
    text.insert(exponent == std::string::npos ? text.size() : exponent, ".0");
  return text;
}

void OptionsText::operator()(const char* key, double value, const char* unit, const Range& range) {
  add(key, exactNumber(value), rangeComment(unit, range));
}

void OptionsText::operator()(const char* key, int value, const char* unit, const Range& range) {
  add(key, std::to_string(value), rangeComment(unit, range));
}

void OptionsText::operator()(const char* key, const std::vector<double>& values) {
  if (!values.empty()) add(key, listText(values), "");
}

void OptionsText::operator()(const char* key, const std::string& value) {
  if (!value.empty()) text(key, value);
}

void OptionsText::number(const std::string& key, double value) { add(key, exactNumber(value), ""); }

void OptionsText::text(const std::string& key, const std::string& value) { add(key, yamlString(value), ""); }

void OptionsText::matrix(const std::string& key, const std::vector<std::vector<double>>& rows) {
  std::string text = "[";
  for (const std::vector<double>& row : rows) text += (text.size() > 1 ? ", " : "") + listText(row);
  add(key, text + "]", "");
}

void OptionsText::add(const std::string& key, const std::string& value, const std::string& comment) {
  Level* level = &root_;
  for (std::size_t begin = 0; begin <= key.size();) {
    const std::size_t end = std::min(key.find('/', begin), key.size());
    const std::string name = key.substr(begin, end - begin);
    const auto known = std::find_if(level->members.begin(), level->members.end(),
                                    [&name](const Level& one) { return one.name == name; });
    level = known == level->members.end() ? &level->members.emplace_back(Level{name, "", "", {}}) : &*known;
    begin = end + 1;
  }
  level->value = value;
  level->comment = comment;
}

void OptionsText::write(const Level& level, int depth, std::string* out) {
  *out += std::string(static_cast<std::size_t>(kIndent * depth), ' ') + level.name + ":";
  if (!level.value.empty()) *out += " " + level.value;
  if (!level.comment.empty()) *out += "  # " + level.comment;
  *out += "\n";
  for (const Level& member : level.members) write(member, depth + 1, out);
}

std::string OptionsText::yaml() const {
  std::string out;
  for (const Level& member : root_.members) write(member, 0, &out);
  return out;
}

}  // namespace polyfly
