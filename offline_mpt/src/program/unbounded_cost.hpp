#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "mpc_core/dense_qp.hpp"
#include "offline_mpt/partition.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Where a linear program has solutions but no best one. Along a direction d with A d <= 0 and
/// cost(t)'d < 0 the cost falls for ever. Neither the directions that rows leave open nor their cone depend on t, so the parameters without such a direction are a convex set: whatever lies behind a facet
/// that it shares with the regions' union is unbounded as far as it is feasible. One object, one thread.
class UnboundedCost {
 public:
  /// `program` has its implied equalities made explicit (findSlaterPoint); `reduced` is what became of it.
  UnboundedCost(const ParametricProgram& program, const NormalisedProgram& reduced);

  /// The steepest direction, of length 1, at the scaled parameter t; none where the optimum is finite.
  std::optional<Eigen::VectorXd> direction(const Eigen::VectorXd& t);

  /// A scaled parameter well inside the set that has solutions and a finite optimum, found from t, which has
  /// solutions; none where that set has no interior.
  std::optional<Eigen::VectorXd> start(const Eigen::VectorXd& t);

  /// A scaled parameter, as deep as one direction tells, that has solutions but no finite optimum, at the
  /// start or behind a facet of the regions; none if there is none anywhere, or when `stop` was set before
  /// all facets were tried (cutShort).
  std::optional<Eigen::VectorXd> witness(const std::vector<CriticalRegion>& regions,
                                         const std::atomic<bool>* stop = nullptr);

  /// Whether `witness` was stopped before it had an answer.
  bool cutShort() const { return cut_short_; }

  /// The same from the start and some corners of the box alone, in a time that does not grow with the regions
  /// or 2^p: none is no promise.
  std::optional<Eigen::VectorXd> quickWitness();

 private:
  bool testCorners(std::optional<Eigen::VectorXd>& found);
  bool testCorner(std::uint64_t corner, std::optional<Eigen::VectorXd>& found);
  std::optional<Eigen::VectorXd> deepest(const Eigen::VectorXd& direction) const;
  std::optional<Eigen::VectorXd> behind(const CriticalRegion& region);
  std::optional<Eigen::VectorXd> test(const Eigen::VectorXd& t);

  const ParametricProgram& program_;
  const NormalisedProgram& reduced_;
  // Projects -cost onto the cone of open directions. None without a cost.
  std::optional<DenseQp> qp_;
  // Greatest entry of the cost.
  double size_ = 0.0;
  // Parameter that `start` found.
  std::optional<Eigen::VectorXd> first_;
  bool cut_short_ = false;
  // Directions along which the cost of no feasible parameter falls.
  std::vector<Eigen::VectorXd> harmless_;
};

}  // namespace polyfly
