#pragma once

#include "fixedwing_lateral/horizon_data.hpp"
#include "fixedwing_lateral/horizon_qp.hpp"
#include "fixedwing_lateral/tuning.hpp"

namespace polyfly {

/// The stage cost of Eq. 46 without its moves: |(e_t, e_chi, phi, p)|^2 in the weights, towards the segment
/// that the state belongs to: the next one where x_sw is past its threshold or the switch condition is met,
/// else the current. A view of what it is made from.
class TrackingCost {
 public:
  TrackingCost(const LateralModel& model, const HorizonData& data, const LateralWeights& weights) noexcept
      : model_(model), data_(data), weights_(weights) {}

  const PathSegment& segmentOf(const LateralState& state) const noexcept;

  double cost(const LateralState& state) const noexcept;

  /// Fills the Gauss-Newton terms (Q, q) of `stage` and gives the cost. q is half of its gradient, as the
  /// quadratic program has half of the cost.
  double linearise(const LateralState& state, HorizonStage& stage) const noexcept;

 private:
  const PathSegment& segmentAt(const LateralState& state, const Eigen::Vector2d& velocity) const noexcept;

  const LateralModel& model_;
  const HorizonData& data_;
  const LateralWeights& weights_;
};

}  // namespace polyfly
