// `offline_mpt` with a problem of type robust_mpc, as a user would run it.
#include <atomic>

#include "../../test/run_program.hpp"
#include "made_robust.hpp"
#include "robust_mpc/feasible_set.hpp"

namespace polyfly {
namespace {

class RobustCommand : public ToolTest {
 protected:
  void SetUp() override {
    write("made.yaml", smallRobust().text());
    MadeRobust windy = smallRobust();
    windy.disturbance = "[-0.6, 0.6]";
    write("windy.yaml", windy.text());
  }
};

TEST_F(RobustCommand, SolvesInfoEvalPlotAndVerify) {
  EXPECT_TRUE(holds(output("solve made.yaml -o made.map --stats stats.json"), "made.map: complete, "));
  const auto stats = json("stats.json");
  EXPECT_EQ(stats["vertices"], stats["vertices_proven"]);
  output("solve made.yaml -o again.map --threads 3 --quiet");
  EXPECT_EQ(text("made.map"), text("again.map"));

  output("info made.map");
  write("thetas.csv", "0.3,0,0\n0,0,0\n");
  EXPECT_TRUE(holds(output("eval made.map --csv thetas.csv"), "tau"));
  output("plot made.map --slice e_p,e_v -o slice.svg");
  output("verify made.map --samples 300 --json sampled.json");
  EXPECT_EQ(json("sampled.json")["result"], "PASSED");
  output("verify made.map --exact --json proof.json");
  const auto proof = json("proof.json");
  EXPECT_EQ(proof["proven"], true);
  EXPECT_EQ(proof["recursively_feasible"], true);
  EXPECT_EQ(proof["regions"], stats["regions"]);
}

TEST_F(RobustCommand, CertificatesAreConfirmed) {
  output("solve made.yaml -o made.map --quiet");
  output("verify made.map --exact --certificate made.cert --threads 1");
  output("verify made.map --exact --certificate again.cert --threads 3");
  EXPECT_EQ(text("made.cert"), text("again.cert"));
  const Outcome checked = check("made.cert --map made.map --problem made.yaml");
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_TRUE(holds(checked.out, "feasibility is not lost"));
  EXPECT_EQ(check("made.cert --map made.map --problem windy.yaml").exit_code, 1);
  output("solve windy.yaml -o windy.map --quiet");
  EXPECT_EQ(check("made.cert --map windy.map").exit_code, 1);
  // The certificate is of the problem that the map carries.
  expectRefused("verify made.map --exact --problem windy.yaml --certificate no.cert",
                {"the problem text that it carries"});
}

// With such a horizon the feasible set alone takes far longer than the limit.
TEST_F(RobustCommand, StopsAtItsTimeLimit) {
  MadeRobust made = smallRobust();
  made.horizon = 40;
  write("long.yaml", made.text());
  EXPECT_TRUE(holds(complaint("solve long.yaml -o long.map --time-limit 0.5", 3),
                    "long.map: stopped, nothing was written"));
  EXPECT_FALSE(exists("long.map"));
  EXPECT_TRUE(holds(complaint("solve long.yaml -o long.map --region-limit 5 --force", 2),
                    "robust_mpc takes no --region-limit"));
}

/// What a projection had found when it was stopped after so many passes.
std::vector<FeasibleSet::Facet> stoppedAfter(int passes, const RobustProgram& program) {
  std::atomic<bool> stop{false};
  std::vector<FeasibleSet::Facet> found;
  ProjectOptions options;
  options.stop = &stop;
  options.save = [&](const std::vector<FeasibleSet::Facet>& cuts) {
    found = cuts;
    stop = --passes == 0;
  };
  EXPECT_TRUE(projectFeasibleSet(program, options).interrupted);
  return found;
}

TEST_F(RobustCommand, ResumesToTheSameBytes) {
  output("solve made.yaml -o whole.map --quiet");
  EXPECT_FALSE(exists("whole.map.checkpoint"));
  expectRefused("solve made.yaml -o part.map --resume");
  const RobustProgram program = buildRobustProgram(smallRobust().problem());
  std::size_t before = 0;
  for (const int passes : {1, 2}) {
    const std::vector<FeasibleSet::Facet> cuts = stoppedAfter(passes, program);
    EXPECT_GT(cuts.size(), before);
    before = cuts.size();
    writeCuts(path("part.map.checkpoint"), cuts);
    EXPECT_TRUE(holds(complaint("solve made.yaml -o part.map", 2), "continue with --resume"));
    output("solve made.yaml -o part.map --resume --quiet");
    EXPECT_EQ(text("part.map"), text("whole.map"));
    EXPECT_FALSE(exists("part.map.checkpoint"));
  }
}

TEST_F(RobustCommand, RefusesWrongCheckpoints) {
  writeCuts(path("made.map.checkpoint"), stoppedAfter(3, buildRobustProgram(smallRobust().problem())));
  const nlohmann::json whole = json("made.map.checkpoint");
  const auto expectWrong = [&](const nlohmann::json& checkpoint, const std::string& part) {
    write("made.map.checkpoint", checkpoint.dump());
    expectRefused("solve made.yaml -o made.map --resume", {"made.map.checkpoint: " + part});
  };
  const std::size_t last = whole["cuts"].size() - 1;
  const auto expectWrongPart = [&](std::size_t field, const nlohmann::json& value, const std::string& part) {
    nlohmann::json checkpoint = whole;
    checkpoint["cuts"][last][0][field] = value;
    expectWrong(checkpoint, "half-space " + std::to_string(last) + ": " + part);
  };
  expectWrongPart(2, "12345/7", "does not follow");
  expectWrongPart(2, "-1", "has a weight");
  expectWrongPart(2, "1/0", "has a weight");
  expectWrongPart(2, "a", "is no list");
  expectWrongPart(2, 1, "is no list");
  expectWrongPart(0, 100000, "names a row");
  expectWrongPart(1, "++++++++++++++++", "has another number");
  expectWrong({{"polyfly_robust_cuts", 2}}, "is no checkpoint of a robust MPC");
  expectWrong("text", "is no checkpoint of a robust MPC");
}

TEST_F(RobustCommand, RefusesAMapOfAnotherProblem) {
  output("solve made.yaml -o made.map --quiet");
  output("verify made.map --exact --problem windy.yaml --quiet", 1);
  output("verify made.map --problem windy.yaml --samples 300 --quiet", 1);
  expectRefused("verify made.map --exact --repair -o new.map", {"there is no --repair"});
}

TEST_F(RobustCommand, SaysWhatIsWrongInAProblem) {
  MadeRobust made = smallRobust();
  made.horizon = 0;
  write("bad.yaml", made.text());
  expectRefused("solve bad.yaml -o bad.map", {"bad.yaml:", "horizon"});
  made = smallRobust();
  made.disturbance = "[-50, 50]";
  write("bad.yaml", made.text());
  expectRefused("solve bad.yaml -o bad.map", {"no parameter in the box has a solution"});
}

}  // namespace
}  // namespace polyfly
