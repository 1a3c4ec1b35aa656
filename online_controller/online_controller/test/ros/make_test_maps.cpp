// make_test_maps FOLDER: writes small maps for the rostests: those of the three axes, one region each, of a tracking and of
// a robust problem, damaged ones, and a safety filter that passes every wish in its box.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "../online_support.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/write_map.hpp"

namespace {

// The filter of the tests of messages: no set that is proven, and no map that is solved.
const char kFence[] = R"(polyfly_problem: 1
name: fence_x
type: safety_filter
sampling_time: 0.1
model:
  states:
    - {name: p_x, unit: m, range: [-2, 2]}
    - {name: v_x, unit: m/s, range: [-2, 2]}
  inputs:
    - {name: a_x, unit: m/s^2, range: [-2, 2]}
  A: [[0, 1], [0, 0]]
  B: [[0], [1]]
safe_set: {H: [[1, 0.25]], k: [2], G: [[0.1]], b: [2], M: [[-1, -0.3]]}
)";

polyfly::MapContent fenceContent() {
  polyfly::MapContent content = polyfly_test::axisContent(1);
  const polyfly::ParametricProgram program = polyfly::parseProgram(kFence, "yaml", "fence");
  content.problem_text = kFence;
  content.period = program.period;
  content.parameters = program.parameters;
  content.inputs = program.inputs;
  content.laws = {0.0, 0.0, 1.0, 0.0};
  return content;
}

/// A robust map that answers as the tracking map of this axis does at rest.
polyfly::MapContent robustContent(std::size_t axis, const std::string& name) {
  polyfly::MapContent content = polyfly_test::axisContent(axis);
  content.problem_text = polyfly_test::robustAxisProblem(name);
  content.period = 0.08;
  // In the place of the previous input, which has no weight.
  polyfly::Signal& velocity = content.parameters.at(content.parameters.size() - 2);
  velocity.name = std::string("v_") + "xyz"[axis] + "_ref";
  velocity.unit = "m/s";
  return content;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fputs("usage: make_test_maps FOLDER\n", stderr);
    return 2;
  }
  const std::string folder = std::string(argv[1]) + "/";
  const std::vector<std::string> names{"longitudinal", "lateral", "vertical"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    polyfly::writeMap(polyfly_test::axisContent(i), folder + names[i] + ".map");
    polyfly::writeMap(robustContent(i, names[i]), folder + "robust_" + names[i] + ".map");
  }
  polyfly::MapContent robust_firmer = robustContent(1, names[1]);
  for (std::size_t i = 0; i < 3; ++i) robust_firmer.laws[i] *= 1.2;
  polyfly::writeMap(robust_firmer, folder + "robust_firmer.map");
  // Feasible up to an error of 0.1 m to the left.
  polyfly::MapContent robust_narrow = robustContent(1, names[1]);
  polyfly_test::cutOff(robust_narrow, 0, 0.1);
  polyfly::writeMap(robust_narrow, folder + "robust_narrow.map");

  polyfly::writeMap(fenceContent(), folder + "fence.map");

  polyfly::MapContent limited = polyfly_test::axisContent(1);
  limited.solver_status = "limited";
  polyfly::writeMap(limited, folder + "limited.map");

  polyfly::MapContent infeasible = polyfly_test::axisContent(1);
  polyfly_test::cutOff(infeasible, 0, 1.0);
  polyfly::writeMap(infeasible, folder + "infeasible.map");

  // To be swapped in flight: one that answers alike, and some that must not fly.
  polyfly::MapContent firmer = polyfly_test::axisContent(1);
  for (std::size_t i = 0; i < 3; ++i) firmer.laws[i] *= 1.2;
  polyfly::writeMap(firmer, folder + "firmer.map");
  polyfly::MapContent wild = polyfly_test::axisContent(1);
  for (std::size_t i = 0; i < 3; ++i) wild.laws[i] *= -5.0;
  polyfly::writeMap(wild, folder + "wild.map");
  polyfly::MapContent restless = polyfly_test::axisContent(1);
  restless.laws.back() = 0.05;
  polyfly::writeMap(restless, folder + "restless.map");
  polyfly::MapContent slow = polyfly_test::axisContent(1);
  slow.period *= 2.0;
  polyfly::writeMap(slow, folder + "slow.map");

  std::vector<std::byte> bytes = polyfly::layOut(polyfly_test::axisContent(1));
  bytes.resize(bytes.size() / 2);
  polyfly::writeFileAtomically(folder + "truncated.map", bytes);

  bytes = polyfly::layOut(polyfly_test::axisContent(1));
  bytes[bytes.size() / 2] ^= std::byte{1};
  polyfly::writeFileAtomically(folder + "flipped.map", bytes);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
