#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/partition.hpp"

namespace polyfly {

/// By how much the closed loop exceeds a soft bound while the disturbance stays in its range.
///
/// The loop is that of the problem's model, with one look-up for each sampling time, and held references. It starts at any
/// parameters where the bound is met, now and in the prediction, and counts while the parameters stay in the map.
struct LoopExcess {
  std::string name;
  std::string unit;
  /// Why there is no number; empty where there is one.
  std::string unknown;
  /// No sample exceeds the bound by more.
  double excess = 0.0;
  /// Where one step of the law exceeds the bound by `excess`: the parameters before it, and the disturbance. The loop need
  /// not get there, so a loop may stay below. Empty where `excess` is 0.
  Eigen::VectorXd theta;  ///< p
  Eigen::VectorXd d;      ///< nd
};

/// Names and ranges of the disturbances, such as "d_y in [-0.5, 0.5] m/s^2"; empty: no disturbance has a range.
std::string disturbanceText(const MpcProblem& problem);

/// One entry for each soft bound; none where no disturbance has a range. A disturbance without a range is 0.
/// `partition` is the complete one of condense(problem).
///
/// In each region, two numbers bound what the loop reaches: the excess now, and that of the prediction. They grow from 0
/// until each step from all these parameters stays within them, in steps of a 1024th of the greatest values. Linear programs
/// in doubles over pairs of regions: none that the loop can pass is left out, but rounding is not bounded. After a million
/// pairs there is no number.
std::vector<LoopExcess> loopExcess(const MpcProblem& problem, const Partition& partition);

/// A sentence for people, without line end.
std::string loopExcessText(const MpcProblem& problem, const LoopExcess& excess);

}  // namespace polyfly
