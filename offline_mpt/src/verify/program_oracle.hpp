#pragma once

#include <Eigen/Core>

#include "mpc_core/parametric_program.hpp"
#include "verify/interior_point_qp.hpp"

namespace polyfly {

/// What the program says at one parameter, found without any map.
struct OracleAnswer {
  enum class Verdict {
    /// u and objective are valid.
    kFeasible,
    /// No z admits this parameter, or it lies outside A_theta theta <= b_theta.
    kInfeasible,
    /// There are solutions, but the cost falls without bound.
    kUnbounded,
    /// The oracle was not accurate enough, see `residual`.
    kUndecided,
  };
  Verdict verdict = Verdict::kUndecided;
  Eigen::VectorXd u;       ///< q
  double objective = 0.0;  ///< 1/2 z'Hz + (f + F theta)'z
  double residual = 0.0;   ///< scaled KKT residual, see InteriorPointQp
  int iterations = 0;
};

/// Solves a parametric program at single parameters by InteriorPointQp. One object serves one thread.
/// Pairs of rows that together are an equality for every theta are treated as one.
class ProgramOracle {
 public:
  /// `program` has passed checkProgram and outlives the oracle.
  explicit ProgramOracle(const ParametricProgram& program);

  /// The reference is valid until the next call.
  const OracleAnswer& solve(const Eigen::VectorXd& theta);

  /// Least change of theta, in units of half a range and in the greatest component, that makes the program
  /// feasible; 0 where it is. Infinite when no theta of the box is feasible, NaN when it could not be
  /// decided.
  double distanceToFeasible(const Eigen::VectorXd& theta);

  enum class Place {
    kDeep,     ///< all these are feasible, with a finite optimum or without
    kEdge,     ///< one is infeasible
    kUnknown,  ///< none is infeasible, but one could not be decided
  };

  /// Looks at theta moved by `depth` half-ranges along each axis, both ways; moves that leave the box are
  /// left out.
  Place place(const Eigen::VectorXd& theta, double depth);

  /// Least objective among the z that give the output u, with rows relaxed by `slack` (unit normals).
  /// Infinite when there is none, NaN when it could not be decided.
  double objectiveWithOutput(const Eigen::VectorXd& theta, const Eigen::VectorXd& u, double slack);

  /// H is positive definite on the null space of the equalities, so the minimiser is unique.
  bool strictlyConvex() const { return strictly_convex_; }

 private:
  bool inParameterSet(const Eigen::VectorXd& theta) const;

  const ParametricProgram* program_;
  std::vector<int> equalities_;
  Eigen::VectorXd half_range_;
  InteriorPointQp qp_, distance_, with_output_;
  bool strictly_convex_ = false;
  Eigen::VectorXd g_, b_, distance_cost_, distance_bounds_;
  OracleAnswer answer_;
};

}  // namespace polyfly
