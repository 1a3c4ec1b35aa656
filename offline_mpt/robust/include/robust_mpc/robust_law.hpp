#pragma once

#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/partition.hpp"
#include "robust_mpc/feasible_set.hpp"

namespace polyfly {

/// The explicit first move of the minimum-peak MPC: tau*(theta) is the optimum of Eq. 34, and u~_0 the
/// optimal first move nearest to K e (one input: K e cut to the interval of optimal moves). Continuous,
/// unique, and affine on each region.
struct RobustLaw {
  /// Which part of the optimal moves is taken.
  enum class Move {
    /// The optimum admits one move only.
    kUnique,
    /// K e is optimal.
    kPreferred,
    /// K e is cut to the nearest optimal move.
    kLimited,
  };
  struct Region {
    Move move = Move::kUnique;
    /// Tight facets of the feasible set: two, or one (kPreferred).
    std::vector<int> active;
    /// The region in theta: facets only, whole numbers.
    ExactPolytope polytope;
    /// Vertices of the region, sorted.
    std::vector<RationalVector> vertices;
    /// A prediction for each vertex, with which its plan meets every row. Empty ones where the set has none.
    std::vector<RationalVector> predictions;
    RationalVector input_gain;  ///< u~_0 = input_gain . theta + input_offset
    Rational input_offset;
    RationalVector peak_gain;  ///< tau* = peak_gain . theta + peak_offset
    Rational peak_offset;
  };

  std::vector<Region> regions;  ///< sorted by active facets
};

/// Enumerates the faces of the set on which tau is least for its theta: exact, and complete by construction.
/// Regions are those of full dimension.
RobustLaw explicitLaw(const RobustProblem& problem, const FeasibleSet& set);

/// What a map is encoded from. The partition has the law for the input that is applied, u_0 = u~_0 + references' part
/// (and tau, with peak_in_map), rounded to doubles. The program carries names, boxes and the problem text but no
/// rows.
struct RoundedLaw {
  ParametricProgram program;
  Partition partition;
};
RoundedLaw roundLaw(const RobustProblem& problem, const RobustLaw& law, ExploreStatus status);

}  // namespace polyfly
