#include "fixedwing_lateral/lateral_observer.hpp"

#include <algorithm>
#include <cmath>

#include "fixedwing_lateral/guidance.hpp"

namespace polyfly {
namespace {

/// Farther off than any trim, over a second: not flown by our references, or a manoeuvre that says nothing of
/// trim.
constexpr double kNotFollowed = 0.15;  // [rad]
/// Farther off than any slip: a heading that was set anew.
constexpr double kNotTurned = 0.3;  // [rad/s]

GainBiasOptions rollOptions() noexcept {
  GainBiasOptions options;
  options.bias_deviation = 0.03;  // [rad]
  options.bias_drift = 0.01;
  options.noise = 0.03;
  options.bias_most = 0.12;
  return options;
}

GainBiasOptions turnOptions() noexcept {
  GainBiasOptions options;
  options.gain_deviation = 0.1;
  options.bias_deviation = 0.02;  // [rad/s]
  options.gain_drift = 0.003;
  options.bias_drift = 0.001;
  options.noise = 0.03;
  options.gain_most = 0.3;
  options.bias_most = 0.06;
  return options;
}

}  // namespace

GainBiasFilter::GainBiasFilter(const GainBiasOptions& options) noexcept
    : options_(options), estimate_(1.0, 0.0), covariance_(Eigen::Matrix2d::Zero()) {
  covariance_(0, 0) = options.gain_deviation * options.gain_deviation;
  covariance_(1, 1) = options.bias_deviation * options.bias_deviation;
}

void GainBiasFilter::update(double x, double y, double elapsed) noexcept {
  if (!std::isfinite(x) || !std::isfinite(y)) return;
  covariance_(0, 0) += elapsed * options_.gain_drift * options_.gain_drift;
  covariance_(1, 1) += elapsed * options_.bias_drift * options_.bias_drift;
  // What has wandered as far as it may is no more uncertain than at the beginning: an excitation that stays
  // away for an hour does not make the first one after it count alone.
  for (int i = 0; i < 2; ++i) {
    const double deviation = i == 0 ? options_.gain_deviation : options_.bias_deviation;
    const double most = deviation * deviation;
    if (covariance_(i, i) <= most) continue;
    const double share = std::sqrt(most / covariance_(i, i));
    covariance_.row(i) *= share;
    covariance_.col(i) *= share;
  }
  const Eigen::Vector2d row(x, 1.0);
  const Eigen::Vector2d spread = covariance_ * row;
  const Eigen::Vector2d weight = spread / (row.dot(spread) + options_.noise * options_.noise);
  estimate_ += weight * (y - row.dot(estimate_));
  covariance_ -= weight * spread.transpose();
  estimate_[0] = std::clamp(estimate_[0], 1.0 - options_.gain_most, 1.0 + options_.gain_most);
  estimate_[1] = std::clamp(estimate_[1], -options_.bias_most, options_.bias_most);
}

LateralObserver::LateralObserver(const LateralModel& model) noexcept
    : model_(model), roll_(rollOptions()), turn_(turnOptions()) {}

void LateralObserver::update(const AircraftState& state, double airspeed, double roll_reference) noexcept {
  const double elapsed = state.stamp - stamp_;
  const bool goes_on = has_last_ && elapsed >= 0.0 && elapsed <= kLongestPause;
  if (goes_on) {
    const double tangent = 0.5 * (std::tan(roll_angle_) + std::tan(state.roll));
    length_ += elapsed;
    turned_ += wrapCourse(state.heading - heading_);
    roll_integral_ += 0.5 * elapsed * (roll_angle_ + state.roll);
    reference_integral_ += elapsed * roll_reference;
    turn_integral_ += elapsed * kGravity * tangent / airspeed;
  }
  has_last_ = true;
  stamp_ = state.stamp;
  roll_angle_ = state.roll;
  rate_ = state.roll_rate;
  heading_ = state.heading;
  if (goes_on && length_ >= kWindow) endWindow();
  if (!goes_on || length_ >= kWindow) beginWindow();
}

void LateralObserver::beginWindow() noexcept {
  begin_roll_ = roll_angle_;
  begin_rate_ = rate_;
  length_ = turned_ = roll_integral_ = reference_integral_ = turn_integral_ = 0.0;
}

// p' = b0 (phi_r + bias) - a1 p - a0 phi and psi' = gain g tan(phi) / V + bias, integrated over the second.
void LateralObserver::endWindow() noexcept {
  const double asked =
      (rate_ - begin_rate_ + model_.a1 * (roll_angle_ - begin_roll_) + model_.a0 * roll_integral_) /
      model_.b0;
  const double bias = (asked - reference_integral_) / length_;
  if (std::abs(bias) < kNotFollowed) roll_.update(reference_integral_ / length_, asked / length_, length_);
  if (std::abs(turned_ - turn_integral_) < kNotTurned * length_)
    turn_.update(turn_integral_ / length_, turned_ / length_, length_);
}

}  // namespace polyfly
