#pragma once

#include "explore/region/kkt_solver.hpp"

namespace polyfly {

/// Where H is positive definite. With G the products of the active rows,
///
///     multipliers = -G^-1 D_active,   slack = D + gram multipliers,   law = U + V multipliers.
class ConvexKktSolver : public ProgramKktSolver {
 public:
  ConvexKktSolver(const NormalisedProgram& program, const RowTables& tables, const RowFactor& factor);

  Outcome solve(const ActiveSet& active) override;
  bool isDoubtful() const override { return false; }
  void multiplier(std::size_t place, double* affine) const override;
  void costMultiplier(std::size_t, double*) const override {}
  void slack(int row, double* affine) const override;
  double law(std::vector<double>& out) const override;
  double noise() const override { return program_.rounding / factor_.pivot(); }
  double slackNoise() const override { return program_.rounding; }
  double constantSlack() const override;
  bool foreseesChanges() const override { return true; }

  bool hasCostMultipliers() const override { return false; }
  CostScale costScale() const override { return {}; }
  bool hasConstantCosts() const override { return false; }
  bool isCostOpen() const override { return false; }
  bool crossCostFacet(const ActiveSet&, int, ActiveSetList&) const override { return false; }

 protected:
  const NormalisedProgram& program_;
  const RowTables& tables_;
  const RowFactor& factor_;

 private:
  ActiveSet active_;
  std::vector<double> multipliers_;  // k x (p + 1)
  // Greatest entry of multipliers_.
  double size_ = 0.0;
  // Greatest |entry| of each row of U.
  std::vector<double> U_size_;
};

}  // namespace polyfly
