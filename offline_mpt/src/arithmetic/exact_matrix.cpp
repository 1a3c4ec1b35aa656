#include "arithmetic/exact_matrix.hpp"

#include <algorithm>
#include <limits>

namespace polyfly {
namespace {

// target = (target * pivot - factor * source) / previous, which leaves no remainder.
void eliminate(Integer& target, const Integer& pivot, const Integer& factor, const Integer& source,
               const Integer& previous, Integer& work) {
  mpz_mul(work.get_mpz_t(), factor.get_mpz_t(), source.get_mpz_t());
  mpz_mul(target.get_mpz_t(), target.get_mpz_t(), pivot.get_mpz_t());
  mpz_sub(target.get_mpz_t(), target.get_mpz_t(), work.get_mpz_t());
  if (previous != 1) mpz_divexact(target.get_mpz_t(), target.get_mpz_t(), previous.get_mpz_t());
}

/// What is left to do of M X = R.
struct Elimination {
  explicit Elimination(const IntegerMatrix& system)
      : size(system.rows()), row_of(size, -1), row_used(size, 0), columns_left(system.columns()) {
    for (int j = 0; j < system.columns(); ++j) columns_left[j] = j;
  }

  int size;
  std::vector<int> row_of;  // pivot row of each column
  std::vector<char> row_used;
  std::vector<int> columns_left;  // not yet eliminated, right-hand sides included
};

// The entry of M of fewest bits: with bounds among the constraints most pivots are 1, and numbers stay small.
bool choosePivot(const IntegerMatrix& system, const Elimination& state, int& row, int& column) {
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (int i = 0; i < state.size; ++i) {
    if (state.row_used[i]) continue;
    for (const int j : state.columns_left) {
      if (j >= state.size || system(i, j) == 0) continue;
      const std::size_t bits = mpz_sizeinbase(system(i, j).get_mpz_t(), 2);
      if (bits >= fewest) continue;
      fewest = bits;
      row = i;
      column = j;
    }
  }
  return fewest != std::numeric_limits<std::size_t>::max();
}

}  // namespace

bool solveExactly(IntegerMatrix& system, Integer& determinant) {
  Elimination state(system);
  Integer previous(1), work, pivot, factor;
  for (int step = 0; step < state.size; ++step) {
    int row = 0, column = 0;
    if (!choosePivot(system, state, row, column)) return false;
    state.row_used[row] = 1;
    state.row_of[column] = row;
    state.columns_left.erase(std::find(state.columns_left.begin(), state.columns_left.end(), column));
    pivot = system(row, column);
    for (int i = 0; i < state.size; ++i) {
      if (i == row) continue;
      factor = system(i, column);
      if (factor == 0 && pivot == previous) continue;
      for (const int j : state.columns_left) {
        if (system(i, j) == 0 && (factor == 0 || system(row, j) == 0)) continue;
        eliminate(system(i, j), pivot, factor, system(row, j), previous, work);
      }
    }
    previous = pivot;
  }
  // Rows now read previous * x = right-hand side, in the order of the pivots.
  IntegerMatrix solution(state.size, system.columns());
  for (int column = 0; column < state.size; ++column) {
    for (int j = state.size; j < system.columns(); ++j) {
      Integer& value = system(state.row_of[column], j);
      if (previous < 0) value = -value;
      mpz_swap(solution(column, j).get_mpz_t(), value.get_mpz_t());
    }
  }
  system = std::move(solution);
  determinant = abs(previous);
  return true;
}

bool positiveSemidefinite(IntegerMatrix matrix) {
  const int size = matrix.rows();
  std::vector<int> left(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) left[i] = i;
  Integer previous(1), work;
  while (!left.empty()) {
    auto pivot_at = left.end();
    for (auto at = left.begin(); at != left.end(); ++at) {
      if (matrix(*at, *at) < 0) return false;
      if (matrix(*at, *at) > 0 && pivot_at == left.end()) pivot_at = at;
    }
    if (pivot_at == left.end()) {  // a zero on the diagonal allows nothing beside it
      return std::all_of(left.begin(), left.end(), [&](int i) {
        return std::all_of(left.begin(), left.end(), [&](int j) { return matrix(i, j) == 0; });
      });
    }
    const int k = *pivot_at;
    left.erase(pivot_at);
    for (const int i : left) {
      for (const int j : left) {
        if (j >= i) eliminate(matrix(i, j), matrix(k, k), matrix(i, k), matrix(k, j), previous, work);
      }
    }
    for (const int i : left) {
      for (const int j : left) {
        if (j < i) matrix(i, j) = matrix(j, i);
      }
    }
    previous = matrix(k, k);
  }
  return true;
}

std::vector<int> independentRows(IntegerMatrix matrix) {
  std::vector<int> kept;
  std::vector<int> pivots;  // column of each
  for (int row = 0; row < matrix.rows() && static_cast<int>(kept.size()) < matrix.columns(); ++row) {
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const Integer factor = matrix(row, pivots[k]);
      if (factor == 0) continue;
      const Integer pivot = matrix(kept[k], pivots[k]);
      Integer divisor(0);
      for (int j = 0; j < matrix.columns(); ++j) {
        matrix(row, j) = matrix(row, j) * pivot - factor * matrix(kept[k], j);
        divisor = gcd(divisor, matrix(row, j));
      }
      if (divisor == 0) break;
      for (int j = 0; j < matrix.columns(); ++j)
        mpz_divexact(matrix(row, j).get_mpz_t(), matrix(row, j).get_mpz_t(), divisor.get_mpz_t());
    }
    for (int j = 0; j < matrix.columns(); ++j) {
      if (matrix(row, j) == 0) continue;
      kept.push_back(row);
      pivots.push_back(j);
      break;
    }
  }
  return kept;
}

}  // namespace polyfly
