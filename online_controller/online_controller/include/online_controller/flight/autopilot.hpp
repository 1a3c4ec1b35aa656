#pragma once

#include <cstdint>

namespace polyfly {

/// What an autopilot says of its vehicle.
struct AutopilotReport {
  enum class Place : std::uint8_t { kUnknown, kOnGround, kInAir };

  /// False: nothing recent is known, and the other members do not count.
  bool fresh = false;
  bool armed = false;
  /// Whether it takes set-points from outside.
  bool guided = false;
  Place place = Place::kUnknown;
};

/// What is sent before anything has started a flight.
enum class IdleCommand : std::uint8_t {
  kNothing,
  kZeroThrust,
  /// The command to hold the place where the vehicle is, wherever that is.
  kFollow,
  /// The command to hold the place where this began.
  kHold,
};

/// What has been seen of an autopilot so far.
class AutopilotHistory {
 public:
  void add(const AutopilotReport& report) noexcept;

  /// Whether the vehicle may have flown since it was armed: false only where it was seen disarmed, and on the ground in each
  /// report since.
  bool mayHaveFlown() const noexcept { return may_have_flown_; }
  /// Whether the vehicle was ever seen disarmed or on the ground. If not, this program began in flight.
  bool wasGrounded() const noexcept { return was_grounded_; }

 private:
  bool may_have_flown_ = true;
  bool was_grounded_ = false;
};

/// `report` is the last one of `history`. `streams`: an autopilot that needs set-points before it is guided gets them.
IdleCommand idleCommand(const AutopilotReport& report, const AutopilotHistory& history,
                        bool streams) noexcept;

}  // namespace polyfly
