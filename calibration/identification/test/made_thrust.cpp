#include "made_thrust.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>

namespace polyfly::test {
namespace {

constexpr double kMadeGravity = 9.8066;  // [m/s^2]
constexpr double kMadeStep = 2e-3;       // [s]
constexpr int kEachRow = 10;
constexpr int kEachVoltage = 100;

// By bisection over what a motor can do.
double thrustOf(const MadeThrust& made, double command) {
  double from = 0.0, to = 3.0 * made.mass * kMadeGravity;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (from + to);
    (commandOf(made, middle) < command ? from : to) = middle;
  }
  return 0.5 * (from + to);
}

// Noise with a memory, of standard deviation 1.
class Wander {
 public:
  explicit Wander(double memory) : keep_(std::exp(-kMadeStep / memory)) {}
  double next(double normal) { return value_ = keep_ * value_ + std::sqrt(1.0 - keep_ * keep_) * normal; }

 private:
  double keep_;
  double value_ = 0.0;
};

void put(FlightSignals* signals, const char* name, double time, double value) {
  signals->series[name].time.push_back(time);
  signals->series[name].value.push_back(value);
}

}  // namespace

double commandOf(const MadeThrust& made, double thrust) {
  double command = 0.0, power = 1.0;
  for (const double coefficient : made.curve) {
    command += coefficient * power;
    power *= thrust;
  }
  return command;
}

double commandOf(const MadeThrust& made, double thrust, double voltage, double mean) {
  double from = 0.0, to = 1.5;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (from + to);
    const double present = voltage - made.sag * (middle - mean);
    const double counts = middle * std::pow(present / made.full, made.exponent);
    (counts < commandOf(made, thrust) ? from : to) = middle;
  }
  return 0.5 * (from + to);
}

FlightSignals makeThrustFlight(const MadeThrust& made, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  FlightSignals signals;
  signals.source = "made thrust " + std::to_string(seed);
  const double weight = made.mass * kMadeGravity;
  const double hover = commandOf(made, weight);
  Wander asked(0.8), wind(1.0);
  std::deque<double> on_its_way(static_cast<std::size_t>(made.delay / kMadeStep) + 1, hover);
  double height = 0.0, climb = 0.0, motor = hover, command = hover;
  for (int i = 0; i < static_cast<int>(made.duration / kMadeStep); ++i) {
    const double time = i * kMadeStep;
    const double roll = 0.1 * std::sin(0.7 * time), pitch = 0.08 * std::sin(0.9 * time + 1.0);
    const double upright = std::cos(roll) * std::cos(pitch);
    const double more = made.excitation * kMadeGravity * asked.next(normal(random));
    const double air = made.gust * wind.next(normal(random));
    if (i % kEachRow == 0) {
      const double force = made.mass * (kMadeGravity + more - 0.5 * height - 0.8 * climb);
      command = std::clamp(hover * (1.0 + 0.8 * (force / weight - 1.0)), 0.05, 1.0);
      put(&signals, "thrust_cmd", time, command);
    }
    const double voltage = made.full + (made.empty - made.full) * time / made.duration - made.sag * motor;
    on_its_way.push_back(command);
    motor += kMadeStep / made.lag * (on_its_way.front() - motor);
    on_its_way.pop_front();
    const double thrust = thrustOf(made, motor * std::pow(voltage / made.full, made.exponent));
    const double specific = thrust / made.mass - made.drag * (climb * upright - air);
    if (i % kEachRow == 0) {
      put(&signals, "specific_force_z", time, made.scale * specific + made.noise * normal(random));
      put(&signals, "roll", time, roll);
      put(&signals, "pitch", time, pitch);
      put(&signals, "yaw", time, 0.2);
      put(&signals, "vx", time, 0.0);
      put(&signals, "vy", time, 0.0);
      put(&signals, "vz", time, climb + 0.02 * normal(random));
    }
    // As a battery monitor tells it: in steps of 10 mV.
    if (i % kEachVoltage == 0 && made.logs_voltage)
      put(&signals, "voltage", time, std::round(100.0 * voltage) / 100.0);
    climb += kMadeStep * (specific * upright - kMadeGravity);
    height += kMadeStep * climb;
  }
  return signals;
}

}  // namespace polyfly::test
