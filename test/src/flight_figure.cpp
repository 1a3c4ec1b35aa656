#include "polyfly_test/flight_figure.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "polyfly_base/error.hpp"
#include "polyfly_test/range_check.hpp"

namespace polyfly {
namespace {

constexpr double kTwoPi = 6.283185307179586;

// A value with its first three derivatives with respect to time.
struct Motion {
  double value = 0.0;
  double rate = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
};

// From 0 to 1 over `length` seconds; speed, acceleration and jerk are zero at both ends.
Motion smoothStep(double time, double length) {
  const double s = std::clamp(time / length, 0.0, 1.0);
  const double s2 = s * s;
  const double r = 1.0 - s;
  Motion step;
  step.value = s2 * s2 * (35.0 - 84.0 * s + 70.0 * s2 - 20.0 * s2 * s);
  step.rate = 140.0 * s2 * s * r * r * r / length;
  step.acceleration = 420.0 * s2 * r * r * (1.0 - 2.0 * s) / (length * length);
  step.jerk = 840.0 * s * r * (1.0 - 5.0 * s + 5.0 * s2) / (length * length * length);
  return step;
}

// A phase whose rate grows from 0 to `rate` over `length` seconds: the integral of a quintic step. Its
// derivatives up to the third are zero at the beginning and continuous at the end.
Motion rampUp(double time, double length, double rate) {
  const double s = std::clamp(time / length, 0.0, 1.0);
  const double s2 = s * s;
  const double s3 = s2 * s;
  Motion ramp;
  ramp.value = rate * length * s2 * s2 * (2.5 - 3.0 * s + s2);
  ramp.rate = rate * s3 * (10.0 - 15.0 * s + 6.0 * s2);
  ramp.acceleration = rate / length * 30.0 * s2 * (1.0 - 2.0 * s + s2);
  ramp.jerk = rate / (length * length) * 60.0 * s * (1.0 - 3.0 * s + 2.0 * s2);
  return ramp;
}

// amplitude sin(order phase), by the chain rule.
Motion sine(double amplitude, double order, const Motion& phase) {
  const double sin_phase = amplitude * std::sin(order * phase.value);
  const double cos_phase = amplitude * std::cos(order * phase.value);
  const double w = order * phase.rate;
  const double w_dot = order * phase.acceleration;
  Motion motion;
  motion.value = sin_phase;
  motion.rate = cos_phase * w;
  motion.acceleration = cos_phase * w_dot - sin_phase * w * w;
  motion.jerk = cos_phase * (order * phase.jerk - w * w * w) - 3.0 * sin_phase * w * w_dot;
  return motion;
}

void put(Reference& reference, int axis, const Motion& motion) {
  reference.position[axis] += motion.value;
  reference.velocity[axis] += motion.rate;
  reference.acceleration[axis] += motion.acceleration;
  reference.jerk[axis] += motion.jerk;
}

Motion scaled(const Motion& motion, double factor) {
  return {factor * motion.value, factor * motion.rate, factor * motion.acceleration, factor * motion.jerk};
}

}  // namespace

FlightFigure::FlightFigure(const FigureOptions& options) : options_(options) {
  visitFigureOptions(options, VectorRangeCheck{{"figure"}});
  // Each blend covers half of the phase that the full rate would cover in its time.
  cruise_time_ = kTwoPi * options.laps / options.rate - options.blend_time;
  if (cruise_time_ < 0.0) {
    throw Error("figure: blend_time: must not exceed the time of the laps at full rate, " +
                std::to_string(kTwoPi * options.laps / options.rate) + " s");
  }
  figure_start_ = options.settle_time + options.climb_time;
  hold_start_ = figure_start_ + 2.0 * options.blend_time + cruise_time_;
  duration_ = hold_start_ + options.hold_time;
}

Reference FlightFigure::at(double time) const {
  Reference reference;
  reference.position = options_.start;
  put(reference, 2,
      scaled(smoothStep(time - options_.settle_time, options_.climb_time),
             options_.height - options_.start.z()));

  const double flown = std::clamp(time - figure_start_, 0.0, hold_start_ - figure_start_);
  Motion phase = rampUp(flown, options_.blend_time, options_.rate);
  if (flown > options_.blend_time + cruise_time_) {
    // The way back is the way in, seen from the end.
    phase = rampUp(hold_start_ - figure_start_ - flown, options_.blend_time, options_.rate);
    phase.value = kTwoPi * options_.laps - phase.value;
    phase.acceleration = -phase.acceleration;
  } else if (flown > options_.blend_time) {
    phase.value += options_.rate * (flown - options_.blend_time);
  }
  put(reference, 0, sine(options_.radius_x, 1.0, phase));
  put(reference, 1, sine(options_.radius_y, 2.0, phase));
  put(reference, 2, sine(options_.radius_z, 1.0, phase));

  const double yaw_per_phase = options_.yaw_turn / (kTwoPi * options_.laps);
  reference.yaw = std::remainder(options_.start_yaw + yaw_per_phase * phase.value, kTwoPi);
  reference.yaw_rate = yaw_per_phase * phase.rate;
  return reference;
}

std::vector<Reference> FlightFigure::sample() const {
  const auto count = static_cast<std::size_t>(std::ceil(duration_ / options_.sample_period)) + 1;
  std::vector<Reference> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i] = at(static_cast<double>(i) * options_.sample_period);
  }
  return points;
}

}  // namespace polyfly
