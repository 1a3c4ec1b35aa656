#pragma once

#include <vector>

#include "exact_linear.hpp"
#include "offline_mpt/exact_lp.hpp"
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

  /// The half-space that parts prove; none where predictions do not cancel, or a weight is not above 0.
  std::optional<FeasibleSet::Facet> sumOf(const std::vector<FeasibleSet::Part>& parts) const;

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

/// A linear program over scenarios, without rounding. Its columns are the predictions, then entries of y, all times y[0].
class ExactScenarioLp {
 public:
  /// `fixed` are the first entries of y.
  ExactScenarioLp(const IntegerProgram& program, HomogeneousPoint fixed);

  void add(const Scenario& which);
  /// Adds what is broken until nothing is. False: no point meets the scenarios.
  bool solve();

  ExactLp& lp() { return lp_; }
  const std::vector<Scenario>& scenarios() const { return scenarios_; }
  /// Over the denominator times y[0].
  const CommonFraction& prediction() const { return prediction_; }
  /// Entry j of y, not fixed.
  Rational entry(int j) const;

 private:
  const IntegerProgram& program_;
  HomogeneousPoint fixed_;
  /// Predictions and entries of y.
  int columns_;
  ExactLp lp_;
  std::vector<Scenario> scenarios_;
  CommonFraction prediction_;
};

/// Decides by exact linear programs whether some z is feasible with y. If so, stores z in `prediction` and returns
/// none; else returns a facet that excludes y.
std::optional<FeasibleSet::Facet> exactCut(const IntegerProgram& program, const HomogeneousPoint& y,
                                           const std::vector<Scenario>& start, CommonFraction& prediction);

}  // namespace polyfly
