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

  /// A segment begins: the side that was chosen for it goes on, or nothing is chosen.
  void begin(Reversal reversal) noexcept { chosen_ = reversal; }

  Reversal chosen() const noexcept { return chosen_; }

 private:
  Reversal chosen_ = Reversal::kNone;
};

/// How a segment follows another one.
struct Junction {
  /// Of a turn that begins now. kNone unless the segment leads back, and the aircraft's course is still against it.
  Reversal reversal = Reversal::kNone;
  /// False: the optimisation does not get the segment before it begins. That is so where it leads back or lies
  /// elsewhere. There is no corner to cut, and the horizon would avoid the switch condition.
  bool is_shown = true;
};

/// A turn by the greatest roll, from where the aircraft is.
struct SteadyTurn {
  double airspeed = 14.0;                          ///< [m/s]
  double acceleration = 6.87;                      ///< lateral, g tan(roll) [m/s^2], > 0
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< (north, east) [m/s]
  PathPoint start;                                 ///< position and course
};

/// Where the path leads back, the turn goes to the side on which it ends nearer to the next segment's line. The wind
/// moves the aircraft all through the turn. `reach` [m]: how far from the end the next segment may begin, to be
/// shown.
Junction junctionOf(const PathSegment& segment, const PathSegment& next, const SteadyTurn& turn,
                    double reach) noexcept;

}  // namespace polyfly
