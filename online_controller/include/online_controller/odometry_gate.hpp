#pragma once

#include "online_controller/options.hpp"
#include "online_controller/types.hpp"

namespace polyfly {

/// Lets through the odometry that one vehicle can have flown. A sample is refused when it
/// - is not sane (kNotFinite, see isSane);
/// - bears a stamp before that of the last accepted one (kOutOfOrder);
/// - lies further from the last accepted one than its velocities, 20 m/s^2 and jump_distance explain (kJump).
///
/// Time and place may truly begin anew (another bag, a relocalisation): after hold_periods refused samples in
/// a row that agree with each other the next one of them is accepted, as a restart.
class OdometryGate {
 public:
  struct Verdict {
    ControlReason refusal = ControlReason::kNone;
    bool restarted = false;  ///< accepted, and not the continuation of the last accepted one
  };

  explicit OdometryGate(const MultirotorOptions& options) noexcept
      : jump_distance_(options.jump_distance), confirmations_(options.hold_periods) {}

  Verdict check(const VehicleState& state) noexcept;

 private:
  ControlReason compare(const VehicleState& before, const VehicleState& state) const noexcept;

  double jump_distance_;
  int confirmations_;
  VehicleState last_;       // accepted
  VehicleState candidate_;  // refused last
  bool started_ = false;
  int agreeing_ = 0;  // refused samples in a row that agree
};

}  // namespace polyfly
