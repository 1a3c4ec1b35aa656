#include "lp/rational_polytope.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "lp/tolerances.hpp"
#include "offline_mpt/exact_lp.hpp"

namespace polyfly {

bool maximiseRationally(int dimension, const double* rows, int count, const double* start,
                        const double* direction, double* point) {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (!std::all_of(start, start + dimension, is_finite)) return false;
  ExactLp lp;
  lp.setSense(ExactLp::Sense::kMaximise);
  lp.addColumns(dimension, ExactLp::Bound::kFree);
  lp.addRows(count);
  for (int j = 0; j < dimension; ++j) lp.setObjective(j, Rational(direction[j]));
  for (int i = 0; i < count; ++i) {
    const double* const row = rows + static_cast<std::ptrdiff_t>(i) * (dimension + 1);
    if (!std::all_of(row, row + dimension + 1, is_finite)) return false;
    Rational at_start;
    for (int j = 0; j < dimension; ++j) {
      if (row[j] == 0.0) continue;
      lp.setCoefficient(i, j, Rational(row[j]));
      at_start += Rational(row[j]) * Rational(start[j]);
    }
    lp.setRowBounds(i, ExactLp::Bound::kUpper, 0, std::max(Rational(row[dimension]), at_start));
  }
  if (lp.solve() != ExactLp::Status::kOptimal) return false;
  for (int j = 0; j < dimension; ++j) point[j] = lp.primal(j).get_d();
  return true;
}

bool minimalOneByOne(int kept, int dimension, const double* rows, int count, const double* interior,
                     double tolerance, const Furthest& furthest, MinimalRows& result) {
  result.facets.clear();
  result.beyond.clear();
  result.leaves_reach = false;
  const auto n = static_cast<std::size_t>(dimension);
  // Rows that are not implied by others so far.
  std::vector<double> left(rows, rows + static_cast<std::size_t>(count) * (n + 1));
  std::vector<double> beyond(n);
  std::size_t k = static_cast<std::size_t>(kept);
  for (int i = kept; i < count; ++i) {
    double* const row = left.data() + k * (n + 1);
    const double bound = row[n];
    row[n] += tolerance::kMostBeyond;
    const int left_count = static_cast<int>(left.size() / (n + 1));
    if (!furthest(left.data(), left_count, interior, row, beyond.data())) return false;
    row[n] = bound;
    double violation = -bound;
    for (std::size_t j = 0; j < n; ++j) violation += row[j] * beyond[j];
    if (violation > tolerance) {
      result.facets.push_back(i);
      result.beyond.insert(result.beyond.end(), beyond.begin(), beyond.end());
      ++k;
    } else {
      result.leaves_reach = result.leaves_reach || violation > tolerance::kNegativeSlack;
      const auto first = left.begin() + static_cast<std::ptrdiff_t>(k * (n + 1));
      left.erase(first, first + static_cast<std::ptrdiff_t>(n + 1));
    }
  }
  return true;
}

}  // namespace polyfly
