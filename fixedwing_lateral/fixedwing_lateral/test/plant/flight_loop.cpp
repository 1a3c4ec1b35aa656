#include "fixedwing_plant/flight_loop.hpp"

#include <cmath>
#include <limits>

namespace polyfly {

GuidanceInput Sensors::measure(const Aircraft& aircraft, double period) {
  const AircraftState truth = aircraft.state();
  const double time = truth.stamp;
  if (strikes(options_.state_loss, period)) state_back_ = time + options_.loss_time * uniform_(random_);
  if (strikes(options_.wind_loss, period)) air_back_ = time + 4.0 * options_.loss_time * uniform_(random_);
  if (strikes(options_.jump_chance, period)) jump_back_ = time + 0.3 * uniform_(random_);
  GuidanceInput input = last_;
  input.time = time;
  if (time >= state_back_) {
    input.state = truth;
    input.state.position += Eigen::Vector2d(noise(options_.position_noise), noise(options_.position_noise));
    if (time < jump_back_) input.state.position += Eigen::Vector2d(100.0, -100.0);
    input.state.heading += noise(options_.angle_noise);
    input.state.roll += noise(options_.angle_noise);
    input.state.roll_rate += noise(options_.rate_noise);
  }
  if (!has_wind_) wind_ = aircraft.wind();
  has_wind_ = true;
  wind_ +=
      (options_.wind_lag > 0.0 ? std::min(1.0, period / options_.wind_lag) : 1.0) * (aircraft.wind() - wind_);
  if (time >= air_back_) {
    input.airspeed = {aircraft.airspeed() + noise(options_.airspeed_noise), time};
    input.wind = {wind_ + Eigen::Vector2d(noise(options_.wind_noise), noise(options_.wind_noise)), time};
  }
  last_ = input;
  if (strikes(options_.nan_chance, period)) input.state.heading = std::numeric_limits<double>::quiet_NaN();
  return input;
}

LateralLaw lawOf(LateralGuidance& guidance) {
  return [&guidance](const GuidanceInput& input) {
    GuidanceOutput output = guidance.update(input);
    guidance.prepare();
    return output;
  };
}

std::vector<FlightSample> flyLaw(Aircraft& aircraft, Sensors& sensors, const LateralLaw& law, double period,
                                 double duration, const std::function<bool(const FlightSample&)>& until) {
  std::vector<FlightSample> samples;
  const int count = static_cast<int>(std::lround(duration / period));
  for (int i = 0; i < count; ++i) {
    FlightSample sample;
    sample.truth = aircraft.state();
    sample.time = sample.truth.stamp;
    sample.airspeed = aircraft.airspeed();
    sample.wind = aircraft.wind();
    sample.output = law(sensors.measure(aircraft, period));
    sample.roll_reference = sample.output.roll_reference;
    samples.push_back(sample);
    if (until && until(sample)) break;
    aircraft.fly(sample.roll_reference, period);
  }
  return samples;
}

}  // namespace polyfly
