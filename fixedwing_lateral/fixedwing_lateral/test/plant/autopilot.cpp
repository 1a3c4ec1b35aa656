#include "fixedwing_plant/autopilot.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

constexpr double kGravity = 9.81;
constexpr double kPitchMost = 0.35;          // asked for [rad]
constexpr double kPitchIntegralMost = 0.15;  // [rad]

}  // namespace

Controls Autopilot::step(double roll_reference, const AutopilotInput& input, double duration) {
  const AutopilotOptions& o = options_;
  Controls controls;
  const double rate =
      std::clamp(o.roll_gain * (roll_reference - input.roll), -o.roll_rate_max, o.roll_rate_max);
  controls.aileron = o.aileron_feedforward * rate + o.aileron_gain * (rate - input.rates.x());
  // Turn rate of a coordinated turn.
  const double turn = kGravity * std::sin(input.roll) / std::max(input.airspeed, 1.0);
  controls.rudder = o.rudder_gain * (turn - input.rates.z());

  const double climb = std::clamp(o.climb_gain * (o.altitude - input.altitude), -o.climb_max, o.climb_max);
  const double climb_error = climb - input.climb_rate;
  pitch_integral_ = std::clamp(pitch_integral_ + o.pitch_integral * climb_error * duration,
                               -kPitchIntegralMost, kPitchIntegralMost);
  const double pitch =
      std::clamp(trim_.alpha + o.pitch_gain * climb_error + pitch_integral_, -kPitchMost, kPitchMost);
  controls.elevator = trim_.controls.elevator - o.elevator_gain * (pitch - input.pitch) +
                      o.elevator_damping * input.rates.y();

  const double slow = o.airspeed - input.airspeed;
  const double throttle = trim_.controls.throttle + o.throttle_gain * slow + throttle_integral_;
  // Against wind-up: nothing is added beyond what the motor can give.
  if (std::abs(throttle - 0.5) < 0.5 || (throttle - 0.5) * slow < 0.0)
    throttle_integral_ += o.throttle_integral * slow * duration;
  controls.throttle = std::clamp(throttle, 0.0, 1.0);
  return controls;
}

}  // namespace polyfly
