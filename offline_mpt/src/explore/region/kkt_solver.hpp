#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "explore/region/row_factor.hpp"
#include "explore/sets/active_set_list.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// The KKT conditions of one active set, solved for all parameters. The numbers are in the units of
/// NormalisedProgram. Affine functions of t are p + 1 numbers, constant last. One object, one thread.
class KktSolver {
 public:
  virtual ~KktSolver() = default;

  enum class Outcome : std::uint8_t {
    kSolved,
    /// The active rows are linearly dependent, or this solver cannot tell.
    kDependent,
    /// The cost is not in the span of the active rows, so z has no bound.
    kNoOptimum,
  };
  virtual Outcome solve(const ActiveSet& active) = 0;

  /// Of the last solve(), also one that failed: rounding may have decided what is zero.
  virtual bool isDoubtful() const = 0;

  // The rest is about the set that was solved last.

  /// Multiplier of active row `place`, in the order given.
  virtual void multiplier(std::size_t place, double* affine) const = 0;
  /// Where H is zero: what the cost asks of active row `place`.
  virtual void costMultiplier(std::size_t place, double* affine) const = 0;
  /// Slack of row `row` of the program, which is not active.
  virtual void slack(int row, double* affine) const = 0;
  /// The law, q rows. Returns its approximate rounding error, relative to max(1, greatest entry of a row).
  virtual double law(std::vector<double>& out) const = 0;

  /// Approximate rounding error of multipliers and cost multipliers, relative to the greatest of them.
  virtual double noise() const = 0;
  /// Approximate rounding error of slacks, relative to bounds and multipliers.
  virtual double slackNoise() const = 0;
  /// A slack with smaller slopes, relative to the bounds, does not depend on the parameters.
  virtual double constantSlack() const = 0;
  /// Whether changes of the multipliers follow from the products of active rows within estimated errors.
  virtual bool foreseesChanges() const = 0;
};

/// What cost multipliers are compared with.
struct CostScale {
  double scale = 0.0;  ///< their size
  double zero = 0.0;   ///< smaller ones are only rounding
};

/// A KktSolver in doubles for one kind of program, and what is peculiar to the regions of that kind.
class ProgramKktSolver : public KktSolver {
 public:
  virtual bool hasCostMultipliers() const = 0;
  virtual CostScale costScale() const = 0;
  /// Whether cost multipliers are there and do not depend on the parameters.
  virtual bool hasConstantCosts() const = 0;
  /// Whether a cost multiplier, or what the active rows miss of the cost, is too small for doubles to tell it from zero.
  virtual bool isCostOpen() const = 0;
  /// Adds the sets that can be optimal where the cost multiplier of row `leaving` of `active` changes its sign.
  /// Returns whether any is.
  virtual bool crossCostFacet(const ActiveSet& active, int leaving, ActiveSetList& sets) const = 0;
};

/// The solver for the kind of `program`. It keeps references to all three. The caller brings `factor` to a set
/// before each solve().
std::unique_ptr<ProgramKktSolver> makeKktSolver(const NormalisedProgram& program, const RowTables& tables,
                                                const RowFactor& factor);

}  // namespace polyfly
