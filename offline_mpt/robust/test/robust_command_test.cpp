// `offline_mpt` with a problem of type robust_mpc, as a user would run it.
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <nlohmann/json.hpp>

#include "../../test/run_program.hpp"
#include "made_robust.hpp"
#include "robust_mpc/feasible_set.hpp"

namespace polyfly {
namespace {

class RobustCommand : public ::testing::Test {
 protected:
  Outcome run(std::vector<std::string> words, const char* program = OFFLINE_MPT_PROGRAM) const {
    words.insert(words.begin(), program);
    const std::filesystem::path folder = scratch_.path("");
    return waitForProgram(startProgram(std::move(words), folder), folder);
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch_.path(name), std::ios::binary) << text;
    return scratch_.path(name);
  }
  std::string path(const std::string& name) const { return scratch_.path(name); }

  ScratchFolder scratch_;
};

TEST_F(RobustCommand, SolvesInfoEvalPlotAndVerify) {
  const std::string problem = write("made.yaml", smallRobust().text());
  const Outcome solved = run({"solve", problem, "-o", path("made.map"), "--stats", path("stats.json")});
  ASSERT_EQ(solved.exit_code, 0) << solved.err;
  EXPECT_NE(solved.out.find("made.map: complete, "), std::string::npos) << solved.out;
  const auto stats = nlohmann::json::parse(readBytes(path("stats.json")));
  EXPECT_EQ(stats["vertices"], stats["vertices_proven"]);
  ASSERT_EQ(run({"solve", problem, "-o", path("again.map"), "--threads", "3", "--quiet"}).exit_code, 0);
  EXPECT_EQ(readBytes(path("made.map")), readBytes(path("again.map")));

  EXPECT_EQ(run({"info", path("made.map")}).exit_code, 0);
  write("thetas.csv", "0.3,0,0\n0,0,0\n");
  const Outcome evaluated = run({"eval", path("made.map"), "--csv", path("thetas.csv")});
  EXPECT_EQ(evaluated.exit_code, 0) << evaluated.err;
  EXPECT_NE(evaluated.out.find("tau"), std::string::npos) << evaluated.out;
  EXPECT_EQ(run({"plot", path("made.map"), "--slice", "e_p,e_v", "-o", path("slice.svg")}).exit_code, 0);

  const Outcome sampled =
      run({"verify", path("made.map"), "--samples", "300", "--json", path("sampled.json")});
  EXPECT_EQ(sampled.exit_code, 0) << sampled.out;
  EXPECT_EQ(nlohmann::json::parse(readBytes(path("sampled.json")))["result"], "PASSED");
  const Outcome proven = run({"verify", path("made.map"), "--exact", "--json", path("proof.json")});
  EXPECT_EQ(proven.exit_code, 0) << proven.out;
  const auto proof = nlohmann::json::parse(readBytes(path("proof.json")));
  EXPECT_EQ(proof["proven"], true);
  EXPECT_EQ(proof["recursively_feasible"], true);
  EXPECT_EQ(proof["regions"], stats["regions"]);
}

TEST_F(RobustCommand, CertificatesAreConfirmed) {
  const std::string problem = write("made.yaml", smallRobust().text());
  ASSERT_EQ(run({"solve", problem, "-o", path("made.map"), "--quiet"}).exit_code, 0);
  for (const char* name : {"made.cert", "again.cert"}) {
    const std::string threads = name[0] == 'm' ? "1" : "3";
    const Outcome proven =
        run({"verify", path("made.map"), "--exact", "--certificate", path(name), "--threads", threads});
    EXPECT_EQ(proven.exit_code, 0) << proven.out << proven.err;
  }
  EXPECT_EQ(readBytes(path("made.cert")), readBytes(path("again.cert")));
  const Outcome checked =
      run({path("made.cert"), "--map", path("made.map"), "--problem", problem}, CHECK_CERTIFICATE);
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_NE(checked.out.find("feasibility is not lost"), std::string::npos) << checked.out;
  MadeRobust other = smallRobust();
  other.disturbance = "[-0.6, 0.6]";
  const std::string windy = write("windy.yaml", other.text());
  EXPECT_EQ(
      run({path("made.cert"), "--map", path("made.map"), "--problem", windy}, CHECK_CERTIFICATE).exit_code,
      1);
  ASSERT_EQ(run({"solve", windy, "-o", path("windy.map"), "--quiet"}).exit_code, 0);
  EXPECT_EQ(run({path("made.cert"), "--map", path("windy.map")}, CHECK_CERTIFICATE).exit_code, 1);
  // The certificate is of the problem that the map carries.
  const Outcome refused =
      run({"verify", path("made.map"), "--exact", "--problem", windy, "--certificate", path("no.cert")});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("the problem text that it carries"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(path("no.cert")));
}

// With such a horizon the feasible set alone takes far longer than the limit.
TEST_F(RobustCommand, StopsAtItsTimeLimit) {
  MadeRobust made = smallRobust();
  made.horizon = 40;
  const std::string problem = write("long.yaml", made.text());
  const Outcome stopped = run({"solve", problem, "-o", path("long.map"), "--time-limit", "0.5"});
  EXPECT_EQ(stopped.exit_code, 3) << stopped.err;
  EXPECT_NE(stopped.err.find("long.map: stopped, nothing was written"), std::string::npos) << stopped.err;
  EXPECT_FALSE(std::filesystem::exists(path("long.map")));
  const Outcome limited = run({"solve", problem, "-o", path("long.map"), "--region-limit", "5", "--force"});
  EXPECT_EQ(limited.exit_code, 2);
  EXPECT_NE(limited.err.find("robust_mpc takes no --region-limit"), std::string::npos) << limited.err;
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
  const std::string problem = write("made.yaml", smallRobust().text());
  ASSERT_EQ(run({"solve", problem, "-o", path("whole.map"), "--quiet"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("whole.map.checkpoint")));
  EXPECT_EQ(run({"solve", problem, "-o", path("part.map"), "--resume"}).exit_code, 2);
  const RobustProgram program = buildRobustProgram(loadRobustProblem(problem));
  std::size_t before = 0;
  for (const int passes : {1, 2}) {
    const std::vector<FeasibleSet::Facet> cuts = stoppedAfter(passes, program);
    EXPECT_GT(cuts.size(), before);
    before = cuts.size();
    writeCuts(path("part.map.checkpoint"), cuts);
    const Outcome refused = run({"solve", problem, "-o", path("part.map")});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.err.find("continue with --resume"), std::string::npos) << refused.err;
    const Outcome resumed = run({"solve", problem, "-o", path("part.map"), "--resume", "--quiet"});
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_EQ(readBytes(path("part.map")), readBytes(path("whole.map")));
    EXPECT_FALSE(std::filesystem::exists(path("part.map.checkpoint")));
  }
}

TEST_F(RobustCommand, RefusesWrongCheckpoints) {
  const std::string problem = write("made.yaml", smallRobust().text());
  const RobustProgram program = buildRobustProgram(loadRobustProblem(problem));
  const std::string checkpoint = path("made.map.checkpoint");
  writeCuts(checkpoint, stoppedAfter(3, program));
  const nlohmann::json whole = nlohmann::json::parse(readBytes(checkpoint));
  const auto refusal = [&](const nlohmann::json& json) {
    write("made.map.checkpoint", json.dump());
    const Outcome refused = run({"solve", problem, "-o", path("made.map"), "--resume"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(path("made.map")));
    return refused.err;
  };
  const std::size_t last = whole["cuts"].size() - 1;
  const auto partOfLast = [&](int field, const nlohmann::json& value) {
    nlohmann::json json = whole;
    json["cuts"][last][0][static_cast<std::size_t>(field)] = value;
    return refusal(json);
  };
  const std::string name = "made.map.checkpoint: half-space " + std::to_string(last) + ": ";
  EXPECT_NE(partOfLast(2, "12345/7").find(name + "does not follow"), std::string::npos);
  EXPECT_NE(partOfLast(2, "-1").find(name + "has a weight"), std::string::npos);
  EXPECT_NE(partOfLast(2, "1/0").find(name + "has a weight"), std::string::npos);
  EXPECT_NE(partOfLast(2, "a").find(name + "is no list"), std::string::npos);
  EXPECT_NE(partOfLast(2, 1).find(name + "is no list"), std::string::npos);
  EXPECT_NE(partOfLast(0, 100000).find(name + "names a row"), std::string::npos);
  EXPECT_NE(partOfLast(1, "++++++++++++++++").find(name + "has another number"), std::string::npos);
  EXPECT_NE(refusal({{"polyfly_robust_cuts", 2}}).find("is no checkpoint of a robust MPC"),
            std::string::npos);
  EXPECT_NE(refusal("text").find("is no checkpoint of a robust MPC"), std::string::npos);
}

TEST_F(RobustCommand, RefusesAMapOfAnotherProblem) {
  const std::string problem = write("made.yaml", smallRobust().text());
  ASSERT_EQ(run({"solve", problem, "-o", path("made.map"), "--quiet"}).exit_code, 0);
  MadeRobust other = smallRobust();
  other.disturbance = "[-0.6, 0.6]";
  const std::string windy = write("windy.yaml", other.text());
  EXPECT_EQ(run({"verify", path("made.map"), "--exact", "--problem", windy, "--quiet"}).exit_code, 1);
  EXPECT_EQ(run({"verify", path("made.map"), "--problem", windy, "--samples", "300", "--quiet"}).exit_code,
            1);
  const Outcome repair = run({"verify", path("made.map"), "--exact", "--repair", "-o", path("new.map")});
  EXPECT_EQ(repair.exit_code, 2);
  EXPECT_NE(repair.err.find("there is no --repair"), std::string::npos);
}

TEST_F(RobustCommand, SaysWhatIsWrongInAProblem) {
  MadeRobust made = smallRobust();
  made.horizon = 0;
  const Outcome refused = run({"solve", write("bad.yaml", made.text()), "-o", path("bad.map")});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("bad.yaml:"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("horizon"), std::string::npos) << refused.err;
  made = smallRobust();
  made.disturbance = "[-50, 50]";
  const Outcome hopeless = run({"solve", write("windy.yaml", made.text()), "-o", path("windy.map")});
  EXPECT_EQ(hopeless.exit_code, 2);
  EXPECT_NE(hopeless.err.find("no parameter in the box has a solution"), std::string::npos) << hopeless.err;
}

}  // namespace
}  // namespace polyfly
