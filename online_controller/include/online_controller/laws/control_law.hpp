#pragma once

#include "online_controller/types/types.hpp"

namespace polyfly {

/// One control law of a multirotor. step() in every control period, prepare() when its command is out.
///
/// None of these functions throws, allocates, locks, logs or reads a clock.
class ControlLaw {
 public:
  virtual ~ControlLaw() = default;

  /// References that step() reads: the first at the sample's time, each next one previewPeriod() later.
  virtual int previewLength() const noexcept { return 1; }
  virtual double previewPeriod() const noexcept { return 0.0; }  ///< [s]
  /// How many of them the next step() reads: all, unless it knows better.
  virtual int previewNeeded() const noexcept { return previewLength(); }

  /// One control period.
  virtual const ControlReport& step(const VehicleState& state, const Reference* preview) noexcept = 0;

  /// What can be done for the next step without its sample.
  virtual void prepare() noexcept {}

  /// While there is nothing to track: level attitude, hover thrust (kNoReference). `stamp` is the odometry's.
  virtual const ControlReport& stepWithoutReference(double stamp) noexcept = 0;

  /// In place of step() when the sample cannot be used: the next level of the FailsafePolicy.
  virtual const ControlReport& withoutSample(double stamp, ControlReason reason) noexcept = 0;

  /// When odometry is silent at time `now` [s], once in each control period: the FailsafePolicy from level
  /// attitude on, because the receiver has held the last command already; with the reason kStale. That the
  /// silence is long enough is for the caller to judge.
  virtual const ControlReport& onSilence(double now) noexcept = 0;

  /// The next sample goes on from where it is, however far that is from the last one; what the observer knows
  /// of the disturbance is kept.
  virtual void restartObserver() noexcept = 0;

  /// What the observer begins with: a disturbance that is known from elsewhere [m/s^2].
  virtual void setDisturbance(const Eigen::Vector3d& disturbance) noexcept = 0;

  /// Forgets the integral of the position error, see PositionIntegrator.
  virtual void resetIntegrator() noexcept = 0;

  /// In place of step() while another law flies: updates the observer and takes `sent` for its own last
  /// command, so that the next step() goes on from there.
  virtual void track(const VehicleState& state, const AttitudeCommand& sent) noexcept = 0;

  /// Goes on where `from` is, a law of the same kind made from other options or maps: observer, last
  /// command (within the limits of this one), solution. For the time after step() and before prepare(). A
  /// law of another kind is ignored.
  virtual void transferState(const ControlLaw& from) noexcept = 0;

  /// Where the last step expects the vehicle: at its sample, and at each stagePeriod() after it, at most
  /// `count` positions in W [m]. `preview` holds the references of these times. Returns how many there are, 0
  /// after a step without an answer. For people to look at, between step() and prepare().
  virtual int predict(const Reference* preview, int count, Eigen::Vector3d* positions) const noexcept = 0;
  virtual double stagePeriod() const noexcept = 0;  ///< [s]

  /// How far the last step's answer is from the optimum that it was asked for: the greatest violation of
  /// the KKT conditions of its quadratic program, relative to its gradient. Negative where nothing was
  /// solved, as with an explicit law. Costs some microseconds: not for the way from odometry to command.
  virtual double kktResidual() const noexcept { return -1.0; }

  /// As after construction.
  virtual void reset() noexcept = 0;

  /// Report of the last call.
  virtual const ControlReport& report() const noexcept = 0;
};

}  // namespace polyfly
