#pragma once

#include <Eigen/Core>

#include "fixedwing_lateral/horizon_data.hpp"

namespace polyfly {

/// Decides which way an aircraft turns that flies against its path, and stays with it until it has turned. An error
/// near half a turn is no reason for either side. Then the side is that of the path. On the path it is the one that
/// the wind comes from, as the wind then brings the aircraft back. A smaller error decides by itself.
class ReversalChoice {
 public:
  /// `error` at the state, of which only the course is used, `to_path` from the aircraft to the nearest point
  /// [m].
  Reversal update(const TrackError& error, const Eigen::Vector2d& to_path,
                  const Eigen::Vector2d& ground_velocity, const Eigen::Vector2d& wind) noexcept;

  /// A segment begins: nothing is chosen.
  void begin() noexcept { chosen_ = Reversal::kNone; }

  Reversal chosen() const noexcept { return chosen_; }

 private:
  Reversal chosen_ = Reversal::kNone;
};

}  // namespace polyfly
