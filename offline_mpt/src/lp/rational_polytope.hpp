#pragma once

#include <gmpxx.h>

#include <vector>

#include "lp/polytope.hpp"

namespace polyfly {

/// The same questions that PolytopeSolver answers, about the same rows of doubles, by a simplex in rational
/// arithmetic with Bland's rule: it ends whatever the rows are, and thousands of times later. PolytopeSolver
/// asks it where rounding leads its own pivots astray.
class RationalPolytope {
 public:
  /// Rows (a, b) of `dimension` + 1 numbers each, {t : a_i . t <= b_i}.
  RationalPolytope(int dimension, const double* rows, int count);

  bool finite() const { return finite_; }  ///< otherwise no question has an answer

  /// Raises the bound of a row by `amount`: how far the others let it be violated.
  void relax(int row, double amount) { bounds_[static_cast<std::size_t>(row)] += amount; }

  /// A point where direction . t is greatest, on the way from `start`. Rows that `start` violates by rounding
  /// count as met. False when the polytope is unbounded that way, or no vertex exists.
  bool maximise(const double* start, const double* direction, double* point);

 private:
  bool enterFree(std::size_t column);
  int blocking(std::size_t column, bool growing, mpq_class& step) const;
  void pivot(std::size_t row, std::size_t column);
  bool climb(const double* direction);
  void begin(const double* start);

  std::size_t n_;
  bool finite_ = true;
  std::vector<std::vector<mpq_class>> normals_;
  std::vector<mpq_class> bounds_;
  // Dictionary: slack i, then coordinate q, as constant + sum of coefficients times the columns' quantities.
  std::vector<std::vector<mpq_class>> slacks_, coordinates_;
  std::vector<int> nonbasic_;  // row whose slack is the column, -1: a free displacement
  std::vector<char> at_zero_;  // whether the row is a column
};

/// As PolytopeSolver::minimalBeside, which documents it.
bool minimalRationally(int kept, int dimension, const double* rows, int count, const double* interior,
                       double tolerance, MinimalRows& result);

}  // namespace polyfly
