#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/explore_options.hpp"
#include "offline_mpt/partition.hpp"

namespace polyfly {

/// Greatest value of a piecewise affine function over a partition, and where.
struct GreatestValue {
  double value = 0.0;
  Eigen::VectorXd theta;  ///< p; empty where the value is 0
};

/// What a partition tells of one soft bound (ParametricProgram::slacks of one name).
struct SoftBound {
  std::string name;
  std::string unit;
  /// l1 weight; the least one where slacks of the bound differ.
  double linear_weight = 0.0;
  /// Greatest slack over all regions, in the bound's unit.
  GreatestValue excess;

  enum class Exactness {
    /// Wherever all bounds can hold, they do: the multipliers of the hard program stay below the weight.
    kExact,
    /// At multiplier.theta the hard program has a solution, and its multiplier is above the weight.
    kNotExact,
    /// No parameter of the box has a solution with hard bounds.
    kNeverFeasible,
    /// The hard program has too many regions, or rows that depend on each other.
    kUnknown,
  };
  Exactness exactness = Exactness::kUnknown;
  /// Greatest multiplier of the bound in the program with hard bounds, summed over the rows of a slack.
  GreatestValue multiplier;
};

/// The program with all soft bounds hard and without slack variables.
ParametricProgram withHardBounds(const ParametricProgram& program);

/// One entry for each soft bound, in the order of program.slacks. `partition` is that of `program`. The program with
/// hard bounds is explored too, with `options`, whose checkpoint is not used. Linear programs in doubles over every
/// region: no region is left out, but rounding is not bounded.
std::vector<SoftBound> softBounds(const ParametricProgram& program, const Partition& partition,
                                  ExploreOptions options);

/// A sentence for people, without line end.
std::string softBoundText(const SoftBound& bound);

}  // namespace polyfly
