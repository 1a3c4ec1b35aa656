#include "core/program.hpp"

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

}  // namespace checker
