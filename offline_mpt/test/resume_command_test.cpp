// `offline_mpt solve` stopped and resumed, alone and under mpirun: the same bytes, and a sentence for every
// refusal.
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "offline_mpt/explore.hpp"
#include "project_root.hpp"
#include "run_program.hpp"
#include "same_regions.hpp"
#include "scratch_folder.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;

// |z_i + a theta_i ...| <= 1 with a coupled cost: many regions, more with `n`.
std::string chainProblem(int n, int p) {
  std::ostringstream H, F, A, b, B, lb, ub;
  for (int i = 0; i < n; ++i) {
    H << (i > 0 ? ",[" : "[");
    F << (i > 0 ? ",[" : "[");
    for (int j = 0; j < n; ++j)
      H << (j > 0 ? "," : "") << (i == j ? 2.0 + 0.1 * i : 0.9 / (1 + std::abs(i - j)));
    for (int j = 0; j < p; ++j) F << (j > 0 ? "," : "") << ((i * 7 + j * 5) % 11 - 5.3) * 0.4;
    H << "]";
    F << "]";
  }
  for (int row = 0; row < 2 * n; ++row) {
    A << (row > 0 ? ",[" : "[");
    B << (row > 0 ? ",[" : "[");
    for (int j = 0; j < n; ++j) A << (j > 0 ? "," : "") << (row / 2 == j ? (row % 2 == 0 ? 1 : -1) : 0);
    for (int j = 0; j < p; ++j) B << (j > 0 ? "," : "") << "0";
    A << "]";
    B << "]";
    b << (row > 0 ? "," : "") << 0.5 + 0.03 * row;
  }
  for (int j = 0; j < p; ++j) {
    lb << (j > 0 ? "," : "") << -1.5;
    ub << (j > 0 ? "," : "") << 1.5;
  }
  std::ostringstream f, text;
  for (int i = 0; i < n; ++i) f << (i > 0 ? "," : "") << "0";
  text << R"({"name": "chain", "H": [)" << H.str() << R"(], "f": [)" << f.str() << R"(], "F": [)" << F.str()
       << R"(], "A": [)" << A.str() << R"(], "b": [)" << b.str() << R"(], "B": [)" << B.str()
       << R"(], "eq_ids": [], "lb": [)" << lb.str() << R"(], "ub": [)" << ub.str()
       << R"(], "A_theta": [], "b_theta": [], "out": [0]})";
  return text.str();
}

class ResumeCommand : public testing::Test {
 protected:
  void SetUp() override { writeBytes(path("small.json"), chainProblem(4, 2)); }

  std::string path(const std::string& name) const { return folder_.path(name); }

  pid_t start(std::vector<std::string> command) const {
    // Continuous integration runs as root, too.
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    // Open MPI leaks memory itself.
    setenv("ASAN_OPTIONS", "detect_leaks=0", 0);
    return startProgram(std::move(command), path("."));
  }
  Outcome wait(pid_t child) const { return waitForProgram(child, path(".")); }

  std::vector<std::string> solve(const std::string& problem, const std::string& map,
                                 const std::vector<std::string>& options) const {
    std::vector<std::string> command = {OFFLINE_MPT_PROGRAM, "solve", path(problem), "-o", path(map)};
    command.insert(command.end(), options.begin(), options.end());
    return command;
  }
  Outcome run(const std::string& map, const std::vector<std::string>& options) const {
    return wait(start(solve("small.json", map, options)));
  }

  static std::vector<std::string> underMpi(int processes, std::vector<std::string> command, int grace = 1) {
    // Grace for the rest of a job that lost a process; mpirun also waits for it at a regular end.
    std::vector<std::string> all = {MPI_LAUNCHER,
                                    "--oversubscribe",
                                    "--bind-to",
                                    "none",
                                    "--mca",
                                    "btl",
                                    "self,vader",
                                    "--mca",
                                    "odls_base_sigkill_timeout",
                                    std::to_string(grace),
                                    "-n",
                                    std::to_string(processes)};
    all.insert(all.end(), command.begin(), command.end());
    return all;
  }

  ScratchFolder folder_;
};

TEST_F(ResumeCommand, GoesOnToTheSameBytesAndCleansUp) {
  ASSERT_EQ(run("whole.map", {"--quiet"}).exit_code, 0);
  const Outcome part = run("part.map", {"--region-limit", "5"});
  EXPECT_EQ(part.exit_code, 3);
  EXPECT_NE(part.err.find("part.map.checkpoint: holds 5 regions"), std::string::npos) << part.err;
  ASSERT_TRUE(fs::exists(path("part.map.checkpoint")));
  EXPECT_EQ(run("part.map", {"--region-limit", "9", "--resume", "--threads", "1"}).exit_code, 3);
  const Outcome rest = run("part.map", {"--resume"});
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_EQ(readBytes(path("part.map")), readBytes(path("whole.map")));
  EXPECT_FALSE(fs::exists(path("part.map.checkpoint")));
}

// Costs (t_0 + 0.5) z_0 + t_1 z_1 over z_0 >= -1, |z_1| <= 1: two regions, none where t_0 < -0.5.
TEST_F(ResumeCommand, SaysThatTheCostIsUnboundedBeforeTheEnd) {
  writeBytes(path("small.json"), R"({"name": "tilted", "H": [[0, 0], [0, 0]], "f": [0.5, 0],
    "F": [[1, 0], [0, 1]], "A": [[-1, 0], [0, 1], [0, -1]], "b": [1, 1, 1], "B": [[0, 0], [0, 0], [0, 0]],
    "eq_ids": [], "lb": [-2, -2], "ub": [2, 2], "A_theta": [], "b_theta": [], "out": [0, 1]})");
  ASSERT_EQ(run("whole.map", {"--quiet"}).exit_code, 1);
  const Outcome part = run("part.map", {"--region-limit", "1", "--stats", path("stats.json")});
  EXPECT_EQ(part.exit_code, 3) << part.err;
  for (const char* words : {"limit reached: kept the 1 regions", "continue with --resume",
                            "the cost is unbounded below at theta = (-"}) {
    EXPECT_NE(part.err.find(words), std::string::npos) << words << " in: " << part.err;
  }
  EXPECT_NE(part.out.find("limited, 1 regions"), std::string::npos) << part.out;
  const std::string stats = readBytes(path("stats.json"));
  EXPECT_NE(stats.find("\"status\": \"limited\""), std::string::npos) << stats;
  EXPECT_NE(stats.find("\"unbounded_at\": ["), std::string::npos) << stats;

  // Nothing is written beside an existing map: it is said all the same.
  const Outcome again = run("part.map", {"--region-limit", "1", "--resume"});
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_NE(again.err.find("the existing file stands"), std::string::npos) << again.err;
  EXPECT_NE(again.err.find("the cost is unbounded below at theta = (-"), std::string::npos) << again.err;

  EXPECT_EQ(run("part.map", {"--resume", "--force", "--quiet"}).exit_code, 1);
  EXPECT_EQ(readBytes(path("part.map")), readBytes(path("whole.map")));
}

// A problem that is explored at once, and whose search tree takes minutes.
TEST_F(ResumeCommand, IsStoppedWhileTheSearchTreeIsBuilt) {
  writeBytes(path("many.json"), chainProblem(8, 7));
  const auto expect_kept = [&](const Outcome& result, const std::string& map) {
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_NE(result.err.find(map + ": not written: stopped while its search tree was built"),
              std::string::npos)
        << result.err;
    EXPECT_NE(result.err.find(map + ".checkpoint holds all "), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(path(map)));
    EXPECT_TRUE(fs::exists(path(map + ".checkpoint")));
  };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const std::string map = "by_signal_" + std::to_string(signal) + ".map";
    const pid_t child = start(solve("many.json", map, {"--quiet", "--tree", "small"}));
    while (!fs::exists(path(map + ".checkpoint"))) {
      ASSERT_EQ(waitpid(child, nullptr, WNOHANG), 0) << "ended by itself";
      sched_yield();
    }
    kill(child, signal);
    expect_kept(wait(child), map);
  }
  // A complete exploration is resumed at its search tree, with a limit for this run.
  const pid_t resumed =
      start(solve("many.json", "by_signal_2.map", {"--resume", "--time-limit", "3", "--tree", "small"}));
  expect_kept(wait(resumed), "by_signal_2.map");
}

TEST_F(ResumeCommand, BuildsTheSearchTreeOfACompleteExploration) {
  ASSERT_EQ(run("whole.map", {"--quiet"}).exit_code, 0);
  ExploreOptions options;
  options.checkpoint = path("again.map.checkpoint");
  ASSERT_EQ(explore(loadProgramJson(path("small.json")), options).status, ExploreStatus::kComplete);
  const Outcome rest = run("again.map", {"--resume", "--quiet"});
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_EQ(readBytes(path("again.map")), readBytes(path("whole.map")));
  EXPECT_FALSE(fs::exists(path("again.map.checkpoint")));
}

TEST_F(ResumeCommand, ASecondSignalDoesNotLoseTheExploration) {
  writeBytes(path("long.json"), chainProblem(14, 8));
  const pid_t child =
      start(solve("long.json", "long.map", {"--threads", "1", "--checkpoint-period", "0.01"}));
  while (!fs::exists(path("long.map.checkpoint"))) {
    ASSERT_EQ(waitpid(child, nullptr, WNOHANG), 0) << "ended by itself";
    sched_yield();
  }
  for (const int signal : {SIGINT, SIGINT, SIGTERM, SIGHUP}) kill(child, signal);
  const Outcome result = wait(child);
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_NE(result.err.find("long.map.checkpoint: holds"), std::string::npos) << result.err;
}

TEST_F(ResumeCommand, MemoryLimitTakesSuffixes) {
  writeBytes(path("small.json"), chainProblem(6, 3));
  const Outcome part = run("part.map", {"--memory-limit", "24k"});
  EXPECT_EQ(part.exit_code, 3) << part.err;
  EXPECT_NE(part.err.find("--resume"), std::string::npos) << part.err;
  EXPECT_EQ(run("part.map", {"--memory-limit", "1G", "--resume"}).exit_code, 0);
  EXPECT_EQ(run("x.map", {"--memory-limit", "1 parsec"}).exit_code, 2);
}

TEST_F(ResumeCommand, RefusesWithASentence) {
  const auto refuse = [&](const std::vector<std::string>& options, const std::string& words) {
    const Outcome result = run("x.map", options);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  refuse({"--resume"}, "x.map.checkpoint: there is no checkpoint to resume");
  ASSERT_EQ(run("x.map", {"--region-limit", "5"}).exit_code, 3);
  refuse({}, "x.map.checkpoint: an unfinished run left this");
  const std::string bytes = readBytes(path("x.map.checkpoint"));
  writeBytes(path("x.map.checkpoint"), bytes.substr(0, bytes.size() / 2));
  refuse({"--resume"}, "x.map.checkpoint: is cut off");
  writeBytes(path("x.map.checkpoint"), bytes);
  writeBytes(path("small.json"), chainProblem(4, 3));
  refuse({"--resume"}, "belongs to another problem");
  EXPECT_EQ(run("x.map", {"--force"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(path("x.map.checkpoint")));
}

TEST_F(ResumeCommand, MpirunGivesTheSameBytes) {
  if (std::string(MPI_LAUNCHER).empty()) GTEST_SKIP() << "built without MPI";
  ASSERT_EQ(run("whole.map", {"--quiet"}).exit_code, 0);
  const std::string whole = readBytes(path("whole.map"));
  for (int processes = 1; processes <= 3; ++processes) {
    const Outcome result =
        wait(start(underMpi(processes, solve("small.json", "mpi.map",
                                             {"--quiet", "--threads", "1", "--stats", path("stats.json")}))));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(readBytes(path("mpi.map")), whole) << processes << " processes";
    const auto stats = nlohmann::json::parse(readBytes(path("stats.json")));
    EXPECT_EQ(stats["processes"], processes);
  }
  EXPECT_EQ(wait(start(underMpi(2, solve("small.json", "part.map", {"--region-limit", "7"})))).exit_code, 3);
  EXPECT_EQ(run("part.map", {"--resume"}).exit_code, 0);
  EXPECT_EQ(readBytes(path("part.map")), whole);
}

TEST_F(ResumeCommand, MpirunProvesWithTheSameBytes) {
  if (std::string(MPI_LAUNCHER).empty()) GTEST_SKIP() << "built without MPI";
  ASSERT_EQ(run("small.map", {"--quiet"}).exit_code, 0);
  const auto prove = [this](const std::string& certificate) {
    return std::vector<std::string>{OFFLINE_MPT_PROGRAM, "verify",        path("small.map"),
                                    "--exact",           "--certificate", path(certificate)};
  };
  const Outcome alone = wait(start(prove("alone.cert")));
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  for (int processes = 2; processes <= 3; ++processes) {
    const Outcome result = wait(start(underMpi(processes, prove("group.cert"))));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, alone.out);
    EXPECT_EQ(readBytes(path("group.cert")), readBytes(path("alone.cert"))) << processes << " processes";
  }
}

TEST_F(ResumeCommand, MpirunSaysOnceWhatIsWrong) {
  if (std::string(MPI_LAUNCHER).empty()) GTEST_SKIP() << "built without MPI";
  const Outcome result = wait(start(underMpi(2, solve("none.json", "x.map", {}))));
  EXPECT_EQ(result.exit_code, 2) << result.err;
  const std::size_t first = result.err.find("offline_mpt: ");
  ASSERT_NE(first, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("offline_mpt: ", first + 1), std::string::npos) << result.err;
}

// Process 0 runs one command, process 1 another, as where a file differs between two machines.
TEST_F(ResumeCommand, ProcessesOfMpirunThatReadOtherFilesAllEnd) {
  if (std::string(MPI_LAUNCHER).empty()) GTEST_SKIP() << "built without MPI";
  const std::string robust = problemFile("reference/robust_lateral.yaml");
  const auto solveFile = [this](const std::string& problem) {
    return std::vector<std::string>{OFFLINE_MPT_PROGRAM, "solve", problem, "-o", path("x.map"), "--quiet"};
  };
  const auto prove = [this](const std::string& map) {
    return std::vector<std::string>{OFFLINE_MPT_PROGRAM, "verify", path(map), "--exact", "--quiet"};
  };
  ASSERT_EQ(wait(start(solve("small.json", "small.map", {"--quiet"}))).exit_code, 0);
  ASSERT_EQ(wait(start({OFFLINE_MPT_PROGRAM, "solve", robust, "-o", path("robust.map")})).exit_code, 0);
  const auto inShell = [](const std::vector<std::string>& command) {
    std::string text = "exec";
    for (const std::string& word : command) text += " '" + word + "'";
    return text;
  };
  const auto refuse = [&](const std::vector<std::string>& first, const std::vector<std::string>& second,
                          const std::vector<std::string>& words) {
    // Not by mpirun's ':', on which that of Debian 13 crashes.
    const std::string script =
        "if [ $OMPI_COMM_WORLD_RANK = 0 ]; then " + inShell(first) + "; else " + inShell(second) + "; fi";
    const Outcome result = wait(start(underMpi(2, {"sh", "-c", script})));
    EXPECT_EQ(result.exit_code, 2) << result.err;
    for (const std::string& word : words) EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
  };
  const std::string ordinary = " of a parametric program", own = " of type robust_mpc";
  refuse(prove("small.map"), prove("robust.map"), {"process 0: proof", ordinary, "process 1: proof", own});
  refuse(prove("small.map"), prove("none.map"), {"process 0: proof", "process 1: ", "none.map: "});
  refuse(solveFile(robust), solveFile(path("small.json")), {own, "process 1: problem", ordinary});
  EXPECT_FALSE(fs::exists(path("x.map")));
}

// The process of this number in the job of `launcher`; 0 while there is none.
pid_t memberOf(pid_t launcher, int rank) {
  const std::string wanted = "OMPI_COMM_WORLD_RANK=" + std::to_string(rank);
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string status = readBytes(entry.path() / "status");
    if (status.find("PPid:\t" + std::to_string(launcher) + "\n") == std::string::npos) continue;
    if (readBytes(entry.path() / "environ").find(wanted + '\0') != std::string::npos) return std::stoi(name);
  }
  return 0;
}

TEST_F(ResumeCommand, LosingAProcessOfMpirunLeavesACheckpoint) {
  if (std::string(MPI_LAUNCHER).empty()) GTEST_SKIP() << "built without MPI";
  writeBytes(path("long.json"), chainProblem(12, 6));
  const pid_t launcher = start(underMpi(
      3,
      solve("long.json", "long.map", {"--threads", "1", "--checkpoint-period", "0.01", "--time-limit", "60"}),
      4));
  while (!fs::exists(path("long.map.checkpoint"))) {
    ASSERT_EQ(waitpid(launcher, nullptr, WNOHANG), 0) << "ended by itself: " << readBytes(path("stderr"));
    sched_yield();
  }
  const pid_t victim = memberOf(launcher, 2);
  ASSERT_GT(victim, 0);
  kill(victim, SIGKILL);
  const Outcome result = wait(launcher);
  EXPECT_NE(result.exit_code, 0);
  EXPECT_NE(result.err.find("process 2 of the MPI job was lost"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("long.map.checkpoint: holds"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(path("long.map")));

  // One process goes on from there as if it had done it all.
  const ParametricProgram program = loadProgramJson(path("long.json"));
  ExploreOptions options;
  options.checkpoint = path("long.map.checkpoint");
  options.region_limit = 1;
  options.resume = true;
  const Partition kept = explore(program, options);
  ASSERT_GT(kept.stats.resumed_regions, 0u);
  ExploreOptions afresh;
  options.region_limit = afresh.region_limit = kept.stats.resumed_regions + 50;
  expectSameRegions(explore(program, options), explore(program, afresh));
}

}  // namespace
}  // namespace polyfly
