#pragma once

#include "explore/region/convex_kkt.hpp"

namespace polyfly {

/// Where H is zero. z is the shortest optimum, so multipliers, slacks and law are those of H = I. The cost multipliers
/// are -G^-1 M_active cost, with G the products of the active rows.
class LinearKktSolver final : public ConvexKktSolver {
 public:
  LinearKktSolver(const NormalisedProgram& program, const RowTables& tables, const RowFactor& factor);

  Outcome solve(const ActiveSet& active) override;
  bool isDoubtful() const override { return doubtful_; }
  void costMultiplier(std::size_t place, double* affine) const override;
  bool foreseesChanges() const override { return false; }

  bool hasCostMultipliers() const override { return true; }
  CostScale costScale() const override;
  bool hasConstantCosts() const override { return constant_costs_; }
  bool isCostOpen() const override { return is_open_ && scale_ > 0.0; }
  /// The optimum leaves the row and runs along the others until a new one stops it. Which one depends on the parameter,
  /// so all rows ahead are candidates.
  bool crossCostFacet(const ActiveSet& active, int leaving, ActiveSetList& sets) const override;

 private:
  std::vector<double> cost_multipliers_;  // k x (p + 1)
  bool doubtful_ = false;
  bool is_open_ = false;  // rows are too few, or a cost multiplier is tiny
  // Greatest |entry| of the cost.
  double scale_;
  bool constant_costs_;
};

}  // namespace polyfly
