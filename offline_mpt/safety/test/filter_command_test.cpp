// `offline_mpt` with a problem of type safety_filter, as a user would run it, and the exported C against an adversary.
#include "../../test/run_program.hpp"
#include "made_filters.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "region_maps/write_map.hpp"
#include "safety_filter/safe_set.hpp"

namespace polyfly {
namespace {

class FilterCommand : public ToolTest {
 protected:
  /// Runs a program of the system, the first of the words.
  Outcome runProgram(const std::string& line) const {
    return wait(start(splitAtBlanks("/usr/bin/env", line)));
  }
};

TEST_F(FilterCommand, EveryCommandTakesItsMap) {
  MadeFilter made;
  made.period = 0.2;
  made.delay = 0.05;
  made.margin = 1e-5;
  made.disturbance = 0.1;
  write("made.yaml", made.text());
  output("solve made.yaml -o made.map --stats stats.json");
  output("solve made.yaml -o again.map --threads 3 --quiet");
  EXPECT_EQ(text("made.map"), text("again.map"));

  EXPECT_TRUE(
      holds(output("verify made.map --exact --json proof.json --certificate made.cert"), "safe set: PROVEN"));
  const auto proof = json("proof.json");
  EXPECT_EQ(proof["verdict"], "PROVEN");
  EXPECT_EQ(proof["safe_set"]["result"], "PROVEN");
  EXPECT_EQ(proof["safe_set"]["passes_wishes"], true);
  EXPECT_EQ(proof["safe_set"]["answers_within_margin"], true);
  EXPECT_EQ(proof["safe_set"]["states"][2]["name"], "a_before");
  EXPECT_EQ(check("made.cert --map made.map").exit_code, 0);
  output("verify made.map --problem made.yaml --samples 300");

  // Nothing is to be repaired, so no new map is written.
  output("verify made.map --exact --repair -o repaired.map");

  output("info made.map");
  write("thetas.csv", "0,0,0,1\n1.4,1.4,0,5\n");
  output("eval made.map --csv thetas.csv");
  output("reduce made.map -o small.map");
  output("explore made.map -o made.html");
  EXPECT_FALSE(holds(text("made.html"), "problem text cannot be used"));
}

// The law without active rows is the wish bit for bit, whatever the weight divides to.
TEST_F(FilterCommand, AnyWeightPassesWishes) {
  for (const std::string weight : {"3", "0.7", "1e-6", "1e9"}) {
    MadeFilter made;
    made.margin = 1e-4;
    const std::string one = replaced(made.text(), "unit: m/s^2", "unit: m/s^2, weight: " + weight);
    write("two.yaml", replaced(one, "  A: [[0, 1], [0, 0]]\n  B: [[0], [1]]\n",
                               "    - {name: s, unit: m/s, range: [-0.2, 0.1]}\n"
                               "  A: [[0, 1], [0, 0]]\n  B: [[0, 1], [1, 0.2]]\n"));
    output("solve two.yaml -o two.map --quiet --force");
    EXPECT_TRUE(holds(output("verify two.map --exact --certificate two.cert"),
                      "an admissible wish comes back unchanged"))
        << weight;
    const Outcome checked =
        wait(start(splitAtBlanks(CHECK_PROBLEM, "two.cert --map two.map --problem two.yaml")));
    EXPECT_EQ(checked.exit_code, 0) << checked.err;
  }
}

TEST_F(FilterCommand, TheHeadlineCountsTheSafeSet) {
  // The map of a margin that leaves no slack for rounding: optimal, but its answers are not proven.
  const SafetyFilterProblem problem = MadeFilter().problem();
  const std::string completed = withSafeSet(problem, computeSafeSet(problem));
  const ParametricProgram program =
      filterProgram(parseSafetyFilter(replaced(completed, "margin: 1e-08", "margin: 1e-09"), "made.yaml"));
  writeMap(encode(program, explore(program)), path("tight.map"));
  const std::string proven = output("verify tight.map --exact", 1);
  EXPECT_TRUE(holds(proven, "exact verification: NOT PROVEN"));
  EXPECT_FALSE(holds(proven, "exact verification: PROVEN"));
}

TEST_F(FilterCommand, LimitsAndSignalsEndEveryPhase) {
  write("made.yaml", MadeFilter().text());
  output("solve made.yaml -o made.map --time-limit 0.001", 3);
  EXPECT_FALSE(exists("made.map"));
  output("solve made.yaml -o made.map --quiet");
  EXPECT_TRUE(holds(complaint("verify made.map --exact --time-limit 0.001", 3), "interrupted"));
}

TEST_F(FilterCommand, BadProblemsAreTold) {
  const auto expectBad = [&](const std::string& problem, const std::string& part) {
    write("bad.yaml", problem);
    expectRefused("solve bad.yaml -o bad.map", {part});
  };
  const std::string made = MadeFilter().text();
  const auto expectBadField = [&](const std::string& from, const std::string& to, const std::string& part) {
    expectBad(replaced(made, from, to), part);
  };
  expectBadField("delay: 0", "delay: 0.06", "delay: must be from 0 to sampling_time");
  expectBadField("margin: 1e-08", "margin: 0", "margin: must be from 1e-9 to 0.1");
  expectBadField("margin:", "magrin:", "magrin");
  expectBadField("unit: m/s^2", "weight: 0, unit: m/s^2", "weight: must be greater than 0");
  expectBadField("error: 0}", "error: -1}", "error: must be at least 0");
  expectBadField("name: v", "name: p", "duplicate name 'p'");
  expectBadField("sampling_time: 0.050000000000000003", "sampling_time: 9", "sampling_time: ");
  expectBadField("name: v", "name: a_wish", "a_wish is the name of the wish");
  MadeFilter weak;
  weak.disturbance = 3.0;
  expectBad(weak.text(), "no set of states can be kept");
  // A set of one's own that is no invariant one.
  const std::string box =
      "safe_set:\n  H: [[1, 0], [-1, 0], [0, 1], [0, -1]]\n  k: [1, 1, 1, 1]\n"
      "  G: [[0], [0], [0.05], [-0.05]]\n  b: [1, 1, 1, 1]\n"
      "  M: [[-1, -0.05], [1, 0.05], [0, -1], [0, 1]]\n";
  expectBadField("name: made\n", "name: made\n" + box, "safe_set: not proven: ");
  const std::string short_set = "safe_set: {H: [[1, 0]], k: [1], G: [[0], [1]], b: [1], M: [[0, 0]]}\n";
  expectBadField("name: made\n", "name: made\n" + short_set, "safe_set.G: must have 1 rows");
  const std::string no_row = "safe_set: {H: [[0, 0]], k: [1], G: [[0]], b: [1], M: [[0, 0]]}\n";
  expectBadField("name: made\n", "name: made\n" + no_row, "safe_set.H: row 0 must not be 0");
}

// The whole way of a user: problem file, map, C code, compiler. ./run bench safety takes 1e9 steps.
TEST_F(FilterCommand, TheExportedFilterKeepsTheRangesAgainstAnAdversary) {
  output("solve problems/safety/double_integrator.yaml -o filter.map --quiet --stats stats.json");
  EXPECT_LE(json("stats.json")["regions"], 200);
  output("verify filter.map --exact --quiet");
  output("export filter.map -o c --name filter");
  write("adversary.c", fileText(projectRoot() + "/test/bench/safety_adversary.c"));
  const Outcome compiled = runProgram(
      "gcc -std=c99 -O2 -Wall -Wextra -Werror -ffp-contract=off -Ic adversary.c c/filter.c -o adversary -lm");
  ASSERT_EQ(compiled.exit_code, 0) << compiled.err;
  // The input may be off by as much as the proof allows.
  EXPECT_EQ(json("c/filter.json")["error_allowed"][0], 1e-6);
  const Outcome flown = runProgram("./adversary 2000000 5 1e-6");
  EXPECT_EQ(flown.exit_code, 0) << flown.out;
  const auto counts = nlohmann::json::parse(flown.out);
  EXPECT_EQ(counts["left"], 0);
  EXPECT_EQ(counts["unanswered"], 0);
  // The adversary comes near the edges, so the ranges are tight.
  EXPECT_GT(counts["greatest_p"], 1.49);
  EXPECT_GT(counts["greatest_v"], 1.49);
}

// Code of floats, with the error that a problem has to allow for it.
TEST_F(FilterCommand, TheProofAllowsTheErrorOfTheExportedCodeOrTheCommandTells) {
  const std::string allowed = text("problems/safety/double_integrator_float.yaml");
  const auto expectExported = [&](const std::string& problem, bool is_allowed) {
    write("filter.yaml", problem);
    output("solve filter.yaml -o filter.map --quiet --force");
    const std::string warning = complaint("export filter.map -o c --name filter --type float", 0);
    if (is_allowed) {
      EXPECT_EQ(warning, "");
    } else {
      EXPECT_TRUE(holds(warning, "exceeds what the safety filter's proof allows"));
    }
    EXPECT_EQ(json("c/filter.json")["is_allowed"], is_allowed);
  };
  expectExported(replaced(allowed, "error: 0.005", "error: 1.0e-4"), false);
  EXPECT_TRUE(holds(text("c/filter.h"), "NOT within that"));

  expectExported(allowed, true);
  const double bound = json("c/filter.json")["error_bound"][0];
  EXPECT_LE(bound, 0.005);
  output("verify filter.map --exact --quiet");
  EXPECT_EQ(check("--export c --map filter.map").exit_code, 0);
  write("adversary.c", fileText(projectRoot() + "/test/bench/safety_adversary.c"));
  const Outcome compiled =
      runProgram("gcc -std=c99 -O2 -DREAL=float -Ic adversary.c c/filter.c -o adversary -lm");
  ASSERT_EQ(compiled.exit_code, 0) << compiled.err;
  const Outcome flown = runProgram("./adversary 2000000 5 " + std::to_string(0.005 - bound) + " 2");
  EXPECT_EQ(flown.exit_code, 0) << flown.out;
}

// Position, velocity and the acceleration that follows its command with a lag.
TEST_F(FilterCommand, TheLagOfTheAttitudeIsAStateOfAShippedProblem) {
  output("solve problems/safety/fence_x_lag.yaml -o lag.map --quiet");
  output("verify lag.map --exact --quiet");
  output("export lag.map -o c --name lag");
  EXPECT_EQ(json("c/lag.json")["is_allowed"], true);
  EXPECT_EQ(check("--export c --map lag.map").exit_code, 0);
  ASSERT_EQ(runProgram("gcc -std=c99 -O2 -ffp-contract=off c/lag.c c/lag_test.c -o lag_test").exit_code, 0);
  EXPECT_EQ(runProgram("./lag_test").exit_code, 0);
}

}  // namespace
}  // namespace polyfly
