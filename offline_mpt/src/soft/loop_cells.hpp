#pragma once

#include <Eigen/Core>
#include <vector>

#include "lp/polytope.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/partition.hpp"
#include "soft/loop_step.hpp"

namespace polyfly {

/// s = (theta, d), each entry scaled to [-1, 1]. Disturbances without a range are 0 and no entries.
class LoopScale {
 public:
  explicit LoopScale(const MpcProblem& problem);

  Eigen::Index parameters() const { return p_; }
  Eigen::Index size() const { return middle_.size(); }
  /// theta and d at s, within their ranges also where s is rounded.
  Eigen::VectorXd theta(const Eigen::VectorXd& s) const;
  Eigen::VectorXd disturbance(const Eigen::VectorXd& s) const;
  /// w = (theta, u, d, 1) under the law u = K theta + k, over (s, 1).
  Eigen::MatrixXd loop(const CriticalRegion& region) const;
  /// A function of (theta, 1) over (s, 1).
  Eigen::RowVectorXd ofTheta(const Eigen::RowVectorXd& on_theta, double constant) const;
  /// Functions over (s, 1), an entry of theta each, in the scaled unit of that entry.
  Eigen::MatrixXd scaled(const Eigen::MatrixXd& theta) const;

 private:
  Eigen::Index p_;
  std::vector<Eigen::Index> channels_;  // disturbances with a range
  Eigen::Index channel_count_;
  Eigen::VectorXd lower_, upper_, middle_, half_;
};

/// A polytope in the box of s, half-space by half-space, and linear programs over it.
class LoopCell {
 public:
  explicit LoopCell(Eigen::Index size);

  /// The box alone.
  void reset();
  /// functions (s, 1) <= 0, a row each. One that does not depend on s holds, or makes the cell empty.
  void add(const Eigen::MatrixXd& functions);
  /// False where the cell has no interior.
  bool enter();
  /// Point of the cell where the function of (s, 1) is greatest. Needs enter().
  Eigen::VectorXd greatest(const Eigen::RowVectorXd& function);

 private:
  void addRow(const Eigen::RowVectorXd& function);

  Eigen::Index size_;
  PolytopeSolver solver_;
  std::vector<double> rows_;
  int count_ = 0;
  bool empty_ = false;
  Eigen::VectorXd interior_;
};

}  // namespace polyfly
