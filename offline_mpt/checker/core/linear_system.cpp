#include "core/linear_system.hpp"

#include <utility>

namespace checker {

Integer solveSystem(std::vector<Row>& system, std::size_t required) {
  const std::size_t size = system.size();
  Integer previous(1);
  // The unknown that each row determines.
  std::vector<std::size_t> unknown_of;
  for (std::size_t column = 0; column < size; ++column) {
    const std::size_t k = unknown_of.size();
    std::size_t pivot = size;
    for (std::size_t i = k; i < size; ++i) {
      if (system[i][column] != 0 &&
          (pivot == size || cmp(abs(system[i][column]), abs(system[pivot][column])) < 0))
        pivot = i;
    }
    require(pivot < size || column >= required, "the conditions of optimality have no unique solution");
    if (pivot == size) continue;
    std::swap(system[k], system[pivot]);
    unknown_of.push_back(column);
    for (std::size_t i = 0; i < size; ++i) {
      if (i == k) continue;
      const Integer factor = system[i][column];
      if (factor == 0 && system[k][column] == previous) continue;
      for (std::size_t j = column; j < system[i].size(); ++j) {
        system[i][j] *= system[k][column];
        system[i][j] -= factor * system[k][j];
        mpz_divexact(system[i][j].get_mpz_t(), system[i][j].get_mpz_t(), previous.get_mpz_t());
      }
    }
    previous = system[k][column];
  }
  for (std::size_t i = unknown_of.size(); i < size; ++i) {
    for (const Integer& value : system[i])
      require(value == 0, "the cost is not in the span of the active rows");
  }
  std::vector<Row> solution(size, Row(system.empty() ? 0 : system[0].size()));
  for (std::size_t k = 0; k < unknown_of.size(); ++k) {
    solution[unknown_of[k]] = std::move(system[k]);
    for (Integer& value : solution[unknown_of[k]]) value *= sgn(previous);
  }
  system = std::move(solution);
  return abs(previous);
}

}  // namespace checker
