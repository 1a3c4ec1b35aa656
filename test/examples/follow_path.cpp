// Guides a fixed wing from beside a line onto it, without wind. Prints the distance from the line at the end.
#include <cmath>
#include <cstdio>

#include "fixedwing_lateral/guidance.hpp"
#include "polyfly_base/error.hpp"

int main() try {
  const polyfly::GuidanceOptions options;
  polyfly::LateralGuidance guidance(options, "follow_path");
  // From the origin 2 km to the north, then a circle.
  guidance.setMission(polyfly::missionThrough({{0.0, 0.0}, {2000.0, 0.0}}, options.loiter, "follow_path"));
  polyfly::GuidanceInput input;
  input.state.position = {0.0, 60.0};  // 60 m to the east of the line
  const double airspeed = options.airspeed_nominal;
  const double lag = 0.4;  // of the roll [s]
  for (int k = 0; k < 1200; ++k) {
    polyfly::AircraftState& state = input.state;
    state.ground_velocity = airspeed * Eigen::Vector2d(std::cos(state.heading), std::sin(state.heading));
    input.time = state.stamp = k * options.period;
    input.airspeed = {airspeed, input.time};
    input.wind = {Eigen::Vector2d::Zero(), input.time};
    state.roll_rate = (guidance.update(input).roll_reference - state.roll) / lag;
    guidance.prepare();
    state.roll += options.period * state.roll_rate;
    state.heading += options.period * polyfly::kGravity * std::tan(state.roll) / airspeed;
    state.position += options.period * state.ground_velocity;
  }
  std::printf("%.4f\n", std::abs(input.state.position.y()));
  return 0;
} catch (const polyfly::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
