#pragma once

#include "fixedwing_lateral/path.hpp"

namespace polyfly {

/// When tracking counts as not converging. An aircraft whose model or weights do not fit flies around its path
/// without end. It does not come nearer from one turn to the next.
struct ConvergenceOptions {
  /// Time of flight that an aircraft on its path may be away from it [s].
  double near_time = 0.5;
  /// Time limit for progress, in the durations of a full turn at the greatest roll; 0: none [-].
  double turns = 1.5;
};

/// What an aircraft can do at present.
struct TurnAbility {
  double speed = 0.0;  ///< over ground [m/s]
  double roll = 0.6;   ///< greatest roll [rad]
  double gravity = 9.81;
};

/// Watches the offset d = |e_t| + R (1 - cos e_chi). It is the distance, and what a turn of radius R = v^2 / (g
/// tan(phi)) onto the path's course adds to it. On the path, d is below near_time v. On the way to it, d falls by
/// that much again and again. Where neither is the case for the time limit, tracking does not converge.
class ConvergenceWatch {
 public:
  /// Begins anew, as at the begin of a segment.
  void restart() noexcept;

  /// `elapsed` [s] since the call before, >= 0. An undefined course counts as aligned.
  void update(const TrackError& error, const TurnAbility& ability, const ConvergenceOptions& options,
              double elapsed) noexcept;

  /// True while the aircraft is on its path.
  bool isNear() const noexcept { return is_near_; }
  /// Time since the last progress, in time limits [-].
  double withoutProgress() const noexcept { return without_progress_; }
  /// For how long the aircraft has been on its path without a break, in time limits [-].
  double near() const noexcept { return near_; }

 private:
  double best_ = 1e300;  // least offset since the restart [m]
  double without_progress_ = 0.0;
  double near_ = 0.0;
  bool is_near_ = false;
};

}  // namespace polyfly
