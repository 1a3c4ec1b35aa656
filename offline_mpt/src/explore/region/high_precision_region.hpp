#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "exact_kkt/exact_description.hpp"
#include "explore/region/double_double_region.hpp"
#include "explore/region/kkt_solver.hpp"

namespace polyfly {

/// Describes the active sets with which doubles have trouble, and rounds once: with 32 digits where these are
/// enough, else in rational arithmetic. Each is made ready when first needed. One object, one thread.
class HighPrecisionRegionSolver final : public KktSolver {
 public:
  explicit HighPrecisionRegionSolver(const NormalisedProgram& reduced) : reduced_(reduced), exact_(reduced) {}

  /// kDependent also where the program's equalities hold up to rounding only.
  Outcome solve(const ActiveSet& active) override;
  bool isDoubtful() const override { return false; }
  void multiplier(std::size_t place, double* affine) const override;
  void costMultiplier(std::size_t place, double* affine) const override {
    exact_.costMultiplier(place, affine);
  }
  void slack(int row, double* affine) const override;
  double law(std::vector<double>& out) const override;
  double noise() const override { return 0.0; }
  double slackNoise() const override { return 0.0; }
  double constantSlack() const override;
  bool foreseesChanges() const override { return false; }

 private:
  const NormalisedProgram& reduced_;
  std::optional<DoubleDoubleRegionSolver> long_;
  ExactDescription exact_;
  // Whether long_ describes the last set.
  bool is_long_ = false;
};

}  // namespace polyfly
