#pragma once

#include <vector>

#include "exact_linear.hpp"
#include "polytope_sets/double_description.hpp"
#include "robust_mpc/feasible_set.hpp"
#include "scenario_lp.hpp"

namespace polyfly {

/// A row of a RobustProgram in whole numbers: the row times `scale`.
struct IntegerRow {
  struct Term {
    Integer constant;
    std::vector<Integer> z;
  };
  std::vector<Integer> y;
  std::vector<Integer> z;
  std::vector<Term> terms;
  Integer bound;
  Integer scale;
};

/// One scenario: y . y + z . z <= bound.
struct IntegerScenario {
  std::vector<Integer> z;
  Integer bound;
};

/// A vertex in homogeneous whole numbers: y = values[1..] / values[0].
using HomogeneousPoint = std::vector<Integer>;

class IntegerProgram {
 public:
  explicit IntegerProgram(const RobustProgram& program);

  const std::vector<IntegerRow>& rows() const { return rows_; }
  int lawSize() const { return law_size_; }
  int predictionCount() const { return prediction_count_; }
  IntegerScenario scenario(const Scenario& which) const;

  /// The facet given by nonnegative weights of the scenarios whose weighted sum does not contain z, as in
  /// Fourier-Motzkin elimination. None where no such weights exist, or where they are not unique up to a factor.
  std::optional<FeasibleSet::Facet> combine(const std::vector<Scenario>& scenarios) const;
  /// The facet that given weights (>= 0, of whole rows) make.
  FeasibleSet::Facet facetOf(const std::vector<Scenario>& scenarios, const RationalVector& weights) const;

  /// Whether y with this z meets every row. `z` is over the denominator z.denominator * y[0].
  bool holds(const HomogeneousPoint& y, const CommonFraction& z) const;
  /// The prediction at which the scenarios hold with equality.
  CommonFraction predictionAt(const HomogeneousPoint& y, const std::vector<Scenario>& tight) const;

  /// Scenarios that are broken, one of each broken row.
  std::vector<Scenario> broken(const HomogeneousPoint& y, const CommonFraction& z) const;

 private:
  Integer excess(const IntegerRow& row, const HomogeneousPoint& y, const CommonFraction& z,
                 std::vector<bool>* negative) const;

  int law_size_;
  int prediction_count_;
  std::vector<IntegerRow> rows_;
};

/// Decides by exact linear programs whether some z is feasible with y. If so, stores z in `prediction` and returns
/// none; else returns a facet that excludes y.
std::optional<FeasibleSet::Facet> exactCut(const IntegerProgram& program, const HomogeneousPoint& y,
                                           const std::vector<Scenario>& start, CommonFraction& prediction);

}  // namespace polyfly
