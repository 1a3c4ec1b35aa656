#pragma once

#include <gmpxx.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace polyfly {

/// A fraction of whole numbers of any size.
using Rational = mpq_class;

/// Linear programming without rounding, with the vocabulary of GLPK. Rows and columns are numbered from 0 in the
/// order in which they were added. Each has bounds of its own.
///
///     min or max  c'x   s.t.   lower <= A x <= upper (rows),   lower <= x <= upper (columns)
///
/// After solve(), every answer carries its proof. That is multipliers that show that no x does better, or that none
/// exists. Or it is a direction along which the objective never ends. All proofs can be checked by substitution.
class ExactLp {
 public:
  enum class Bound {
    kFree,
    kLower,   ///< only `lower` counts
    kUpper,   ///< only `upper` counts
    kDouble,  ///< lower <= upper
    kFixed,   ///< only `lower` counts
  };
  enum class Sense { kMinimise, kMaximise };
  enum class Status {
    kUndefined,  ///< not solved since the last change
    kOptimal,
    kInfeasible,  ///< rowRay(), columnRay(): a combination of the bounds that contradicts itself
    kUnbounded,   ///< primal(): a feasible point, primalRay(): a direction to follow from there
  };

  /// Free rows of zeros; returns the index of the first.
  int addRows(int count);
  /// Columns of cost zero, >= 0 as in a standard form or kFree; returns the index of the first.
  int addColumns(int count, Bound type = Bound::kLower);
  /// Throw Error when kDouble comes with lower > upper.
  void setRowBounds(int row, Bound type, const Rational& lower, const Rational& upper);
  void setColumnBounds(int column, Bound type, const Rational& lower, const Rational& upper);
  void setObjective(int column, const Rational& coefficient);
  void setSense(Sense sense);
  void setCoefficient(int row, int column, const Rational& value);

  int rowCount() const { return static_cast<int>(rows_.size()); }
  int columnCount() const { return static_cast<int>(columns_.size()); }

  /// Never fails; the time it takes grows with the size of the numbers.
  Status solve();
  Status status() const { return status_; }

  const Rational& objective() const { return objective_; }
  const Rational& primal(int column) const { return primal_[static_cast<std::size_t>(column)]; }
  Rational rowPrimal(int row) const;  ///< A x

  /// kOptimal: c = A' rowDual + columnDual. Minimising, a dual is > 0 only at a lower bound, < 0 only at an
  /// upper one; maximising, the other way round. objective = sum of dual times the bound it stands at.
  const Rational& rowDual(int row) const { return row_dual_[static_cast<std::size_t>(row)]; }
  Rational columnDual(int column) const;

  /// kInfeasible: a Farkas ray. A' rowRay + columnRay = 0, and the sum of ray times bound over rows and columns is
  /// positive. The bound is the lower one where the ray is positive, else the upper one.
  const Rational& rowRay(int row) const { return row_dual_[static_cast<std::size_t>(row)]; }
  Rational columnRay(int column) const;

  /// kUnbounded: a direction along which the objective improves without a bound.
  const Rational& primalRay(int column) const { return primal_ray_[static_cast<std::size_t>(column)]; }

 private:
  struct Line {
    Bound type = Bound::kFree;
    Rational lower;
    Rational upper;
    // Entries of a column, by row.
    std::vector<std::pair<int, Rational>> entries;
    // Cost of a column.
    Rational cost;
  };
  friend class CgalLp;

  Rational throughRows(int column) const;

  std::vector<Line> rows_;
  std::vector<Line> columns_;
  Sense sense_ = Sense::kMinimise;
  Status status_ = Status::kUndefined;
  Rational objective_;
  std::vector<Rational> primal_;
  std::vector<Rational> row_dual_;
  std::vector<Rational> primal_ray_;
};

}  // namespace polyfly
