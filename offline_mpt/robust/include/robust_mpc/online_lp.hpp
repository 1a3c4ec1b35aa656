#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>

#include "robust_mpc/robust_program.hpp"

namespace polyfly {

/// The same problem at one theta, by linear programs: the slow mode of the law, and its oracle. Two programs:
/// the least tau, then the first move nearest to K e among those that reach it.
///
/// Worst cases are added to a program when they are violated, so it holds few of them.
class OnlineLp {
 public:
  explicit OnlineLp(const RobustProblem& problem);
  ~OnlineLp();
  OnlineLp(OnlineLp&&) noexcept;

  /// `feasible` false: no plan meets all bounds. The box of theta does not count.
  struct Answer {
    bool feasible = false;
    double peak = 0.0;   ///< tau*
    double input = 0.0;  ///< u~_0
  };
  /// In floating point: peak within about 1e-10 of the optimum. The move is chosen with so much slack in tau,
  /// which a position output magnifies by 1 / (C B). Throws Error when the simplex method does not end.
  Answer solve(const Eigen::VectorXd& theta);

  /// The input u_0 that is applied, u~_0 with what references add: theta in the order of the problem's parameters. None where no
  /// plan meets all bounds.
  std::optional<double> input(const double* theta);

  struct ExactAnswer {
    bool feasible = false;
    Rational peak;
    Rational input;
  };
  /// In fractions, by ExactLp.
  ExactAnswer solveExactly(const RationalVector& theta) const;

  const RobustProgram& program() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace polyfly
