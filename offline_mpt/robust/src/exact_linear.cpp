#include "exact_linear.hpp"

#include <utility>

namespace polyfly {
namespace {

// row * pivot - factor * pivot_row, divided by the pivot before it: exact (Bareiss, 1968).
void eliminate(std::vector<Integer>& row, const std::vector<Integer>& pivot_row, std::size_t column,
               const Integer& previous) {
  const Integer factor = row[column];
  const Integer& pivot = pivot_row[column];
  for (std::size_t j = 0; j < row.size(); ++j) {
    mpz_mul(row[j].get_mpz_t(), row[j].get_mpz_t(), pivot.get_mpz_t());
    if (factor != 0) mpz_submul(row[j].get_mpz_t(), factor.get_mpz_t(), pivot_row[j].get_mpz_t());
    if (previous != 1) mpz_divexact(row[j].get_mpz_t(), row[j].get_mpz_t(), previous.get_mpz_t());
  }
}

}  // namespace

IntegerSolution solveIntegers(std::vector<std::vector<Integer>> rows, int unknowns) {
  IntegerSolution solution;
  const auto n = static_cast<std::size_t>(unknowns);
  std::vector<std::size_t> pivot_columns;
  Integer previous(1);
  std::size_t rank = 0;
  for (std::size_t column = 0; column < n; ++column) {
    std::size_t chosen = rank;
    while (chosen < rows.size() && rows[chosen][column] == 0) ++chosen;
    if (chosen == rows.size()) {
      solution.unique = false;
      continue;
    }
    std::swap(rows[rank], rows[chosen]);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (i != rank) eliminate(rows[i], rows[rank], column, previous);
    }
    previous = rows[rank][column];
    pivot_columns.push_back(column);
    ++rank;
  }
  for (std::size_t i = rank; i < rows.size(); ++i)
    solution.consistent = solution.consistent && rows[i][n] == 0;
  // after elimination above and below, every pivot is the same number
  solution.x.denominator = previous;
  solution.x.numerators.resize(n);
  for (std::size_t k = 0; k < rank; ++k) solution.x.numerators[pivot_columns[k]] = rows[k][n];
  if (previous < 0) {
    solution.x.denominator = -previous;
    for (Integer& value : solution.x.numerators) value = -value;
  }
  return solution;
}

}  // namespace polyfly
