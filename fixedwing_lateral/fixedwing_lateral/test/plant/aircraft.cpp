#include "fixedwing_plant/aircraft.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

// Step of the simulations [s].
constexpr double kStep = 0.005;

DrydenOptions levelGusts(const RoughOptions& options) {
  DrydenOptions gusts;
  gusts.deviation = {options.gust, options.gust, 0.0};
  gusts.scale.setConstant(options.gust_scale);
  return gusts;
}

int stepsIn(double duration) { return std::max(1, static_cast<int>(std::lround(duration / kStep))); }

}  // namespace

ChapterAircraft::ChapterAircraft(const LateralModel& model, const AircraftState& start, double airspeed,
                                 const Eigen::Vector2d& wind)
    : model_(model),
      time_(start.stamp),
      airspeed_(airspeed),
      wind_(wind),
      north_(start.position.x()),
      east_(start.position.y()),
      roll_(start.roll),
      heading_(start.heading),
      rate_(start.roll_rate) {}

// Midpoint rule with a small step: nothing of the prediction's integration is used.
void ChapterAircraft::fly(double roll_reference, double duration) {
  const int steps = stepsIn(duration);
  const double step = duration / steps;
  for (int i = 0; i < steps; ++i) {
    const double acceleration = model_.b0 * roll_reference - model_.a1 * rate_ - model_.a0 * roll_;
    const double roll = roll_ + 0.5 * step * rate_;
    const double rate = rate_ + 0.5 * step * acceleration;
    const double heading = heading_ + 0.5 * step * kGravity * std::tan(roll_) / airspeed_;
    north_ += step * (airspeed_ * std::cos(heading) + wind_.x());
    east_ += step * (airspeed_ * std::sin(heading) + wind_.y());
    heading_ += step * kGravity * std::tan(roll) / airspeed_;
    roll_ += step * rate;
    rate_ += step * (model_.b0 * roll_reference - model_.a1 * rate - model_.a0 * roll);
  }
  time_ += duration;
}

AircraftState ChapterAircraft::state() const {
  AircraftState state;
  state.stamp = time_;
  state.position = {north_, east_};
  state.ground_velocity = airspeed_ * Eigen::Vector2d(std::cos(heading_), std::sin(heading_)) + wind_;
  state.heading = heading_;
  state.roll = roll_;
  state.roll_rate = rate_;
  return state;
}

RoughOptions slowRolling() {
  RoughOptions options;
  options.roll_frequency = 2.0;
  options.roll_damping = 0.8;
  options.roll_rate_max = 9.0 / 180.0 * kPi;
  options.roll_gain = 1.0;
  options.roll_trim = 0.0;
  options.turn_gain = 1.0;
  options.airspeed = 52.0;
  options.load_drag = 2.0;
  options.altitude = 1000.0;
  return options;
}

PerturbedAircraft::PerturbedAircraft(const RoughOptions& options, const AircraftState& start,
                                     std::uint32_t seed)
    : options_(options),
      gusts_(levelGusts(options), seed),
      delayed_(static_cast<std::size_t>(std::lround(options.roll_delay / kStep)), start.roll),
      time_(start.stamp),
      position_(start.position),
      velocity_(start.ground_velocity),
      roll_(start.roll),
      rate_(start.roll_rate),
      heading_(start.heading),
      turn_(kGravity * std::tan(start.roll) / options.airspeed),
      airspeed_(options.airspeed),
      altitude_(options.altitude) {}

void PerturbedAircraft::fly(double roll_reference, double duration) {
  const int steps = stepsIn(duration);
  for (int i = 0; i < steps; ++i) step(roll_reference, duration / steps);
}

Eigen::Vector2d PerturbedAircraft::wind() const {
  const Eigen::Vector2d ahead(std::cos(heading_), std::sin(heading_));
  const Eigen::Vector2d right(-ahead.y(), ahead.x());
  return options_.wind + gusts_.velocity().x() * ahead + gusts_.velocity().y() * right;
}

void PerturbedAircraft::step(double roll_reference, double step) {
  gusts_.step(airspeed_, step);
  delayed_.push_back(roll_reference);
  const double reference = options_.roll_gain * delayed_.front() + options_.roll_trim;
  delayed_.pop_front();

  const double w = options_.roll_frequency;
  rate_ += step * (w * w * (reference - roll_) - 2.0 * options_.roll_damping * w * rate_ -
                   options_.gust_roll * gusts_.velocity().y());
  rate_ = std::clamp(rate_, -options_.roll_rate_max, options_.roll_rate_max);
  roll_ += step * rate_;
  const double wanted = options_.turn_gain * kGravity * std::tan(roll_) / airspeed_;
  turn_ += step / options_.turn_lag * (wanted - turn_);
  heading_ += step * turn_;

  const double load = 1.0 / std::cos(roll_) - 1.0;
  airspeed_ += step * ((options_.airspeed - airspeed_) / options_.airspeed_lag - options_.load_drag * load -
                       kGravity * std::sin(climb_) * 0.2);
  const double climb = std::clamp(0.05 * (options_.altitude - altitude_) - 0.1 * load, -0.3, 0.3);
  climb_ += step / options_.altitude_lag * (climb - climb_);
  altitude_ += step * airspeed_ * std::sin(climb_);
  velocity_ = airspeed_ * std::cos(climb_) * Eigen::Vector2d(std::cos(heading_), std::sin(heading_)) + wind();
  position_ += step * velocity_;
  time_ += step;
}

AircraftState PerturbedAircraft::state() const {
  AircraftState state;
  state.stamp = time_;
  state.position = position_;
  state.ground_velocity = velocity_;
  state.heading = heading_;
  state.roll = roll_;
  state.roll_rate = rate_;
  return state;
}

}  // namespace polyfly
