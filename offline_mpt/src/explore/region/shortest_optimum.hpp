#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "program/normalised_program.hpp"

namespace polyfly {

/// Describes active sets of a program whose H is singular and not zero: the limit of H + eps I for eps -> 0,
/// taken symbolically, which is the shortest of all optima. The multipliers of H + eps I are
/// cost multiplier + eps multiplier:
///
///     H z + cost + A'mu = 0,   A z = bound,   H y + z + A'multiplier = 0,   A y = 0
///
/// with y the change of z with eps. Cost multipliers and multipliers are unique where the rows are independent. z is
/// the shortest optimum where every row's slack is at least zero, and its cost multiplier, or, where that is zero for
/// all parameters, its multiplier. One object, one thread.
class ShortestOptimum {
 public:
  explicit ShortestOptimum(const NormalisedProgram& program);

  enum class Outcome {
    kDescribed,
    /// The active rows are linearly dependent.
    kDependent,
    /// The cost is not in the span of the active rows, so z has no bound.
    kCostNotSpanned
  };
  /// Rows of the reduced program. After kDescribed the rest has an answer, in the units of NormalisedProgram.
  Outcome solve(const std::vector<std::uint16_t>& active);

  /// Rounding may have decided what is zero.
  bool doubtful() const { return doubtful_; }
  /// About what rounding does to the numbers below, relative to the greatest of them.
  double noise() const { return noise_; }

  // Affine functions of t are p + 1 numbers, constant last.

  /// Multiplier of active row `place`, in the order given.
  void multiplier(std::size_t place, double* affine) const;
  /// Cost multiplier of active row `place`. Numbers that are only rounding are set to zero.
  void costMultiplier(std::size_t place, double* affine) const;
  /// Slack of row `row` of the reduced program.
  void slack(int row, double* affine) const;
  /// The law, q rows.
  void law(std::vector<double>& out) const;

 private:
  bool isZero(double part, double whole);

  const NormalisedProgram& program_;
  // Greatest eigenvalue of the curvature.
  double greatest_ = 0.0;
  Eigen::MatrixXd z_;  // n x (p + 1)
  // One row for each row of the active set.
  Eigen::MatrixXd cost_multipliers_;
  Eigen::MatrixXd multipliers_;
  double noise_ = 0.0;
  bool doubtful_ = false;
};

}  // namespace polyfly
