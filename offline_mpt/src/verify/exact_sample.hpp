#pragma once

#include <Eigen/Core>
#include <optional>

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/exact_lp.hpp"

namespace polyfly {

/// A program at one parameter, decided by linear programs in fractions: the last word where a map and StrictQp differ.
class ExactSample {
 public:
  /// `program` outlives the object.
  ExactSample(const ParametricProgram& program, const Eigen::VectorXd& theta)
      : program_(program), theta_(theta) {}

  /// Whether theta is in the parameter set and has a z and, with H = 0, whether the cost has an end.
  ExactLp::Status status() const;

  /// The nearest theta at which the program is feasible, and how far away it is.
  struct Nearest {
    Eigen::VectorXd theta;
    /// In units of half a range and in the greatest component.
    double distance = 0.0;
  };
  /// Nothing where no theta of the box is feasible.
  std::optional<Nearest> nearestFeasible() const;

  /// H = 0, with an optimum: of the outputs that are optimal up to rounding of the cost, the nearest to u. Distances are
  /// greatest shares of `ranges`.
  Eigen::VectorXd nearestOptimum(const Eigen::VectorXd& u, const Eigen::VectorXd& ranges) const;

 private:
  Rational valueAt(const Eigen::MatrixXd& rows, const Eigen::VectorXd& constants, int row) const;
  Rational roomInSet(int row) const;
  ExactLp rowsAtTheta() const;
  void setCost(ExactLp& lp) const;

  const ParametricProgram& program_;
  const Eigen::VectorXd& theta_;
};

}  // namespace polyfly
