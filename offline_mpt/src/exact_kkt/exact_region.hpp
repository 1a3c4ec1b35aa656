#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "exact_kkt/exact_program.hpp"

namespace polyfly {

/// Where a half-space of a region comes from.
struct ExactOrigin {
  enum class Kind : std::uint8_t {
    /// Multiplier of row `index` of the program, >= 0.
    kMultiplier,
    /// Cost multiplier of row `index`, >= 0. H is zero, and the cost decides the multiplier's sign.
    kCostMultiplier,
    /// Slack of row `index`, >= 0.
    kSlack,
    /// Row `index` of A_theta.
    kDomain,
    /// Side of the box: t_(index / 2) <= 1 (even) or >= -1 (odd).
    kBox,
    /// Minus the slack of row `index`, a dropped equality.
    kExcess,
  };
  Kind kind = Kind::kDomain;
  int index = 0;

  bool operator==(const ExactOrigin& other) const { return kind == other.kind && index == other.index; }
};

/// row (t, 1) >= 0 with p + 1 whole numbers without a common factor, constant last.
struct ExactRow {
  ExactOrigin origin;
  std::vector<Integer> value;
  /// (a, b) with |a| = 1: a . t <= b, rounded; a = 0 where the row is constant. Infinite b: beyond doubles.
  std::vector<double> unit;
  /// Bits of the greatest entry.
  std::size_t bits = 0;
  /// Length of the row without its constant, times 2^-bits. It is 0 only where the row is constant.
  double length = 0.0;
};

/// All that optimality asks of t when a given set of rows is active: where every row here is >= 0, the law
/// below is optimal, and nowhere else.
struct ExactRegion {
  std::vector<int> active;     ///< without equalities, ascending
  std::vector<ExactRow> rows;  ///< multipliers, slacks and domain; no box, and none that is dropped
  /// Slacks of dropped rows, of equalities both ways, with what they may fall short added.
  std::vector<ExactRow> dropped;
  /// Of a forgiving program: slacks with what rounding may take from them added.
  std::vector<ExactRow> forgiven;
  std::vector<Rational> law;  ///< q x (p + 1), u = law (t, 1)
};

enum class ExactStatus : std::uint8_t {
  kRegion,
  /// The active rows are linearly dependent.
  kDependent,
  /// H is zero, and the cost is not in the span of these rows.
  kCostNotSpanned,
  /// An equality does not hold.
  kInconsistent,
};

/// The optimality conditions of one active set, solved: each unknown is an affine function of t, p + 1 whole
/// numbers over one denominator that all share.
class ExactSolution {
 public:
  /// The set may name equalities or not. Only after kRegion has the object an answer.
  ExactStatus solve(const ExactProgram& program, const std::vector<int>& active);

  /// Rows of the program in the system: the basis, then the active ones in the order given.
  const std::vector<int>& rows() const { return rows_; }
  const Integer& denominator() const { return determinant_; }  ///< > 0
  const Integer& z(int i, int j) const { return system_(i, j + first_); }
  /// Of rows()[r].
  const Integer& multiplier(int r, int j) const { return system_(n_ + r, j + first_); }
  /// Of rows()[r], where H is zero.
  const Integer& costMultiplier(int r, int j) const { return system_(n_ + r, j + cost_column_); }
  /// bound - A z of a row, over the denominator.
  std::vector<Integer> slack(const ExactProgram& program, int row) const;
  /// q x (p + 1), u = law (t, 1)
  std::vector<Rational> law(const ExactProgram& program) const;

 private:
  std::vector<int> rows_;
  IntegerMatrix system_;
  Integer determinant_;
  int n_ = 0, first_ = 0, width_ = 0;
  // First column of the cost multipliers in system_.
  int cost_column_ = 0;
};

/// (H A' 0; A 0 0) with the given rows in A and room for `sides` right-hand sides in the last columns.
IntegerMatrix optimalityMatrix(const ExactProgram& program, const std::vector<int>& rows, int sides);

/// Solves the optimality conditions for one active set, which may name equalities or not.
ExactStatus describeExactly(const ExactProgram& program, const std::vector<int>& active, ExactRegion& region);

/// The rows that can fail: not those that are zero or a positive constant everywhere.
std::vector<const ExactRow*> nontrivialRows(const ExactRegion& region);

/// The row of one side of the box.
ExactRow boxRow(int p, int index);

/// Divides by the common factor, fills `unit`, `bits` and `length`.
void finishRow(ExactRow& row);

/// Of each row (a, b) with a . t <= b, as maximiseInBox has it.
std::vector<std::vector<Integer>> halfSpaces(const std::vector<const ExactRow*>& rows);

/// The other side of the row's plane.
ExactRow opposite(ExactRow row);

/// Whether `row` is a positive multiple of `other`.
bool sameHalfSpace(const ExactRow& row, const ExactRow& other);

/// row (t, 1), times a positive number.
Integer valueAt(const ExactRow& row, const std::vector<Rational>& t);

}  // namespace polyfly
