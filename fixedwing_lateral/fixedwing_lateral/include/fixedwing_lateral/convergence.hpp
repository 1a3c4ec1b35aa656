#pragma once

#include "fixedwing_lateral/path.hpp"

namespace polyfly {

/// Tells when tracking does not converge. An aircraft whose model or weights do not fit flies around its path without
/// end. It does not come nearer from one turn to the next.
///
/// Watches the offset d = |e_t| + R (1 - cos e_chi). It is the distance, and what a turn of radius R = v^2 / (g
/// tan(phi)) onto the path's course adds to it. On the path, d is below kNear v. On the way to it, d falls by
/// that much again and again. Where neither is the case for the time limit, tracking does not converge.
class ConvergenceWatch {
 public:
  /// Begins anew, as at the begin of a segment.
  void restart() noexcept;

  /// Time of flight that an aircraft on its path may be away from it [s].
  static constexpr double kNear = 0.5;
  /// Time limit, in durations of a full turn at the greatest roll [-].
  static constexpr double kTurns = 1.5;

  /// `speed` over ground [m/s], greatest `roll` [rad], `elapsed` [s] since the call before, >= 0. An undefined course
  /// counts as aligned.
  void update(const TrackError& error, double speed, double roll, double elapsed) noexcept;

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
