#include "json_problem.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

namespace checker {

std::vector<double> jsonNumbers(const std::string& text, const std::string& key) {
  std::vector<double> numbers;
  int depth = 0;
  bool wanted = false, found = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '"') {
      const std::size_t first = at + 1;
      for (++at; at < text.size() && text[at] != '"'; ++at) at += text[at] == '\\' ? 1 : 0;
      const std::size_t colon = text.find_first_not_of(" \t\r\n", at + 1);
      if (depth != 1 || colon == std::string::npos || text[colon] != ':') continue;
      const std::string name = text.substr(first, at - first);
      require(name.find('\\') == std::string::npos, "problem: a key has a backslash");
      wanted = name == key;
      require(!wanted || !found, "problem: " + key + " is given twice");
      found = found || wanted;
    } else if (c == '{' || c == '[') {
      ++depth;
    } else if (c == '}' || c == ']') {
      --depth;
    } else if (wanted && (c == '-' || (c >= '0' && c <= '9'))) {
      // Of JSON's digits only: strtod alone would read 0x10 too.
      const std::string digits = text.substr(at, text.find_first_not_of("+-.0123456789eE", at) - at);
      const std::size_t first = c == '-' ? 1 : 0;
      const bool leads =
          digits.size() > first + 1 && digits[first] == '0' && std::isdigit(digits[first + 1]) != 0;
      char* end = nullptr;
      const double number = std::strtod(digits.c_str(), &end);
      require(!leads && *end == '\0' && std::isfinite(number), key + ": not a finite number");
      numbers.push_back(number);
      at += digits.size() - 1;
    }
  }
  return numbers;
}

namespace {

/// Whole numbers below `limit` behind a key.
std::vector<std::size_t> jsonPlaces(const std::string& text, const std::string& key, std::size_t limit) {
  std::vector<std::size_t> places;
  for (const double number : jsonNumbers(text, key)) {
    require(number >= 0.0 && number < static_cast<double>(limit) && number == std::floor(number),
            key + " names what is not there");
    places.push_back(static_cast<std::size_t>(number));
  }
  return places;
}

}  // namespace

void compareNumbers(const std::string& problem, const Matrices& program,
                    const std::set<std::size_t>& equalities) {
  const auto compare = [&](const std::string& key, const std::string& name,
                           const std::vector<double>& wanted) {
    const Vector& entries = program.at(name).entries;
    require(std::equal(wanted.begin(), wanted.end(), entries.begin(), entries.end(),
                       [](double number, const Fraction& value) { return Fraction(number) == value; }),
            key + " is not that of the problem file");
  };
  for (const char* key : {"H", "f", "F", "A", "b", "A_theta", "b_theta"})
    compare(key, key, jsonNumbers(problem, key));
  compare("B", "S", jsonNumbers(problem, "B"));
  const std::vector<double> lower = jsonNumbers(problem, "lb"), upper = jsonNumbers(problem, "ub");
  require(lower.size() == upper.size(), "lb and ub are not of one length");
  std::vector<double> box;
  for (std::size_t j = 0; j < lower.size(); ++j) box.insert(box.end(), {lower[j], upper[j]});
  compare("lb or ub", "box", box);
  const std::vector<std::size_t> rows = jsonPlaces(problem, "eq_ids", program.at("A").rows);
  require(std::set<std::size_t>(rows.begin(), rows.end()) == equalities,
          "eq_ids is not that of the problem file");
  if (!jsonNumbers(problem, "E").empty()) {
    for (const char* key : {"E", "C", "c"}) compare(key, key, jsonNumbers(problem, key));
    return;
  }
  // Without E, u are the entries of z that `out` names; without that too, all of z. Nothing is added.
  const std::size_t n = program.at("E").columns;
  std::vector<std::size_t> out = jsonPlaces(problem, "out", n);
  for (std::size_t j = 0; out.size() == j && j < n; ++j) out.push_back(j);
  std::vector<double> E(out.size() * n);
  for (std::size_t i = 0; i < out.size(); ++i) E[i * n + out[i]] = 1.0;
  compare("out", "E", E);
  for (const char* name : {"C", "c"})
    compare("out", name, std::vector<double>(program.at(name).entries.size()));
}

void compareProblem(const Certificate& certificate, const Map& map, const std::string& problem) {
  require(problem == map.problem, "the problem file is not the one that the map was made from");
  if (map.kind() == "json") compareNumbers(problem, certificate.program(), certificate.equalities());
}

}  // namespace checker
