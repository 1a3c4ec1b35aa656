#include "core/program.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace checker {

Matrix readMatrix(Line& line, const std::string& key) {
  Matrix matrix;
  matrix.rows = line.count(kMany);
  matrix.columns = line.count(kMany);
  while (!line.done()) matrix.entries.push_back(line.real());
  require(matrix.entries.size() == matrix.rows * matrix.columns, key + ": its size is not as stated");
  return matrix;
}

void requireSizes(const Matrices& data, std::size_t n, std::size_t m, std::size_t p, std::size_t q) {
  const auto of = [&](const std::string& name) -> const Matrix& {
    const auto at = data.find(name);
    require(at != data.end(), name + " is missing");
    return at->second;
  };
  const std::size_t k = of("A_theta").rows;
  const std::map<std::string, std::pair<std::size_t, std::size_t>> sizes = {
      {"box", {p, 2}}, {"H", {n, n}},       {"f", {n, 1}},       {"F", {n, p}}, {"A", {m, n}}, {"b", {m, 1}},
      {"S", {m, p}},   {"A_theta", {k, p}}, {"b_theta", {k, 1}}, {"E", {q, n}}, {"C", {q, p}}, {"c", {q, 1}}};
  for (const auto& [name, size] : sizes)
    require(of(name).rows == size.first && of(name).columns == size.second, name + ": its size does not fit");
  require(data.size() == sizes.size(), "an unknown line");
}

std::vector<double> jsonNumbers(const std::string& text, const std::string& key) {
  std::vector<double> numbers;
  int depth = 0;
  bool wanted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '"') {
      const std::size_t first = at + 1;
      for (++at; at < text.size() && text[at] != '"'; ++at) at += text[at] == '\\' ? 1 : 0;
      const std::size_t colon = text.find_first_not_of(" \t\r\n", at + 1);
      const bool is_key = depth == 1 && colon != std::string::npos && text[colon] == ':';
      if (is_key) wanted = text.compare(first, at - first, key) == 0;
    } else if (c == '{' || c == '[') {
      ++depth;
    } else if (c == '}' || c == ']') {
      --depth;
    } else if (wanted && (c == '-' || (c >= '0' && c <= '9'))) {
      char* end = nullptr;
      const double number = std::strtod(text.c_str() + at, &end);
      require(end != text.c_str() + at && std::isfinite(number), key + ": not a finite number");
      numbers.push_back(number);
      at = static_cast<std::size_t>(end - text.c_str()) - 1;
    }
  }
  return numbers;
}

void compareNumbers(const std::string& problem, const Matrices& program,
                    const std::set<std::size_t>& equalities) {
  const auto given = [&](const std::string& name) -> const Matrix& { return program.at(name); };
  const auto compare = [&](const std::string& key, const Vector& values) {
    const std::vector<double> numbers = jsonNumbers(problem, key);
    require(numbers.size() == values.size() &&
                std::equal(numbers.begin(), numbers.end(), values.begin(),
                           [](double number, const Fraction& value) { return Fraction(number) == value; }),
            key + " is not that of the problem file");
  };
  for (const char* key : {"H", "f", "F", "A", "b", "A_theta", "b_theta"}) compare(key, given(key).entries);
  compare("B", given("S").entries);
  Vector lower, upper;
  for (std::size_t j = 0; j < given("box").rows; ++j) {
    lower.push_back(given("box").at(j, 0));
    upper.push_back(given("box").at(j, 1));
  }
  compare("lb", lower);
  compare("ub", upper);
  const std::vector<double> ids = jsonNumbers(problem, "eq_ids");
  const auto is_row = [&](double id) {
    return id >= 0.0 && id < static_cast<double>(given("A").rows) && id == std::floor(id);
  };
  require(std::all_of(ids.begin(), ids.end(), is_row), "eq_ids names no rows");
  require(std::set<std::size_t>(ids.begin(), ids.end()) == equalities,
          "eq_ids is not that of the problem file");
  const Matrix& E = given("E");
  if (!jsonNumbers(problem, "E").empty()) {
    for (const char* key : {"E", "C", "c"}) compare(key, given(key).entries);
    return;
  }
  std::vector<double> out = jsonNumbers(problem, "out");
  for (std::size_t i = out.size(); out.size() == i && i < E.rows && jsonNumbers(problem, "out").empty(); ++i)
    out.push_back(static_cast<double>(i));
  require(out.size() == E.rows, "out is not that of the problem file");
  for (std::size_t i = 0; i < E.rows; ++i) {
    for (std::size_t j = 0; j < E.columns; ++j)
      require(E.at(i, j) == (static_cast<double>(j) == out[i] ? 1 : 0),
              "out is not that of the problem file");
  }
}

}  // namespace checker
