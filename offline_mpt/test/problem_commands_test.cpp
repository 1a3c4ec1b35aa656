// A problem with a soft bound on a state itself, from the file to the proof, and the commands that rewrite problems.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "grid_map.hpp"
#include "project_root.hpp"
#include "region_maps/write_map.hpp"
#include "run_program.hpp"

namespace polyfly {
namespace {

class ProblemCommands : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path(name); }

  Outcome tool(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), OFFLINE_MPT_PROGRAM);
    return waitForProgram(startProgram(std::move(arguments), path(".")), path("."));
  }
  Outcome check(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), CHECK_CERTIFICATE);
    return waitForProgram(startProgram(std::move(arguments), path(".")), path("."));
  }

  static void expectPart(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
  }

  ScratchFolder folder_;
};

TEST_F(ProblemCommands, ASoftLimitOnTheSpeedIsSolvedProvenAndReduced) {
  const std::string problem = problemFile("lateral_speed_limit.yaml");
  const Outcome solved = tool({"solve", problem, "-o", path("speed.map")});
  ASSERT_EQ(solved.exit_code, 0) << solved.err;
  expectPart(solved.out, ": soft bound v_y: exceeded by at most ");
  expectPart(solved.out, " m/s in a prediction, at theta = (");
  expectPart(solved.out, "; linear weight 400");
  EXPECT_EQ(solved.err, "");
  const std::string notes = tool({"info", path("speed.map")}).out;
  expectPart(notes, "  soft bound v_y: exceeded by at most ");

  const Outcome sampled = tool({"verify", path("speed.map"), "--problem", problem, "--samples", "500"});
  EXPECT_EQ(sampled.exit_code, 0) << sampled.out;
  const Outcome proven = tool({"verify", path("speed.map"), "--exact", "--certificate", path("speed.cert")});
  ASSERT_EQ(proven.exit_code, 0) << proven.out;
  EXPECT_EQ(check({path("speed.cert"), "--map", path("speed.map")}).exit_code, 0);
  // A refusal names the file that is wrong.
  const Outcome swapped = check({path("speed.map"), "--map", path("speed.cert")});
  EXPECT_EQ(swapped.exit_code, 1);
  expectPart(swapped.err, "speed.cert: refused: not a region map");
  expectPart(check({path("speed.map"), "--map", path("speed.map")}).err,
             "speed.map: refused: not a certificate");
  expectPart(check({path("speed.cert"), "--map", path("speed.map"), "--problem", path("speed.map")}).err,
             "speed.map: refused: the problem file is not the one");

  const Outcome reduced =
      tool({"reduce", path("speed.map"), "-o", path("small.map"), "--certificate", path("small.cert")});
  ASSERT_EQ(reduced.exit_code, 0) << reduced.err;
  const Outcome confirmed =
      check({path("small.cert"), "--map", path("small.map"), "--reduced-from", path("speed.map")});
  EXPECT_EQ(confirmed.exit_code, 0) << confirmed.err;
  expectPart(solved.out, "complete, 181 regions");
}

TEST_F(ProblemCommands, SolveWarnsOfASlackForEachStage) {
  const std::string file = path("stages.yaml");
  std::ifstream shared_slack(problemFile("lateral_speed_limit.yaml"));
  std::string text{std::istreambuf_iterator<char>(shared_slack), {}};
  const std::string shared = ", slack: horizon";
  std::ofstream(file) << text.replace(text.find(shared), shared.size(), "");
  const Outcome limited = tool({"solve", file, "-o", path("stages.map"), "--region-limit", "200"});
  EXPECT_EQ(limited.exit_code, 3) << limited.err;
  expectPart(limited.err, "the soft bound v_y has 20 slacks, which may multiply the regions");
  // The generic form keeps the names of the slacks.
  ASSERT_EQ(tool({"condense", file, "-o", path("stages.json")}).exit_code, 0);
  const Outcome generic =
      tool({"solve", path("stages.json"), "-o", path("generic.map"), "--region-limit", "200"});
  EXPECT_EQ(generic.exit_code, 3) << generic.err;
  expectPart(generic.err, "the soft bound v_y has 20 slacks, which may multiply the regions");
}

TEST_F(ProblemCommands, ACondensedProblemHasTheSameMap) {
  const std::string problem = problemFile("lateral_speed_limit.yaml");
  const Outcome condensed = tool({"condense", problem, "-o", path("speed.json")});
  ASSERT_EQ(condensed.exit_code, 0) << condensed.err;
  expectPart(condensed.out, "4 variables, ");
  ASSERT_EQ(tool({"solve", path("speed.json"), "-o", path("generic.map"), "--quiet"}).exit_code, 0);
  ASSERT_EQ(tool({"solve", problem, "-o", path("speed.map"), "--quiet"}).exit_code, 0);
  const Outcome compared = tool({"diff", path("generic.map"), path("speed.map")});
  EXPECT_EQ(compared.exit_code, 0) << compared.out << compared.err;
  expectPart(tool({"info", path("generic.map")}).out, "v_y_ref");
  // The checker compares every number with the file, also those of u = E z + C theta + c.
  ASSERT_EQ(tool({"verify", path("generic.map"), "--exact", "--certificate", path("generic.cert")}).exit_code,
            0);
  const std::vector<std::string> confirm = {path("generic.cert"), "--map", path("generic.map"), "--problem",
                                            path("speed.json")};
  EXPECT_EQ(check(confirm).exit_code, 0) << check(confirm).err;
  expectPart(tool({"info", path("generic.map")}).out, "period      0.1 s");
}

TEST_F(ProblemCommands, TwoInputsStatesAndDisturbancesAsParametersAreProven) {
  const std::string problem = path("table.yaml");
  std::ofstream(problem) << R"(polyfly_problem: 1
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
)";
  ASSERT_EQ(tool({"solve", problem, "-o", path("table.map"), "--quiet"}).exit_code, 0);
  const Outcome sampled = tool({"verify", path("table.map"), "--problem", problem, "--samples", "500"});
  EXPECT_EQ(sampled.exit_code, 0) << sampled.out;
  const Outcome proven = tool({"verify", path("table.map"), "--exact", "--certificate", path("table.cert")});
  ASSERT_EQ(proven.exit_code, 0) << proven.out;
  EXPECT_EQ(check({path("table.cert"), "--map", path("table.map")}).exit_code, 0);
  EXPECT_EQ(tool({"explore", path("table.map"), "-o", path("table.html")}).exit_code, 0);
}

TEST_F(ProblemCommands, ATerminalSetIsAddedOnce) {
  const std::string problem = path("cart.yaml");
  std::ofstream(problem) << R"(polyfly_problem: 1
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
)";
  const Outcome added = tool({"terminal_set", problem, "-o", path("stable.yaml")});
  ASSERT_EQ(added.exit_code, 0) << added.err;
  expectPart(added.out, "proven invariant");
  EXPECT_EQ(tool({"solve", path("stable.yaml"), "-o", path("stable.map"), "--quiet"}).exit_code, 0);
  const Outcome proven = tool({"verify", path("stable.map"), "--exact"});
  EXPECT_EQ(proven.exit_code, 0) << proven.out;
  const Outcome again = tool({"terminal_set", path("stable.yaml"), "-o", path("twice.yaml")});
  EXPECT_EQ(again.exit_code, 2);
  expectPart(again.err, "terminal_set: is given already");
  EXPECT_EQ(tool({"terminal_set", path("speed.json"), "-o", path("x.yaml")}).exit_code, 2);
}

TEST_F(ProblemCommands, DiffEndsWithTheAnswer) {
  writeMap(gridMap(4, 2, {{0, 4, 0, 2, 'a'}}), path("first.map"));
  writeMap(gridMap(4, 2, {{0, 4, 0, 2, 'b'}}), path("second.map"));
  const auto diff = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"diff", path("first.map")});
    return tool(words);
  };
  EXPECT_EQ(diff({path("first.map")}).exit_code, 0);
  EXPECT_EQ(diff({path("second.map"), "--tolerance", "0.1"}).exit_code, 0);
  const Outcome different = diff({path("second.map"), "--json", path("report.json")});
  EXPECT_EQ(different.exit_code, 1) << different.err;
  expectPart(different.out, "different answers");
  expectPart(readBytes(path("report.json")), "\"different_pairs\": 1");
  EXPECT_EQ(diff({path("second.map"), "--json", path("first.map")}).exit_code, 2);
  EXPECT_EQ(diff({path("none.map")}).exit_code, 2);
}

}  // namespace
}  // namespace polyfly
