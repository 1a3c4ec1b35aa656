#pragma once

#include <utility>
#include <vector>

#include "arithmetic/exact_matrix.hpp"

namespace polyfly {

/// Small linear programs without rounding, max c . x over a . x <= b and |x_j| <= 1, in whole numbers: the
/// dual simplex on the inverse of the basis (Edmonds' integral pivoting). Made for few variables and for a
/// start near the end, such as the basis where FloatLp stopped.
class ExactSimplex {
 public:
  explicit ExactSimplex(int dimension) : dimension_(dimension), inverse_(dimension, dimension) {}

  void add(std::vector<Integer> a_b) { rows_.push_back(std::move(a_b)); }  ///< dimension + 1 numbers
  int count() const { return static_cast<int>(rows_.size()); }

  enum class Status { kOptimal, kInfeasible };

  /// `start` names as many rows as dimensions, the box's sides after the rows as in FloatLp; it is taken
  /// where its weights are not negative. kInfeasible: weights() combine rows and box to 0 . x <= negative.
  Status maximise(const std::vector<Integer>& c, const std::vector<int>& start);

  std::vector<Rational> x() const;
  Rational objective() const;
  /// Rows and sides of the box with positive weight, whose combination is c, or 0 where infeasible.
  const std::vector<std::pair<int, Rational>>& weights() const { return weights_; }

 private:
  bool startFrom(const std::vector<int>& basis, const std::vector<Integer>& c);
  void startAtCorner(const std::vector<Integer>& c);
  void findPoint();
  std::vector<Integer> inBasis(const std::vector<Integer>& a) const;
  std::vector<Integer> coefficients(int row) const;
  Integer excess(int row) const;
  int violated(bool first) const;
  int leaving(const std::vector<Integer>& share, const std::vector<Integer>& weights) const;
  void replace(int place, int row, const std::vector<Integer>& share);

  int dimension_;
  std::vector<std::vector<Integer>> rows_;
  std::vector<int> basis_;
  IntegerMatrix inverse_;       // times determinant_, a column for each row of the basis
  Integer determinant_;         // > 0
  std::vector<Integer> point_;  // times determinant_
  std::vector<Integer> c_;
  std::vector<std::pair<int, Rational>> weights_;
};

}  // namespace polyfly
