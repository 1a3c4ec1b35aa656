#include "identification/loop_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace polyfly {
namespace {

// Value of |1 - zeta^2| below which both eigenvalues count as equal.
constexpr double kNearlyCritical = 1e-6;

struct State {
  double value = 0.0;
  double rate = 0.0;  // second order only
};

// Moves a state through a time in which the command does not change, relative to where it would come to rest.
class Propagator {
 public:
  explicit Propagator(const LoopShape& shape) : shape_(shape) {}

  State operator()(const State& from, double target, double dt) const {
    if (shape_.order == LoopOrder::kFirst) {
      return {target + (from.value - target) * std::exp(-dt / shape_.tau), 0.0};
    }
    const auto [c, s] = modes(dt);
    const double damping = shape_.zeta * shape_.omega;
    const double away = from.value - target;
    return {target + (c + damping * s) * away + s * from.rate,
            -shape_.omega * shape_.omega * s * away + (c - damping * s) * from.rate};
  }

 private:
  // exp(-zeta omega dt) times cosine and sine / frequency of the damped oscillation, or their like above zeta
  // = 1.
  std::array<double, 2> modes(double dt) const {
    const double omega = shape_.omega;
    const double decay = shape_.zeta * omega;
    const double square = 1.0 - shape_.zeta * shape_.zeta;
    if (std::abs(square) < kNearlyCritical) return {std::exp(-decay * dt), dt * std::exp(-decay * dt)};
    const double beta = omega * std::sqrt(std::abs(square));
    if (square > 0.0) {
      const double envelope = std::exp(-decay * dt);
      return {envelope * std::cos(beta * dt), envelope * std::sin(beta * dt) / beta};
    }
    const double slow = std::exp((beta - decay) * dt);
    const double fast = std::exp((-beta - decay) * dt);
    return {0.5 * (slow + fast), 0.5 * (slow - fast) / beta};
  }

  LoopShape shape_;
};

std::vector<double> forcedResponse(const LoopShape& shape, const LoopSegment& segment) {
  const Propagator propagate(shape);
  const TimeSeries& command = segment.command;
  const std::size_t steps = command.time.size();
  // The first step that is still to come after the segment's start, as the loop sees it.
  std::size_t next = 0;
  while (next < steps && command.time[next] + shape.delay <= segment.time.front()) ++next;
  double target = command.value[next == 0 ? 0 : next - 1];
  State state;
  double now = segment.time.front();
  std::vector<double> response(segment.time.size());
  for (std::size_t i = 0; i < segment.time.size(); ++i) {
    while (next < steps && command.time[next] + shape.delay < segment.time[i]) {
      const double at = command.time[next] + shape.delay;
      state = propagate(state, target, at - now);
      now = at;
      target = command.value[next++];
    }
    state = propagate(state, target, segment.time[i] - now);
    now = segment.time[i];
    response[i] = state.value;
  }
  return response;
}

std::vector<double> freeResponse(const LoopShape& shape, const LoopSegment& segment, const State& initial) {
  const Propagator propagate(shape);
  std::vector<double> response(segment.time.size());
  for (std::size_t i = 0; i < response.size(); ++i) {
    response[i] = propagate(initial, 0.0, segment.time[i] - segment.time.front()).value;
  }
  return response;
}

std::vector<double> asMeasured(std::vector<double> response, const LoopSegment& segment) {
  if (segment.smoothing <= 0.0) return response;
  return smoothedMean(segment.time, cumulativeIntegral(segment.time, response), segment.smoothing);
}

}  // namespace

LoopBasis loopBasis(const LoopShape& shape, const LoopSegment& segment) {
  LoopBasis basis;
  basis.forced = asMeasured(forcedResponse(shape, segment), segment);
  basis.free.push_back(asMeasured(freeResponse(shape, segment, {1.0, 0.0}), segment));
  if (shape.order == LoopOrder::kSecond) {
    // Scaled by the frequency, so that both initial states weigh alike.
    basis.free.push_back(asMeasured(freeResponse(shape, segment, {0.0, shape.omega}), segment));
  }
  return basis;
}

}  // namespace polyfly
