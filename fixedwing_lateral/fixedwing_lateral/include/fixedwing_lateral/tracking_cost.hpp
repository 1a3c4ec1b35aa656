#pragma once

#include "fixedwing_lateral/horizon_data.hpp"
#include "fixedwing_lateral/horizon_qp.hpp"
#include "fixedwing_lateral/tuning.hpp"

namespace polyfly {

/// What a stage costs and asks for.
struct StageTerms {
  /// Cost of e_t, e_chi and p.
  double cost = 0.0;
  /// Roll that stays on the path's curvature, times the feed-forward share [rad].
  double roll_along = 0.0;
  /// |e_t| [m].
  double track_error = 0.0;
};

/// The stage cost of Eq. 46 without its moves: |(e_t, e_chi, phi, p)|^2 in the weights, towards the segment that the
/// state belongs to. That is the next one where x_sw is past its threshold or the switch condition is met, else the
/// current. A view of what it is made from.
class TrackingCost {
 public:
  TrackingCost(const HorizonData& data, const LateralWeights& weights) noexcept
      : data_(data), weights_(weights) {}

  const PathSegment& segmentOf(const LateralState& state) const noexcept;

  /// Fills the Gauss-Newton terms (Q, q) of `stage`, but for the q of phi, which depends on its reference. q
  /// is half of the cost's gradient, as the quadratic program has half of the cost.
  StageTerms linearise(const LateralState& state, HorizonStage& stage) const noexcept;

 private:
  double rollAlong(const ClosestPoint& nearest, double track, const Eigen::Vector2d& air,
                   const Eigen::Vector2d& velocity) const noexcept;
  Reversal reversalOn(const PathSegment& segment) const noexcept;
  double trackWeight(Reversal reversal) const noexcept;
  const PathSegment& segmentAt(const LateralState& state, const Eigen::Vector2d& velocity) const noexcept;

  const HorizonData& data_;
  const LateralWeights& weights_;
};

}  // namespace polyfly
