#pragma once

#include "online_controller/types/attitude.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// Level attitude with this share of the hover thrust, as far as the limits allow. `trim` are the commands at which the
/// vehicle is level, see AttitudeTrim::level.
AttitudeCommand levelCommand(const MultirotorOptions& options, const TiltAngles& trim,
                             double share = 1.0) noexcept;

/// What is sent while a law has no answer, by the control periods since the last one:
///
///     hold_periods      the last command again                        kHoldLast
///     level_periods     level attitude, hover thrust                  kLevel
///     descend_periods   level attitude, 0.95 of hover thrust          kDescend
///     from then on      nothing                                       kStopped
///
/// Without a command to hold it starts level. An answer ends it on any level. `trim` are the commands at which
/// the vehicle is level, see AttitudeTrim::level.
class FailsafePolicy {
 public:
  /// Throws Error when an option is out of range.
  explicit FailsafePolicy(const MultirotorOptions& options);

  /// A law answered, or the command of another law was sent.
  void answered() noexcept;

  /// There is no command to hold: the next period without an answer is level.
  void forget() noexcept;

  /// One more control period without an answer: makes `command`, the last one, what is to be sent. Where it
  /// is held it is left alone.
  ControlStatus next(AttitudeCommand& command, const TiltAngles& trim) noexcept;

  /// As next, past the level that holds: the receiver has held the last command in the silence already.
  ControlStatus nextInSilence(AttitudeCommand& command, const TiltAngles& trim) noexcept;

  /// Goes on at the level of `other`, with its own options.
  void transferState(const FailsafePolicy& other) noexcept {
    has_command_ = other.has_command_;
    unanswered_ = other.unanswered_;
  }

 private:
  MultirotorOptions options_;
  bool has_command_ = false;
  int unanswered_ = 0;  // control periods
};

}  // namespace polyfly
