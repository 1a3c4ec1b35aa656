#include "fixedwing_plant/six_dof_aircraft.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStep = 0.005;  // [s]

/// A first-order lag over a step in which its input stands.
double lagged(double value, double input, double lag, double duration) {
  return input + std::exp(-duration / lag) * (value - input);
}

}  // namespace

SixDofAircraft::SixDofAircraft(const SixDofOptions& options, const AircraftState& start, std::uint32_t seed)
    : options_(options),
      autopilot_(options.autopilot, trimLevel(options.airframe, options.autopilot.airspeed)),
      gusts_(lowAltitudeDryden(options.autopilot.altitude, options.turbulence, options.airframe.span), seed),
      delayed_(static_cast<std::size_t>(std::lround(options.command_delay / kStep)), 0.0),
      time_(start.stamp),
      heading_(start.heading) {
  const Trim trim = trimLevel(options.airframe, options.autopilot.airspeed);
  surfaces_ = trim.controls;
  surfaces_.aileron += options.aileron_trim;
  air_.wind = {options.wind.x(), options.wind.y(), 0.0};
  body_.position = {start.position.x(), start.position.y(), -options.autopilot.altitude};
  body_.attitude = attitudeOf(0.0, trim.alpha, start.heading);
  body_.velocity = options.autopilot.airspeed * Vector3d(std::cos(trim.alpha), 0.0, std::sin(trim.alpha)) +
                   body_.attitude.conjugate() * air_.wind;
}

void SixDofAircraft::fly(double roll_reference, double duration) {
  const int steps = std::max(1, static_cast<int>(std::lround(duration / kStep)));
  for (int i = 0; i < steps; ++i) step(roll_reference, duration / steps);
}

void SixDofAircraft::step(double roll_reference, double duration) {
  delayed_.push_back(roll_reference);
  const Controls wanted = autopilot_.step(delayed_.front(), measured(), duration);
  delayed_.pop_front();
  const SixDofOptions& o = options_;
  surfaces_.aileron = lagged(surfaces_.aileron, wanted.aileron + o.aileron_trim, o.actuator_lag, duration);
  surfaces_.elevator = lagged(surfaces_.elevator, wanted.elevator, o.actuator_lag, duration);
  surfaces_.rudder = lagged(surfaces_.rudder, wanted.rudder, o.actuator_lag, duration);
  surfaces_.throttle = lagged(surfaces_.throttle, wanted.throttle, o.motor_lag, duration);
  gusts_.step(airspeed(), duration);
  air_.gust = gusts_.velocity();
  air_.roll_gust = gusts_.rollRate();
  const double before = eulerAngles(body_.attitude).z();
  body_ = advance(o.airframe, body_, surfaces_, air_, duration);
  heading_ += wrapCourse(eulerAngles(body_.attitude).z() - before);
  time_ += duration;
}

AutopilotInput SixDofAircraft::measured() const {
  const Vector3d angles = eulerAngles(body_.attitude);
  AutopilotInput input;
  input.roll = angles.x() + options_.roll_mounting;
  input.pitch = angles.y();
  input.rates = body_.rates;
  input.airspeed = airspeed();
  input.altitude = altitude();
  input.climb_rate = -(body_.attitude * body_.velocity).z();
  return input;
}

AircraftState SixDofAircraft::state() const {
  AircraftState state;
  state.stamp = time_;
  state.position = body_.position.head<2>();
  state.ground_velocity = (body_.attitude * body_.velocity).head<2>();
  state.heading = heading_;
  state.roll = eulerAngles(body_.attitude).x() + options_.roll_mounting;
  state.roll_rate = body_.rates.x();
  return state;
}

double SixDofAircraft::airspeed() const { return airVelocity(body_, air_).norm(); }

Vector2d SixDofAircraft::wind() const { return (air_.wind + body_.attitude * air_.gust).head<2>(); }

double SixDofAircraft::slip() const {
  AirMotion mean = air_;
  mean.gust.setZero();
  const Vector3d velocity = airVelocity(body_, mean);
  return std::asin(velocity.y() / velocity.norm());
}

}  // namespace polyfly
