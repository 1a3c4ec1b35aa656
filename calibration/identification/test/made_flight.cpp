#include "made_flight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace polyfly::test {
namespace {

// Step of the integration [s].
constexpr double kStep = 1e-3;
// Shortest pulse of a manoeuvre [s].
constexpr double kPulse = 0.6;
// Margin that keeps a time on its side of a switch [s].
constexpr double kRounding = 1e-9;
// Correlation time of the coloured noise [s].
constexpr double kMemory = 0.3;
// Pause after a manoeuvre, in pulses.
constexpr double kPauses = 2.0;
constexpr double kManoeuvre = 4.0 + kPauses;

// 2-1-1: a pulse of double length, its opposite, and the first again.
using Amplitudes = std::array<double, 4>;

double commandAt(const Amplitudes& amplitudes, double time) {
  const double pulses = time / kPulse;
  const auto manoeuvre = static_cast<std::size_t>(pulses / kManoeuvre);
  const double at = pulses - static_cast<double>(manoeuvre) * kManoeuvre;
  const double amplitude = amplitudes[manoeuvre % amplitudes.size()];
  if (at < 2.0) return amplitude;
  if (at < 3.0) return -amplitude;
  return at < 4.0 ? amplitude : 0.0;
}

// The command as the loop sees it: samples that hold, later by the delay.
double heldCommand(const MadeLoop& loop, const Amplitudes& amplitudes, double time) {
  const double seen = time - loop.delay;
  if (seen < 0.0) return 0.0;
  return commandAt(amplitudes,
                   std::floor(seen * loop.command_rate + kRounding) / loop.command_rate + kRounding);
}

struct State {
  double value = 0.0;
  double rate = 0.0;
};

State derivative(const MadeLoop& loop, const State& state, double command) {
  if (loop.order == LoopOrder::kFirst) return {(loop.gain * command - state.value) / loop.tau, 0.0};
  return {state.rate, loop.gain * loop.a0 * command - loop.a1 * state.rate - loop.a0 * state.value};
}

State advance(const MadeLoop& loop, const Amplitudes& amplitudes, const State& state, double time) {
  const auto moved = [&state](const State& slope, double by) {
    return State{state.value + by * slope.value, state.rate + by * slope.rate};
  };
  const double middle = heldCommand(loop, amplitudes, time + 0.5 * kStep);
  const State k1 = derivative(loop, state, middle);
  const State k2 = derivative(loop, moved(k1, 0.5 * kStep), middle);
  const State k3 = derivative(loop, moved(k2, 0.5 * kStep), middle);
  const State k4 = derivative(loop, moved(k3, kStep), middle);
  const auto mean = [](double a, double b, double c, double d) { return (a + 2.0 * b + 2.0 * c + d) / 6.0; };
  State next =
      moved({mean(k1.value, k2.value, k3.value, k4.value), mean(k1.rate, k2.rate, k3.rate, k4.rate)}, kStep);
  return next;
}

}  // namespace

LoopRecord makeFlight(const MadeLoop& loop, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-0.2, 0.2);
  std::uniform_real_distribution<double> stretch(0.8, 1.2);
  Amplitudes amplitudes = {0.15, -0.25, 0.35, -0.1};
  for (double& amplitude : amplitudes) amplitude *= stretch(random);
  LoopRecord record;
  record.command = {{-1.0}, {0.0}};
  record.source = "made flight";
  for (int i = 0; i < static_cast<int>(loop.duration * loop.command_rate); ++i) {
    const double time = i / loop.command_rate;
    const double command = commandAt(amplitudes, time + kRounding);
    record.command.time.push_back(time);
    record.command.value.push_back(command);
  }
  State state;
  double drift = 0.0;
  double next = 0.0;
  int sample = 0;
  for (double time = 0.0; time < loop.duration; time += kStep) {
    if (time >= next) {
      record.response.time.push_back(time);
      record.response.value.push_back(state.value + loop.offset + loop.noise * normal(random) + drift);
      next = (++sample + uniform(random)) / loop.response_rate;
    }
    state = advance(loop, amplitudes, state, time);
    drift +=
        -drift * kStep / kMemory + loop.coloured_noise * std::sqrt(2.0 * kStep / kMemory) * normal(random);
  }
  return record;
}

}  // namespace polyfly::test
