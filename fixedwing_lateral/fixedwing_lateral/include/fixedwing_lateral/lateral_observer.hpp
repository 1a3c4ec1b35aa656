#pragma once

#include <Eigen/Core>

#include "fixedwing_lateral/model.hpp"

namespace polyfly {

struct AircraftState;

/// How far a gain and a bias may be off, and how fast they may change. For y = gain x + bias.
struct GainBiasOptions {
  /// Standard deviation of the gain from 1 at the beginning; 0: the gain is 1.
  double gain_deviation = 0.0;
  /// Standard deviation of the bias from 0 at the beginning.
  double bias_deviation = 0.0;
  /// Standard deviation of the gain's change in a second.
  double gain_drift = 0.0;
  /// Standard deviation of the bias's change in a second.
  double bias_drift = 0.0;
  /// Standard deviation of the noise of y.
  double noise = 1.0;
  /// Greatest distance of the gain from 1.
  double gain_most = 0.0;
  /// Greatest distance of the bias from 0.
  double bias_most = 0.0;
};

/// The Kalman filter of a gain and a bias that wander.
class GainBiasFilter {
 public:
  explicit GainBiasFilter(const GainBiasOptions& options) noexcept;

  /// `elapsed` [s] since the last call. What is not finite is left out.
  void update(double x, double y, double elapsed) noexcept;

  double gain() const noexcept { return estimate_[0]; }
  double bias() const noexcept { return estimate_[1]; }

 private:
  GainBiasOptions options_;
  Eigen::Vector2d estimate_;
  Eigen::Matrix2d covariance_;
};

/// What the aircraft does differently from the model of Eq. 45, learnt in flight: a steady error of its roll
/// loop, and gain and bias of its turn rate (slip, a tilted attitude sensor). With it the prediction ends
/// where the aircraft does, and circles have no steady offset.
///
/// Compares what happened in each second with what the model would have made of it. Both are integrated, so that
/// neither acceleration nor turn rate need be measured. There is no integral of a tracking error. So nothing winds up
/// where the roll reference is at its bound, and a bounded estimate stays within its bounds.
class LateralObserver {
 public:
  explicit LateralObserver(const LateralModel& model) noexcept;

  /// The roll reference that was flown from the last state to this one. A pause of more than kLongestPause,
  /// or time running backwards, begins a new second; so does `interrupt`, for references that were not flown.
  /// A second in which the aircraft did something else altogether teaches nothing of the roll bias.
  void update(const AircraftState& state, double airspeed, double roll_reference) noexcept;
  void interrupt() noexcept { has_last_ = false; }

  /// Roll bias for LateralConditions [rad].
  double rollBias() const noexcept { return roll_.bias(); }
  double turnGain() const noexcept { return turn_.gain(); }
  double turnBias() const noexcept { return turn_.bias(); }

  static constexpr double kWindow = 1.0;        ///< [s]
  static constexpr double kLongestPause = 0.3;  ///< [s]

 private:
  void beginWindow() noexcept;
  void endWindow() noexcept;

  LateralModel model_;
  GainBiasFilter roll_;
  GainBiasFilter turn_;
  bool has_last_ = false;
  // Values of the last state.
  double stamp_ = 0.0, roll_angle_ = 0.0, rate_ = 0.0, heading_ = 0.0;
  // Values at the beginning of the present window.
  double begin_roll_ = 0.0, begin_rate_ = 0.0;
  // Length of the present window so far [s].
  double length_ = 0.0;
  // Change of the heading in the present window [rad].
  double turned_ = 0.0;
  double roll_integral_ = 0.0, reference_integral_ = 0.0, turn_integral_ = 0.0;
};

}  // namespace polyfly
