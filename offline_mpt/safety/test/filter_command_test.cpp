// `offline_mpt` with a problem of type safety_filter, as a user would run it, and the exported C against an adversary.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "../../test/run_program.hpp"
#include "made_filters.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "project_root.hpp"
#include "region_maps/write_map.hpp"
#include "safety_filter/safe_set.hpp"

namespace polyfly {
namespace {

class FilterCommand : public ::testing::Test {
 protected:
  Outcome start(std::vector<std::string> words) const {
    const std::filesystem::path folder = scratch_.path("");
    return waitForProgram(startProgram(std::move(words), folder), folder);
  }
  Outcome run(std::vector<std::string> words) const {
    words.insert(words.begin(), OFFLINE_MPT_PROGRAM);
    return start(std::move(words));
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch_.path(name), std::ios::binary) << text;
    return scratch_.path(name);
  }
  std::string path(const std::string& name) const { return scratch_.path(name); }

  ScratchFolder scratch_;
};

TEST_F(FilterCommand, EveryCommandTakesItsMap) {
  MadeFilter made;
  made.period = 0.2;
  made.delay = 0.05;
  made.margin = 1e-5;
  made.disturbance = 0.1;
  const std::string problem = write("made.yaml", made.text());
  const Outcome solved = run({"solve", problem, "-o", path("made.map"), "--stats", path("stats.json")});
  ASSERT_EQ(solved.exit_code, 0) << solved.err;
  ASSERT_EQ(run({"solve", problem, "-o", path("again.map"), "--threads", "3", "--quiet"}).exit_code, 0);
  EXPECT_EQ(readBytes(path("made.map")), readBytes(path("again.map")));

  const Outcome proven = run({"verify", path("made.map"), "--exact", "--json", path("proof.json"),
                              "--certificate", path("made.cert")});
  EXPECT_EQ(proven.exit_code, 0) << proven.out << proven.err;
  EXPECT_NE(proven.out.find("safe set: PROVEN"), std::string::npos) << proven.out;
  const auto proof = nlohmann::json::parse(readBytes(path("proof.json")));
  EXPECT_EQ(proof["verdict"], "PROVEN");
  EXPECT_EQ(proof["safe_set"]["result"], "PROVEN");
  EXPECT_EQ(proof["safe_set"]["passes_wishes"], true);
  EXPECT_EQ(proof["safe_set"]["answers_within_margin"], true);
  EXPECT_EQ(proof["safe_set"]["states"][2]["name"], "a_before");
  EXPECT_EQ(start({CHECK_CERTIFICATE, path("made.cert"), "--map", path("made.map")}).exit_code, 0);
  EXPECT_EQ(run({"verify", path("made.map"), "--problem", problem, "--samples", "300"}).exit_code, 0);

  // Nothing is to be repaired, so no new map is written.
  EXPECT_EQ(run({"verify", path("made.map"), "--exact", "--repair", "-o", path("repaired.map")}).exit_code,
            0);

  EXPECT_EQ(run({"info", path("made.map")}).exit_code, 0);
  write("thetas.csv", "0,0,0,1\n1.4,1.4,0,5\n");
  EXPECT_EQ(run({"eval", path("made.map"), "--csv", path("thetas.csv")}).exit_code, 0);
  EXPECT_EQ(run({"reduce", path("made.map"), "-o", path("small.map")}).exit_code, 0);
  EXPECT_EQ(run({"explore", path("made.map"), "-o", path("made.html")}).exit_code, 0);
  EXPECT_EQ(readBytes(path("made.html")).find("problem text cannot be used"), std::string::npos);
}

// The law without active rows is the wish bit for bit, whatever the weight divides to.
TEST_F(FilterCommand, AnyWeightPassesWishes) {
  for (const char* weight : {"3", "0.7", "1e-6", "1e9"}) {
    MadeFilter made;
    made.margin = 1e-4;
    std::string text = made.text();
    const std::string from = "unit: m/s^2";
    text.replace(text.find(from), from.size(), from + ", weight: " + weight);
    const std::string second = "  A: [[0, 1], [0, 0]]\n  B: [[0], [1]]\n";
    const std::size_t place = text.find(second);
    ASSERT_NE(place, std::string::npos);
    text.replace(
        place, second.size(),
        "    - {name: s, unit: m/s, range: [-0.2, 0.1]}\n  A: [[0, 1], [0, 0]]\n  B: [[0, 1], [1, 0.2]]\n");
    ASSERT_EQ(run({"solve", write("two.yaml", text), "-o", path("two.map"), "--quiet", "--force"}).exit_code,
              0);
    const Outcome proven = run({"verify", path("two.map"), "--exact", "--certificate", path("two.cert")});
    EXPECT_EQ(proven.exit_code, 0) << weight << "\n" << proven.out << proven.err;
    EXPECT_NE(proven.out.find("an admissible wish comes back unchanged"), std::string::npos) << proven.out;
    const Outcome checked =
        start({CHECK_PROBLEM, path("two.cert"), "--map", path("two.map"), "--problem", path("two.yaml")});
    EXPECT_EQ(checked.exit_code, 0) << checked.err;
  }
}

TEST_F(FilterCommand, TheHeadlineCountsTheSafeSet) {
  // The map of a margin that leaves no slack for rounding: optimal, but its answers are not proven.
  const SafetyFilterProblem problem = parseSafetyFilter(MadeFilter().text(), "made.yaml");
  const SafetyFilterProblem completed =
      parseSafetyFilter(withSafeSet(problem, computeSafeSet(problem)), "made.yaml");
  std::string text = completed.text;
  const std::string margin = "margin: 1e-08";
  ASSERT_NE(text.find(margin), std::string::npos);
  text.replace(text.find(margin), margin.size(), "margin: 1e-09");
  const ParametricProgram program = filterProgram(parseSafetyFilter(text, "made.yaml"));
  writeMap(encode(program, explore(program)), path("tight.map"));
  const Outcome proven = run({"verify", path("tight.map"), "--exact"});
  EXPECT_EQ(proven.exit_code, 1);
  EXPECT_NE(proven.out.find("exact verification: NOT PROVEN"), std::string::npos) << proven.out;
  EXPECT_EQ(proven.out.find("exact verification: PROVEN"), std::string::npos) << proven.out;
}

TEST_F(FilterCommand, LimitsAndSignalsEndEveryPhase) {
  const std::string problem = write("made.yaml", MadeFilter().text());
  const Outcome unsolved = run({"solve", problem, "-o", path("made.map"), "--time-limit", "0.001"});
  EXPECT_EQ(unsolved.exit_code, 3) << unsolved.err;
  EXPECT_FALSE(std::filesystem::exists(path("made.map")));
  ASSERT_EQ(run({"solve", problem, "-o", path("made.map"), "--quiet"}).exit_code, 0);
  const Outcome unproven = run({"verify", path("made.map"), "--exact", "--time-limit", "0.001"});
  EXPECT_EQ(unproven.exit_code, 3) << unproven.out << unproven.err;
  EXPECT_NE(unproven.err.find("interrupted"), std::string::npos) << unproven.err;
}

TEST_F(FilterCommand, BadProblemsAreTold) {
  const auto complaint = [&](const MadeFilter& made, const std::string& from, const std::string& to) {
    std::string text = made.text();
    if (!from.empty()) {
      const std::size_t place = text.find(from);
      EXPECT_NE(place, std::string::npos) << from;
      text.replace(place, from.size(), to);
    }
    const Outcome outcome = run({"solve", write("bad.yaml", text), "-o", path("bad.map")});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(path("bad.map")));
    return outcome.err;
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  const MadeFilter made;
  has(complaint(made, "delay: 0", "delay: 0.06"), "delay: must be from 0 to sampling_time");
  has(complaint(made, "margin: 1e-08", "margin: 0"), "margin: must be from 1e-9 to 0.1");
  has(complaint(made, "margin:", "magrin:"), "magrin");
  has(complaint(made, "unit: m/s^2", "weight: 0, unit: m/s^2"), "weight: must be greater than 0");
  has(complaint(made, "error: 0}", "error: -1}"), "error: must be at least 0");
  has(complaint(made, "name: v", "name: p"), "duplicate name 'p'");
  has(complaint(made, "sampling_time: 0.050000000000000003", "sampling_time: 9"), "sampling_time: ");
  has(complaint(made, "name: v", "name: a_wish"), "a_wish is the name of the wish");
  MadeFilter weak;
  weak.disturbance = 3.0;
  has(complaint(weak, "", ""), "no set of states can be kept");
  // A set of one's own that is no invariant one.
  const std::string box =
      "safe_set:\n  H: [[1, 0], [-1, 0], [0, 1], [0, -1]]\n  k: [1, 1, 1, 1]\n"
      "  G: [[0], [0], [0.05], [-0.05]]\n  b: [1, 1, 1, 1]\n"
      "  M: [[-1, -0.05], [1, 0.05], [0, -1], [0, 1]]\n";
  has(complaint(made, "name: made\n", "name: made\n" + box), "safe_set: not proven: ");
  const std::string short_set = "safe_set: {H: [[1, 0]], k: [1], G: [[0], [1]], b: [1], M: [[0, 0]]}\n";
  has(complaint(made, "name: made\n", "name: made\n" + short_set), "safe_set.G: must have 1 rows");
  const std::string no_row = "safe_set: {H: [[0, 0]], k: [1], G: [[0]], b: [1], M: [[0, 0]]}\n";
  has(complaint(made, "name: made\n", "name: made\n" + no_row), "safe_set.H: row 0 must not be 0");
}

// The whole way of a user: problem file, map, C code, compiler. ./run bench safety takes 1e9 steps.
TEST_F(FilterCommand, TheExportedFilterKeepsTheRangesAgainstAnAdversary) {
  const std::string problem = projectRoot() + "/region_maps/problems/safety/double_integrator.yaml";
  ASSERT_EQ(
      run({"solve", problem, "-o", path("filter.map"), "--quiet", "--stats", path("stats.json")}).exit_code,
      0);
  EXPECT_LE(nlohmann::json::parse(readBytes(path("stats.json")))["regions"], 200);
  ASSERT_EQ(run({"verify", path("filter.map"), "--exact", "--quiet"}).exit_code, 0);
  ASSERT_EQ(run({"export", path("filter.map"), "-o", path("c"), "--name", "filter"}).exit_code, 0);
  const std::string adversary = projectRoot() + "/test/bench/safety_adversary.c";
  const Outcome compiled =
      start({"/usr/bin/env", "gcc", "-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off",
             "-I" + path("c"), adversary, path("c") + "/filter.c", "-o", path("adversary"), "-lm"});
  ASSERT_EQ(compiled.exit_code, 0) << compiled.err;
  // The input may be off by as much as the proof allows.
  EXPECT_EQ(nlohmann::json::parse(readBytes(path("c/filter.json")))["error_allowed"][0], 1e-6);
  const Outcome flown = start({path("adversary"), "2000000", "5", "1e-6"});
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
  const std::string file = projectRoot() + "/region_maps/problems/safety/double_integrator_float.yaml";
  const auto exported = [&](const std::string& problem) {
    EXPECT_EQ(run({"solve", problem, "-o", path("filter.map"), "--quiet", "--force"}).exit_code, 0);
    const Outcome outcome =
        run({"export", path("filter.map"), "-o", path("c"), "--name", "filter", "--type", "float"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.err;
  };
  std::string text = readBytes(file);
  const std::string allowance = "error: 0.005";
  ASSERT_NE(text.find(allowance), std::string::npos);
  text.replace(text.find(allowance), allowance.size(), "error: 1.0e-4");
  EXPECT_NE(exported(write("tight.yaml", text)).find("exceeds what the safety filter's proof allows"),
            std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(readBytes(path("c/filter.json")))["is_allowed"], false);
  EXPECT_NE(readBytes(path("c/filter.h")).find("NOT within that"), std::string::npos);

  EXPECT_EQ(exported(file), "");
  const auto facts = nlohmann::json::parse(readBytes(path("c/filter.json")));
  EXPECT_EQ(facts["is_allowed"], true);
  EXPECT_LE(facts["error_bound"][0], 0.005);
  ASSERT_EQ(run({"verify", path("filter.map"), "--exact", "--quiet"}).exit_code, 0);
  EXPECT_EQ(start({CHECK_CERTIFICATE, "--export", path("c"), "--map", path("filter.map")}).exit_code, 0);
  const Outcome compiled = start({"/usr/bin/env", "gcc", "-std=c99", "-O2", "-DREAL=float", "-I" + path("c"),
                                  projectRoot() + "/test/bench/safety_adversary.c", path("c") + "/filter.c",
                                  "-o", path("adversary"), "-lm"});
  ASSERT_EQ(compiled.exit_code, 0) << compiled.err;
  const double rest = 0.005 - facts["error_bound"][0].get<double>();
  const Outcome flown = start({path("adversary"), "2000000", "5", std::to_string(rest), "2"});
  EXPECT_EQ(flown.exit_code, 0) << flown.out;
}

// Position, velocity and the acceleration that follows its command with a lag.
TEST_F(FilterCommand, TheLagOfTheAttitudeIsAStateOfAShippedProblem) {
  const std::string problem = projectRoot() + "/region_maps/problems/safety/fence_x_lag.yaml";
  ASSERT_EQ(run({"solve", problem, "-o", path("lag.map"), "--quiet"}).exit_code, 0);
  ASSERT_EQ(run({"verify", path("lag.map"), "--exact", "--quiet"}).exit_code, 0);
  ASSERT_EQ(run({"export", path("lag.map"), "-o", path("c"), "--name", "lag"}).exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(readBytes(path("c/lag.json")))["is_allowed"], true);
  EXPECT_EQ(start({CHECK_CERTIFICATE, "--export", path("c"), "--map", path("lag.map")}).exit_code, 0);
  ASSERT_EQ(start({"/usr/bin/env", "gcc", "-std=c99", "-O2", "-ffp-contract=off", path("c") + "/lag.c",
                   path("c") + "/lag_test.c", "-o", path("lag_test")})
                .exit_code,
            0);
  EXPECT_EQ(start({path("lag_test")}).exit_code, 0);
}

}  // namespace
}  // namespace polyfly
