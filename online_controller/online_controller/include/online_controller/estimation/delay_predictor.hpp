#pragma once

#include <array>

#include "online_controller/estimation/attitude_trim.hpp"
#include "online_controller/estimation/force_observer.hpp"
#include "online_controller/estimation/sample_line.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"
#include "online_controller/types/vehicle_model.hpp"

namespace polyfly {

/// Predicts the vehicle over a dead time, so that a law without one can fly it.
///
/// The command that answers the odometry of time t acts from t + delay on. What acts until then was sent before. The state
/// at t + delay follows from the measured one by Eq. 37, driven by these commands under the estimated disturbance. A law
/// that is given this state, and references from t + delay on, has no dead time to account for.
///
/// The estimates are the predictor's own: external force, trim and coupling of the attitude loops (AttitudeTrim).
/// They come from measured states and the commands that acted between them. Without them the predicted state would be
/// off by the disturbance times the delay. A law that estimates a disturbance itself would then leave an offset.
///
/// The memory is fixed. ahead() integrates over each command that acts meanwhile in steps of at most 0.02 s: at most
/// kMostCommands + 25 times integrateStage(). Nothing after construction throws, allocates, locks, logs or reads a clock.
class DelayPredictor {
 public:
  /// Greatest number of commands that are kept.
  static constexpr int kMostCommands = 100;

  /// The delay is that of the options, or where it is 0 the model's, 0 .. 0.5 s; 0: nothing is predicted. Throws Error when
  /// it is out of range, or longer than kMostCommands - 1 control periods.
  DelayPredictor(const VehicleModel& model, const MultirotorOptions& options);

  double delay() const noexcept { return delay_; }  ///< [s]

  /// The state `delay` after the measured one. It keeps the stamp, and the body rates unless loops of second order move
  /// them. A state that is not valid comes back as it is, and changes nothing.
  VehicleState ahead(const VehicleState& measured) noexcept;

  /// The command sent at `stamp` [s] holds until the next one. Commands of that time or later are forgotten: time began
  /// anew.
  void sent(double stamp, const AttitudeCommand& command) noexcept;

  /// The observer goes on from the next sample and keeps what it knows of the disturbance.
  void restart() noexcept { line_.restart(); }
  /// As after construction: the vehicle hovers.
  void reset() noexcept;
  /// Sets the estimate of the disturbance [m/s^2].
  void setDisturbance(const Eigen::Vector3d& disturbance) noexcept { force_.setDisturbance(disturbance); }
  /// Goes on with commands and estimates of `from`. One without a delay has no estimates.
  void transferState(const DelayPredictor& from) noexcept;

 private:
  struct Sent {
    double stamp = 0.0;  // [s]
    AttitudeCommand command;
  };

  // What is predicted.
  struct Motion {
    MultirotorState x;
    double yaw;
    TiltAngles rate;  // derivatives of roll and pitch, moved by loops of second order
  };

  const Sent& at(int i) const noexcept {
    return sent_[static_cast<std::size_t>((first_ + i) % kMostCommands)];
  }
  // Calls use(command, duration) for what was sent from `from` to `until`, in the order of time. The oldest command
  // stands for all before it.
  template <class Use>
  void visitSent(double from, double until, Use&& use) const noexcept;
  AttitudeCommand meanSent(double from, double until) const noexcept;
  void observe(const VehicleState& state, const EulerAngles& angles) noexcept;
  struct Lag {
    double gain, time;
  };
  static double asLag(const AngleLoop& loop, const Lag& lag, double command, double duration, double angle,
                      double& rate) noexcept;
  void advance(const AttitudeCommand& command, double duration, Motion& motion) const noexcept;

  VehicleModel model_;
  double delay_;
  double mass_;
  double period_;  // [s]
  AttitudeCommand hover_;
  ForceObserver force_;
  AttitudeTrim trim_;

  // Commands in the order of their stamps, at least one; the oldest is sent_[first_].
  std::array<Sent, kMostCommands> sent_;
  int first_ = 0;
  int count_ = 0;

  SampleLine line_;
  double last_stamp_ = 0.0;  // [s]
};

}  // namespace polyfly
