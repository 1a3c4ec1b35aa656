// `offline_mpt solve` stopped and resumed, alone and under mpirun: the same bytes, and a sentence for every
// refusal.
#include <sched.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>

#include "offline_mpt/explore.hpp"
#include "run_program.hpp"
#include "same_regions.hpp"

namespace polyfly {
namespace {

// |z_i + a theta_i ...| <= 1 with a coupled cost: many regions, more with `n`.
std::string chainProblem(std::size_t n, std::size_t p) {
  nlohmann::json problem = {{"name", "chain"},
                            {"f", std::vector<double>(n, 0.0)},
                            {"lb", std::vector<double>(p, -1.5)},
                            {"ub", std::vector<double>(p, 1.5)},
                            {"out", {0}}};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const double distance = std::abs(static_cast<double>(i) - static_cast<double>(j));
      problem["H"][i].push_back(i == j ? 2.0 + 0.1 * static_cast<double>(i) : 0.9 / (1.0 + distance));
    }
    for (std::size_t j = 0; j < p; ++j)
      problem["F"][i].push_back((static_cast<double>((i * 7 + j * 5) % 11) - 5.3) * 0.4);
    for (const double side : {1.0, -1.0}) {
      std::vector<double> row(n, 0.0);
      row[i] = side;
      problem["b"].push_back(0.5 + 0.03 * static_cast<double>(problem["A"].size()));
      problem["A"].push_back(row);
      problem["B"].push_back(std::vector<double>(p, 0.0));
    }
  }
  return problem.dump();
}

class ResumeCommand : public ToolTest {
 protected:
  void SetUp() override {
    // Continuous integration runs as root, too.
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    // Open MPI leaks memory itself.
    setenv("ASAN_OPTIONS", "detect_leaks=0", 0);
    write("small.json", chainProblem(4, 2));
  }

  /// The words of a line of `offline_mpt`.
  static Words tool(const std::string& line) { return splitAtBlanks(OFFLINE_MPT_PROGRAM, line); }

  static Words underMpi(int processes, const Words& command, int grace = 1) {
    // Grace for the rest of a job that lost a process; mpirun also waits for it at a regular end.
    Words all = splitAtBlanks(MPI_LAUNCHER,
                              "--oversubscribe --bind-to none --mca btl self,vader --mca "
                              "odls_base_sigkill_timeout " +
                                  std::to_string(grace) + " -n " + std::to_string(processes));
    all.insert(all.end(), command.begin(), command.end());
    return all;
  }

  /// Waits for a file that a running program writes.
  void waitForFile(pid_t child, const std::string& name) const {
    while (!exists(name)) {
      ASSERT_EQ(waitpid(child, nullptr, WNOHANG), 0) << "ended by itself";
      sched_yield();
    }
  }
};

class MpiCommand : public ResumeCommand {
 protected:
  void SetUp() override {
    if (std::string(MPI_LAUNCHER).empty()) GTEST_SKIP() << "built without MPI";
    ResumeCommand::SetUp();
  }
};

TEST_F(ResumeCommand, GoesOnToTheSameBytesAndCleansUp) {
  output("solve small.json -o whole.map --quiet");
  EXPECT_TRUE(holds(complaint("solve small.json -o part.map --region-limit 5", 3),
                    "part.map.checkpoint: holds 5 regions"));
  ASSERT_TRUE(exists("part.map.checkpoint"));
  output("solve small.json -o part.map --region-limit 9 --resume --threads 1", 3);
  output("solve small.json -o part.map --resume");
  EXPECT_EQ(text("part.map"), text("whole.map"));
  EXPECT_FALSE(exists("part.map.checkpoint"));
}

// Costs (t_0 + 0.5) z_0 + t_1 z_1 over z_0 >= -1, |z_1| <= 1: two regions, none where t_0 < -0.5.
TEST_F(ResumeCommand, SaysThatTheCostIsUnboundedBeforeTheEnd) {
  write("small.json", R"({"name": "tilted", "H": [[0, 0], [0, 0]], "f": [0.5, 0],
    "F": [[1, 0], [0, 1]], "A": [[-1, 0], [0, 1], [0, -1]], "b": [1, 1, 1], "B": [[0, 0], [0, 0], [0, 0]],
    "eq_ids": [], "lb": [-2, -2], "ub": [2, 2], "A_theta": [], "b_theta": [], "out": [0, 1]})");
  output("solve small.json -o whole.map --quiet", 1);
  const Outcome part = run("solve small.json -o part.map --region-limit 1 --stats stats.json");
  EXPECT_EQ(part.exit_code, 3) << part.err;
  const std::string unbounded = "the cost is unbounded below at theta = (-";
  for (const std::string& words :
       {std::string("limit reached: kept the 1 regions"), std::string("continue with --resume"), unbounded})
    EXPECT_TRUE(holds(part.err, words));
  EXPECT_TRUE(holds(part.out, "limited, 1 regions"));
  EXPECT_EQ(json("stats.json")["status"], "limited");
  EXPECT_TRUE(json("stats.json")["unbounded_at"].is_array());

  // Nothing is written beside an existing map: it is said all the same.
  const std::string again = complaint("solve small.json -o part.map --region-limit 1 --resume", 3);
  EXPECT_TRUE(holds(again, "the existing file stands"));
  EXPECT_TRUE(holds(again, unbounded));

  output("solve small.json -o part.map --resume --force --quiet", 1);
  EXPECT_EQ(text("part.map"), text("whole.map"));
}

// A problem that is explored at once, and whose search tree takes minutes.
TEST_F(ResumeCommand, IsStoppedWhileTheSearchTreeIsBuilt) {
  write("many.json", chainProblem(8, 7));
  const auto expect_kept = [&](const Outcome& result, const std::string& map) {
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_TRUE(holds(result.err, map + ": not written: stopped while its search tree was built"));
    EXPECT_TRUE(holds(result.err, map + ".checkpoint holds all "));
    EXPECT_FALSE(exists(map));
    EXPECT_TRUE(exists(map + ".checkpoint"));
  };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const std::string map = "by_signal_" + std::to_string(signal) + ".map";
    const pid_t child = start(tool("solve many.json --quiet --tree small -o " + map));
    waitForFile(child, map + ".checkpoint");
    kill(child, signal);
    expect_kept(wait(child), map);
  }
  // A complete exploration is resumed at its search tree, with a limit for this run.
  expect_kept(run("solve many.json -o by_signal_2.map --resume --time-limit 3 --tree small"),
              "by_signal_2.map");
}

TEST_F(ResumeCommand, BuildsTheSearchTreeOfACompleteExploration) {
  output("solve small.json -o whole.map --quiet");
  ExploreOptions options;
  options.checkpoint = path("again.map.checkpoint");
  ASSERT_EQ(explore(loadProgramJson(path("small.json")), options).status, ExploreStatus::kComplete);
  output("solve small.json -o again.map --resume --quiet");
  EXPECT_EQ(text("again.map"), text("whole.map"));
  EXPECT_FALSE(exists("again.map.checkpoint"));
}

TEST_F(ResumeCommand, ASecondSignalDoesNotLoseTheExploration) {
  write("long.json", chainProblem(14, 8));
  const pid_t child = start(tool("solve long.json -o long.map --threads 1 --checkpoint-period 0.01"));
  waitForFile(child, "long.map.checkpoint");
  for (const int signal : {SIGINT, SIGINT, SIGTERM, SIGHUP}) kill(child, signal);
  const Outcome result = wait(child);
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_TRUE(holds(result.err, "long.map.checkpoint: holds"));
}

TEST_F(ResumeCommand, MemoryLimitTakesSuffixes) {
  write("small.json", chainProblem(6, 3));
  EXPECT_TRUE(holds(complaint("solve small.json -o part.map --memory-limit 24k", 3), "--resume"));
  output("solve small.json -o part.map --memory-limit 1G --resume");
  expectRefused("solve small.json -o x.map --memory-limit 1parsec");
}

TEST_F(ResumeCommand, RefusesWithASentence) {
  const std::string solve = "solve small.json -o x.map ";
  expectRefused(solve + "--resume", {"x.map.checkpoint: there is no checkpoint to resume"});
  output(solve + "--region-limit 5", 3);
  expectRefused(solve, {"x.map.checkpoint: an unfinished run left this"});
  const std::string bytes = text("x.map.checkpoint");
  write("x.map.checkpoint", bytes.substr(0, bytes.size() / 2));
  expectRefused(solve + "--resume", {"x.map.checkpoint: is cut off"});
  write("x.map.checkpoint", bytes);
  write("small.json", chainProblem(4, 3));
  expectRefused(solve + "--resume", {"belongs to another problem"});
  output(solve + "--force");
  EXPECT_FALSE(exists("x.map.checkpoint"));
}

TEST_F(MpiCommand, GivesTheSameBytes) {
  output("solve small.json -o whole.map --quiet");
  for (int processes = 1; processes <= 3; ++processes) {
    const Outcome result = wait(start(
        underMpi(processes, tool("solve small.json -o mpi.map --quiet --threads 1 --stats stats.json"))));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(text("mpi.map"), text("whole.map")) << processes << " processes";
    EXPECT_EQ(json("stats.json")["processes"], processes);
  }
  EXPECT_EQ(wait(start(underMpi(2, tool("solve small.json -o part.map --region-limit 7")))).exit_code, 3);
  output("solve small.json -o part.map --resume");
  EXPECT_EQ(text("part.map"), text("whole.map"));
}

TEST_F(MpiCommand, ProvesWithTheSameBytes) {
  output("solve small.json -o small.map --quiet");
  const std::string alone = output("verify small.map --exact --certificate alone.cert");
  for (int processes = 2; processes <= 3; ++processes) {
    const Outcome result =
        wait(start(underMpi(processes, tool("verify small.map --exact --certificate group.cert"))));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, alone);
    EXPECT_EQ(text("group.cert"), text("alone.cert")) << processes << " processes";
  }
}

TEST_F(MpiCommand, SaysOnceWhatIsWrong) {
  const Outcome result = wait(start(underMpi(2, tool("solve none.json -o x.map"))));
  EXPECT_EQ(result.exit_code, 2) << result.err;
  const std::size_t first = result.err.find("offline_mpt: ");
  ASSERT_NE(first, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("offline_mpt: ", first + 1), std::string::npos) << result.err;
}

// Process 0 runs one command, process 1 another, as where a file differs between two machines.
TEST_F(MpiCommand, ProcessesThatReadOtherFilesAllEnd) {
  const std::string robust = "problems/reference/robust_lateral.yaml";
  output("solve small.json -o small.map --quiet");
  output("solve -o robust.map " + robust);
  const auto refuse = [&](const std::string& first, const std::string& second, const Words& words) {
    const auto inShell = [](const std::string& line) {
      return "exec '" OFFLINE_MPT_PROGRAM "' " + line + " --quiet; ";
    };
    // Not by mpirun's ':', on which that of Debian 13 crashes.
    const std::string script =
        "if [ $OMPI_COMM_WORLD_RANK = 0 ]; then " + inShell(first) + "else " + inShell(second) + "fi";
    const Outcome result = wait(start(underMpi(2, {"sh", "-c", script})));
    EXPECT_EQ(result.exit_code, 2) << result.err;
    for (const std::string& word : words) EXPECT_TRUE(holds(result.err, word));
  };
  const std::string ordinary = " of a parametric program", own = " of type robust_mpc";
  refuse("verify --exact small.map", "verify --exact robust.map",
         {"process 0: proof", ordinary, "process 1: proof", own});
  refuse("verify --exact small.map", "verify --exact none.map",
         {"process 0: proof", "process 1: ", "none.map: "});
  refuse("solve -o x.map " + robust, "solve -o x.map small.json", {own, "process 1: problem", ordinary});
  EXPECT_FALSE(exists("x.map"));
}

// The process of this number in the job of `launcher`; 0 while there is none.
pid_t memberOf(pid_t launcher, int rank) {
  const std::string wanted = "OMPI_COMM_WORLD_RANK=" + std::to_string(rank);
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (!holds(fileText(entry.path() / "status"), "PPid:\t" + std::to_string(launcher) + "\n")) continue;
    if (holds(fileText(entry.path() / "environ"), wanted + '\0')) return std::stoi(name);
  }
  return 0;
}

TEST_F(MpiCommand, LosingAProcessLeavesACheckpoint) {
  write("long.json", chainProblem(12, 6));
  const pid_t launcher = start(underMpi(
      3, tool("solve long.json -o long.map --threads 1 --checkpoint-period 0.01 --time-limit 60"), 4));
  waitForFile(launcher, "long.map.checkpoint");
  const pid_t victim = memberOf(launcher, 2);
  ASSERT_GT(victim, 0);
  kill(victim, SIGKILL);
  const Outcome result = wait(launcher);
  EXPECT_NE(result.exit_code, 0);
  EXPECT_TRUE(holds(result.err, "process 2 of the MPI job was lost"));
  EXPECT_TRUE(holds(result.err, "long.map.checkpoint: holds"));
  EXPECT_FALSE(exists("long.map"));

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
