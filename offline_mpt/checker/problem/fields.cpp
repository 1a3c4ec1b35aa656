#include "problem/fields.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/text.hpp"

namespace checker {
namespace {

constexpr double kGreatestCount = 1e9;

}  // namespace

// On these characters yaml-cpp ends too early, or its version 0.6 never.
YAML::Node documentOf(const std::string& text) {
  for (const char c : text)
    require(static_cast<unsigned char>(c) >= ' ' || c == '\t' || c == '\n' || c == '\r',
            "problem: has a control character");
  require((text + ']').find(":]") == std::string::npos, "problem: has ':' right before ']' or the end");
  return YAML::Load(text);
}

void requireKeys(const YAML::Node& node, const std::set<std::string>& known) {
  require(node.IsMap(), "problem: an entry has no keys");
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const auto key = entry.first.as<std::string>();
    require(known.count(key) > 0, "problem: " + key + " is not known to this checker");
    require(seen.insert(key).second, "problem: " + key + " is given twice");
  }
}

std::size_t choiceOf(const YAML::Node& node, const std::vector<std::string>& words) {
  if (!node) return 0;
  const auto at = std::find(words.begin(), words.end(), node.as<std::string>());
  require(at != words.end(), "problem: " + node.as<std::string>() + " is not known to this checker");
  return static_cast<std::size_t>(at - words.begin());
}

double numberOf(const std::string& text) {
  require(isDecimal(text), "problem: " + text + " is no number in decimal digits without leading zeros");
  const double value = std::strtod(text.c_str(), nullptr);
  require(std::isfinite(value), "problem: a number is not finite");
  return value;
}

double numberOf(const YAML::Node& node) {
  require(node.IsScalar() && node.Tag() != "!", "problem: a number is missing");  // "!": in quotes
  return numberOf(node.Scalar());
}

std::size_t countOf(const YAML::Node& node) {
  const double value = numberOf(node);
  require(value >= 0.0 && value <= kGreatestCount && value == std::floor(value),
          "problem: " + node.Scalar() + " is no whole number in range");
  return static_cast<std::size_t>(value);
}

std::pair<double, double> rangeOf(const YAML::Node& node) {
  require(node.IsSequence() && node.size() == 2, "problem: a range has two numbers");
  return {numberOf(node[0]), numberOf(node[1])};
}

Fraction doubleOf(const YAML::Node& node) { return Fraction(numberOf(node)); }

Matrix matrixOf(const YAML::Node& node, std::size_t rows, std::size_t columns, ReadNumber read) {
  require(node.IsSequence() && node.size() == rows, "problem: a matrix has another size");
  Matrix result{rows, columns, {}};
  for (const auto& row : node) {
    require(row.IsSequence() && row.size() == columns, "problem: a matrix has another size");
    for (const auto& entry : row) result.entries.push_back(read(entry));
  }
  return result;
}

Matrix weightOf(const YAML::Node& node, std::size_t size, ReadNumber read) {
  require(node.IsSequence() && node.size() == size, "problem: a weight has another size");
  if (node[0].IsSequence()) return matrixOf(node, size, size, read);
  Matrix result{size, size, Vector(size * size)};
  for (std::size_t i = 0; i < size; ++i) result.entries[i * size + i] = read(node[i]);
  return result;
}

Matrix columnOf(const YAML::Node& node, std::size_t rows) {
  require(node.IsSequence() && node.size() == rows, "problem: a list has another size");
  Matrix result{rows, 1, {}};
  for (const auto& entry : node) result.entries.emplace_back(numberOf(entry));
  return result;
}

void requireHead(const YAML::Node& root, const std::string& type, const std::set<std::string>& known) {
  requireKeys(root, known);
  require(countOf(root["polyfly_problem"]) == 1, "problem: polyfly_problem: is another version");
  require(root["type"].as<std::string>() == type, "problem: is of no type " + type);
}

}  // namespace checker
