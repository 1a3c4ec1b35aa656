// A problem with a soft bound on a state itself, from the file to the proof, and the commands that rewrite problems.
#include "grid_map.hpp"
#include "region_maps/write_map.hpp"
#include "run_program.hpp"

namespace polyfly {
namespace {

constexpr char kSpeedLimit[] = "problems/lateral_speed_limit.yaml";

class ProblemCommands : public ToolTest {
 protected:
  void expectSolved(const std::string& problem, const std::string& map) const {
    EXPECT_EQ(output("solve " + problem + " --quiet -o " + map), "");
  }
  /// A certificate is written, and confirmed with these options.
  void expectProven(const std::string& map, const std::string& options = "") const {
    output("verify " + map + " --exact --certificate proof.cert");
    const Outcome checked = check("proof.cert --map " + map + options);
    EXPECT_EQ(checked.exit_code, 0) << checked.err;
  }
};

TEST_F(ProblemCommands, ASoftLimitOnTheSpeedIsSolvedProvenAndReduced) {
  const Outcome solved = run(std::string("solve -o speed.map ") + kSpeedLimit);
  ASSERT_EQ(solved.exit_code, 0) << solved.err;
  for (const char* part : {": soft bound v_y: exceeded by at most ", " m/s in a prediction, at theta = (",
                           "; linear weight 400", "complete, 181 regions"})
    EXPECT_TRUE(holds(solved.out, part));
  EXPECT_EQ(solved.err, "");
  EXPECT_TRUE(holds(output("info speed.map"), "  soft bound v_y: exceeded by at most "));
  output(std::string("verify speed.map --samples 500 --problem ") + kSpeedLimit);
  expectProven("speed.map");
  // A refusal names the file that is wrong.
  const Outcome swapped = check("speed.map --map proof.cert");
  EXPECT_EQ(swapped.exit_code, 1);
  EXPECT_TRUE(holds(swapped.err, "proof.cert: refused: not a region map"));
  EXPECT_TRUE(holds(check("speed.map --map speed.map").err, "speed.map: refused: not a certificate"));
  EXPECT_TRUE(holds(check("proof.cert --map speed.map --problem speed.map").err,
                    "speed.map: refused: the problem file is not the one"));
  output("reduce speed.map -o small.map --certificate small.cert");
  const Outcome confirmed = check("small.cert --map small.map --reduced-from speed.map");
  EXPECT_EQ(confirmed.exit_code, 0) << confirmed.err;
}

TEST_F(ProblemCommands, SolveWarnsOfASlackForEachStage) {
  write("stages.yaml", replaced(text(kSpeedLimit), ", slack: horizon", ""));
  // The generic form keeps the names of the slacks.
  output("condense stages.yaml -o stages.json");
  for (const std::string file : {"stages.yaml", "stages.json"})
    EXPECT_TRUE(holds(complaint("solve -o stages.map --force --region-limit 200 " + file, 3),
                      "the soft bound v_y has 20 slacks, which may multiply the regions"));
}

TEST_F(ProblemCommands, ACondensedProblemHasTheSameMap) {
  EXPECT_TRUE(holds(output(std::string("condense -o speed.json ") + kSpeedLimit), "4 variables, "));
  expectSolved("speed.json", "generic.map");
  expectSolved(kSpeedLimit, "speed.map");
  output("diff generic.map speed.map");
  const std::string shown = output("info generic.map");
  for (const char* part : {"v_y_ref", "period      0.1 s"}) EXPECT_TRUE(holds(shown, part));
  // The checker compares every number with the file, also those of u = E z + C theta + c.
  expectProven("generic.map", " --problem speed.json");
}

TEST_F(ProblemCommands, TwoInputsStatesAndDisturbancesAsParametersAreProven) {
  write("table.yaml", R"(polyfly_problem: 1
name: table
type: tracking_mpc
model:
  time: discrete
  states: [{name: p, unit: m}, {name: v, unit: m/s}]
  inputs:
    - {name: a, unit: m/s^2, range: [-1, 1]}
    - {name: w, unit: m/s, range: [-0.5, 0.4]}
  disturbances: [{name: d, unit: m/s^2}]
  A: [[1, 0.5], [0, 1]]
  B: [[0.125, 0.5], [0.5, 0]]
  B_d: [[0.125], [0.5]]
  C: [[1, 0], [0, 1]]
sampling_time: 0.5
horizon: 5
moves: [1, 1, 3]
weights: {Q: [4, 1], R: [0.5, 2], terminal: [[9, 1], [1, 5]]}
constraints:
  - {of: v, range: [-1, 1], soft: {linear: 50, quadratic: 1, slack: horizon}}
  - {name: sum, of: {a: 1, w: 2}, unit: m/s^2, upper: 1.2}
parameters:
  - {name: p, role: state, of: p, unit: m, range: [-2, 2]}
  - {name: v, role: state, of: v, unit: m/s, range: [-1.5, 1.5]}
  - {name: gust, role: disturbance, of: d, unit: m/s^2, range: [-0.3, 0.3]}
  - {name: p_goal, role: reference, of: p, unit: m, value: 0.5}
)");
  expectSolved("table.yaml", "table.map");
  output("verify table.map --problem table.yaml --samples 500");
  expectProven("table.map");
  output("explore table.map -o table.html");
}

TEST_F(ProblemCommands, ATerminalSetIsAddedOnce) {
  write("cart.yaml", R"(polyfly_problem: 1
name: cart
type: tracking_mpc
model:
  time: discrete
  states: [{name: p, unit: m}, {name: v, unit: m/s}]
  inputs: [{name: a, unit: m/s^2, range: [-1, 1]}]
  A: [[1, 0.5], [0, 1]]
  B: [[0.125], [0.5]]
  C: [[1, 0]]
sampling_time: 0.5
horizon: 4
weights: {Q: [4, 1], R: [0.5]}
constraints: [{of: v, range: [-1, 1]}]
parameters:
  - {name: e_p, role: error, of: p, unit: m, range: [-4, 4]}
  - {name: e_v, role: error, of: v, unit: m/s, range: [-2, 2]}
)");
  EXPECT_TRUE(holds(output("terminal_set cart.yaml -o stable.yaml"), "proven invariant"));
  expectSolved("stable.yaml", "stable.map");
  output("verify stable.map --exact");
  expectRefused("terminal_set stable.yaml -o twice.yaml", {"terminal_set: is given already"});
  expectRefused("terminal_set speed.json -o x.yaml");
}

TEST_F(ProblemCommands, DiffEndsWithTheAnswer) {
  writeMap(gridMap(4, 2, {{0, 4, 0, 2, 'a'}}), path("first.map"));
  writeMap(gridMap(4, 2, {{0, 4, 0, 2, 'b'}}), path("second.map"));
  output("diff first.map first.map");
  output("diff first.map second.map --tolerance 0.1");
  EXPECT_TRUE(holds(output("diff first.map second.map --json report.json", 1), "different answers"));
  EXPECT_EQ(json("report.json")["different_pairs"], 1);
  expectRefused("diff first.map second.map --json first.map");
  expectRefused("diff first.map none.map");
}

}  // namespace
}  // namespace polyfly
