#include "lp/rational_polytope.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace polyfly {
namespace {

constexpr double kReach = 1.0;  // how far past a row `beyond` points may lie

}  // namespace

RationalPolytope::RationalPolytope(int dimension, const double* rows, int count)
    : n_(static_cast<std::size_t>(dimension)) {
  for (int i = 0; i < count; ++i) {
    const double* const row = rows + static_cast<std::ptrdiff_t>(i) * (dimension + 1);
    finite_ = finite_ && std::all_of(row, row + n_ + 1, [](double value) { return std::isfinite(value); });
    if (!finite_) return;
    normals_.emplace_back(row, row + dimension);
    bounds_.emplace_back(row[dimension]);
  }
}

void RationalPolytope::begin(const double* start) {
  const std::size_t count = bounds_.size();
  slacks_.assign(count, std::vector<mpq_class>(n_ + 1));
  coordinates_.assign(n_, std::vector<mpq_class>(n_ + 1));
  nonbasic_.assign(n_, -1);
  at_zero_.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    slacks_[i][0] = bounds_[i];
    for (std::size_t j = 0; j < n_; ++j) {
      slacks_[i][0] -= normals_[i][j] * mpq_class(start[j]);
      slacks_[i][j + 1] = -normals_[i][j];
    }
    if (slacks_[i][0] < 0) slacks_[i][0] = 0;
  }
  for (std::size_t q = 0; q < n_; ++q) {
    coordinates_[q][0] = start[q];
    coordinates_[q][q + 1] = 1;
  }
}

/// First row that stops the column's quantity, -1: none. Of several the one of least index, as Bland asks.
int RationalPolytope::blocking(std::size_t column, bool growing, mpq_class& step) const {
  int best = -1;
  mpq_class ratio;
  for (std::size_t i = 0; i < slacks_.size(); ++i) {
    if (at_zero_[i]) continue;
    const mpq_class& slope = slacks_[i][column + 1];
    if (growing ? slope >= 0 : slope <= 0) continue;
    ratio = slacks_[i][0] / slope;
    if (growing) ratio = -ratio;
    if (best >= 0 && ratio >= step) continue;
    step = ratio;
    best = static_cast<int>(i);
  }
  return best;
}

void RationalPolytope::pivot(std::size_t row, std::size_t column) {
  // The quantity of the column, in terms of the new columns.
  std::vector<mpq_class> replacement(n_ + 1);
  const mpq_class inverse = 1 / slacks_[row][column + 1];
  for (std::size_t k = 0; k <= n_; ++k) replacement[k] = -slacks_[row][k] * inverse;
  replacement[column + 1] = inverse;
  const auto substitute = [&](std::vector<mpq_class>& affine) {
    const mpq_class factor = affine[column + 1];
    if (factor == 0) return;
    affine[column + 1] = 0;
    for (std::size_t k = 0; k <= n_; ++k) affine[k] += factor * replacement[k];
  };
  for (std::size_t i = 0; i < slacks_.size(); ++i) {
    if (!at_zero_[i] && i != row) substitute(slacks_[i]);
  }
  for (std::vector<mpq_class>& coordinate : coordinates_) substitute(coordinate);
  at_zero_[row] = 1;
  if (nonbasic_[column] >= 0) {
    const auto leaving = static_cast<std::size_t>(nonbasic_[column]);
    at_zero_[leaving] = 0;
    slacks_[leaving] = replacement;
  }
  nonbasic_[column] = static_cast<int>(row);
}

bool RationalPolytope::enterFree(std::size_t column) {
  mpq_class step;
  int row = blocking(column, true, step);
  if (row < 0) row = blocking(column, false, step);
  if (row < 0) return false;
  pivot(static_cast<std::size_t>(row), column);
  return true;
}

bool RationalPolytope::climb(const double* direction) {
  std::vector<mpq_class> gain(n_);
  for (;;) {
    int column = -1;
    for (std::size_t j = 0; j < n_; ++j) {
      gain[j] = 0;
      for (std::size_t q = 0; q < n_; ++q) gain[j] += mpq_class(direction[q]) * coordinates_[q][j + 1];
      if (gain[j] > 0 && (column < 0 || nonbasic_[j] < nonbasic_[static_cast<std::size_t>(column)])) {
        column = static_cast<int>(j);
      }
    }
    if (column < 0) return true;
    mpq_class step;
    const int row = blocking(static_cast<std::size_t>(column), true, step);
    if (row < 0) return false;
    pivot(static_cast<std::size_t>(row), static_cast<std::size_t>(column));
  }
}

bool RationalPolytope::maximise(const double* start, const double* direction, double* point) {
  if (!finite_) return false;
  begin(start);
  for (std::size_t j = 0; j < n_; ++j) {
    if (!enterFree(j)) return false;
  }
  if (!climb(direction)) return false;
  for (std::size_t q = 0; q < n_; ++q) point[q] = coordinates_[q][0].get_d();
  return true;
}

bool minimalRationally(int kept, int dimension, const double* rows, int count, const double* interior,
                       double tolerance, MinimalRows& result) {
  result.facets.clear();
  result.beyond.clear();
  const auto n = static_cast<std::size_t>(dimension);
  std::vector<double> left;  // rows that are not implied by others so far
  std::vector<int> numbers;
  for (int i = 0; i < count; ++i) {
    const double* const row = rows + static_cast<std::ptrdiff_t>(i) * (dimension + 1);
    left.insert(left.end(), row, row + n + 1);
    numbers.push_back(i);
  }
  std::vector<double> beyond(n);
  for (auto k = static_cast<std::size_t>(kept); k < numbers.size();) {
    RationalPolytope simplex(dimension, left.data(), static_cast<int>(numbers.size()));
    if (!simplex.finite()) return false;
    simplex.relax(static_cast<int>(k), kReach);
    const double* const row = left.data() + k * (n + 1);
    if (!simplex.maximise(interior, row, beyond.data())) return false;
    double violation = -row[n];
    for (std::size_t j = 0; j < n; ++j) violation += row[j] * beyond[j];
    if (violation > tolerance) {
      result.facets.push_back(numbers[k]);
      result.beyond.insert(result.beyond.end(), beyond.begin(), beyond.end());
      ++k;
    } else {
      numbers.erase(numbers.begin() + static_cast<std::ptrdiff_t>(k));
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(k * (n + 1)),
                 left.begin() + static_cast<std::ptrdiff_t>((k + 1) * (n + 1)));
    }
  }
  return true;
}

}  // namespace polyfly
