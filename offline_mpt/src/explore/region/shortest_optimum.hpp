#pragma once

#include <Eigen/Core>
#include <vector>

#include "explore/region/kkt_solver.hpp"

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
class ShortestOptimum final : public ProgramKktSolver {
 public:
  explicit ShortestOptimum(const NormalisedProgram& program);

  Outcome solve(const ActiveSet& active) override;
  bool isDoubtful() const override { return doubtful_; }
  void multiplier(std::size_t place, double* affine) const override;
  /// Numbers that are only rounding are set to zero.
  void costMultiplier(std::size_t place, double* affine) const override;
  void slack(int row, double* affine) const override;
  double law(std::vector<double>& out) const override;
  double noise() const override { return noise_; }
  double slackNoise() const override { return noise_; }
  double constantSlack() const override;
  bool foreseesChanges() const override { return false; }

  bool hasCostMultipliers() const override { return true; }
  CostScale costScale(const std::vector<double>& cost_multipliers) const override;
  bool hasConstantCosts() const override { return false; }
  /// Behind the facet the row is not active.
  bool crossCostFacet(const ActiveSet& active, int leaving, ActiveSetList& sets) const override;

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
