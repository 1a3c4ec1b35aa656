#pragma once

#include "online_controller/types.hpp"

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

  /// One control period.
  virtual const ControlReport& step(const VehicleState& state, const Reference* preview) noexcept = 0;

  /// What can be done for the next step without its sample.
  virtual void prepare() noexcept {}

  /// While there is nothing to track: level attitude, hover thrust (kNoReference). `stamp` is the odometry's.
  virtual const ControlReport& stepWithoutReference(double stamp) noexcept = 0;

  /// When odometry is silent at time `now` [s]: level attitude, hover thrust (kLevel), with the reason
  /// kStale. That the silence is long enough is for the caller to judge.
  virtual const ControlReport& onSilence(double now) noexcept = 0;

  /// In place of step() while another law flies: keeps the observer awake and takes `sent` for its own last
  /// command, so that the next step() goes on from there.
  virtual void follow(const VehicleState& state, const AttitudeCommand& sent) noexcept = 0;

  /// As after construction.
  virtual void reset() noexcept = 0;

  virtual const ControlReport& report() const noexcept = 0;  ///< of the last call
};

}  // namespace polyfly
