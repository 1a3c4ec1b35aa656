#include "exact_linear.hpp"

#include <algorithm>
#include <utility>

namespace polyfly {
namespace {

// row * pivot - factor * pivot_row, divided by the pivot before it: exact (Bareiss, 1968).
void eliminate(std::vector<Integer>& row, const std::vector<Integer>& pivot_row, std::size_t column,
               const Integer& previous) {
  const Integer factor = row[column];
  const Integer& pivot = pivot_row[column];
  for (std::size_t j = column; j < row.size(); ++j) {
    mpz_mul(row[j].get_mpz_t(), row[j].get_mpz_t(), pivot.get_mpz_t());
    if (factor != 0) mpz_submul(row[j].get_mpz_t(), factor.get_mpz_t(), pivot_row[j].get_mpz_t());
    if (previous != 1) mpz_divexact(row[j].get_mpz_t(), row[j].get_mpz_t(), previous.get_mpz_t());
  }
}

/// The row from `rank` on that has an entry in the column, and the fewest others; the number of rows if there is none.
std::size_t sparsestRow(const std::vector<std::vector<Integer>>& rows, std::size_t rank, std::size_t column) {
  std::size_t chosen = rows.size(), fewest = 0;
  for (std::size_t i = rank; i < rows.size(); ++i) {
    if (rows[i][column] == 0) continue;
    const auto entries = static_cast<std::size_t>(
        std::count_if(rows[i].begin(), rows[i].end(), [](const Integer& value) { return value != 0; }));
    if (chosen == rows.size() || entries < fewest) {
      chosen = i;
      fewest = entries;
    }
  }
  return chosen;
}

}  // namespace

IntegerSolution solveIntegers(std::vector<std::vector<Integer>> rows, int unknowns) {
  IntegerSolution solution;
  const auto n = static_cast<std::size_t>(unknowns);
  std::vector<std::size_t> pivot_columns;
  Integer previous(1);
  for (std::size_t column = 0; column < n; ++column) {
    const std::size_t rank = pivot_columns.size();
    const std::size_t chosen = sparsestRow(rows, rank, column);
    if (chosen == rows.size()) {
      solution.unique = false;
      continue;
    }
    std::swap(rows[rank], rows[chosen]);
    for (std::size_t i = rank + 1; i < rows.size(); ++i) eliminate(rows[i], rows[rank], column, previous);
    previous = rows[rank][column];
    pivot_columns.push_back(column);
  }
  const std::size_t rank = pivot_columns.size();
  for (std::size_t i = rank; i < rows.size(); ++i)
    solution.consistent = solution.consistent && rows[i][n] == 0;
  // The last pivot is the determinant of the rows and columns of the pivots. So by Cramer's rule it is a denominator of
  // all unknowns, and each division is exact. Unknowns without a pivot are 0.
  solution.x.denominator = previous;
  solution.x.numerators.resize(n);
  for (std::size_t k = rank; k-- > 0;) {
    Integer sum = previous * rows[k][n];
    for (std::size_t j = k + 1; j < rank; ++j)
      sum -= rows[k][pivot_columns[j]] * solution.x.numerators[pivot_columns[j]];
    mpz_divexact(solution.x.numerators[pivot_columns[k]].get_mpz_t(), sum.get_mpz_t(),
                 rows[k][pivot_columns[k]].get_mpz_t());
  }
  if (previous < 0) {
    solution.x.denominator = -previous;
    for (Integer& value : solution.x.numerators) value = -value;
  }
  return solution;
}

}  // namespace polyfly
