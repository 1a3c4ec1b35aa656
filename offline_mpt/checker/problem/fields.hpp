#pragma once

#include <yaml-cpp/yaml.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/program.hpp"

/// Fields of problem files. Numbers are doubles at their exact values. All throw Refused.
namespace checker {

/// The document of a text without control characters, and without ':' right before ']' or the end. Throws YAML::Exception on
/// what is no YAML.
YAML::Node documentOf(const std::string& text);

/// The node is a map of some of these keys, each once.
void requireKeys(const YAML::Node& node, const std::set<std::string>& known);

/// One of several words; the first where there is none.
std::size_t choiceOf(const YAML::Node& node, const std::vector<std::string>& words);

/// A finite number in decimal digits, which no zero leads: readers of YAML disagree on 010.
double numberOf(const YAML::Node& node);
double numberOf(const std::string& text);
/// Such a number that is whole: 8 and 8.0 are 8.
std::size_t countOf(const YAML::Node& node);
/// Two numbers.
std::pair<double, double> rangeOf(const YAML::Node& node);

/// How a file's numbers count.
using ReadNumber = Fraction (*)(const YAML::Node&);
/// As its double.
Fraction doubleOf(const YAML::Node& node);
Matrix matrixOf(const YAML::Node& node, std::size_t rows, std::size_t columns, ReadNumber read = doubleOf);
/// A matrix, or its diagonal.
Matrix weightOf(const YAML::Node& node, std::size_t size, ReadNumber read = doubleOf);
/// A column.
Matrix columnOf(const YAML::Node& node, std::size_t rows);

/// The file is of this type and of version 1, with some of these keys.
void requireHead(const YAML::Node& root, const std::string& type, const std::set<std::string>& known);

/// What `use` makes of the document of a text. Refuses what is no YAML.
template <class Use>
auto withDocument(const std::string& text, const Use& use) {
  try {
    return use(documentOf(text));
  } catch (const YAML::Exception& error) {
    throw Refused(std::string("problem: ") + error.what());
  }
}

}  // namespace checker
