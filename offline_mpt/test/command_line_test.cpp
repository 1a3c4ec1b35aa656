// Runs the program `offline_mpt` as a user would: what it prints, what it returns, what it leaves behind.
#include <sched.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "polyfly_base/version.hpp"
#include "run_program.hpp"

namespace polyfly {
namespace {

class CommandLine : public ToolTest {
 protected:
  void SetUp() override { write("toy.json", kToy); }

  void solveToy() const { output("solve toy.json -o toy.map"); }
  std::uintmax_t size(const std::string& name) const { return std::filesystem::file_size(path(name)); }
  nlohmann::json info(const std::string& map) const {
    return nlohmann::json::parse(output("info " + map + " --json"));
  }
  /// Writes the toy problem with these fields in the place of its own.
  void writeToy(const std::string& name, const std::string& fields) const {
    nlohmann::json problem = nlohmann::json::parse(kToy);
    problem.update(nlohmann::json::parse(fields));
    write(name, problem.dump());
  }
};

TEST_F(CommandLine, SolvesAndWritesStatistics) {
  const Outcome result = run("solve toy.json -o toy.map --stats stats.json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(holds(result.out, "complete, 3 regions"));
  EXPECT_EQ(result.err, "");
  const nlohmann::json stats = json("stats.json");
  EXPECT_EQ(stats["status"], "complete");
  EXPECT_EQ(stats["regions"], 3);
  EXPECT_EQ(stats["parameters"], 2);
  EXPECT_EQ(stats["bytes"].get<std::uintmax_t>(), size("toy.map"));
}

TEST_F(CommandLine, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const std::string threads : {"1", "2", "5"}) {
    const Outcome result = run("solve toy.json --quiet -o " + threads + " --threads " + threads);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out + result.err, "");
    EXPECT_EQ(text(threads), text("1"));
  }
}

TEST_F(CommandLine, ShowsWhatAMapHolds) {
  solveToy();
  const std::string shown = output("info toy.map");
  for (const char* word : {"complete", "-2 .. 2", "regions     3", "worst case", "period      none"})
    EXPECT_TRUE(holds(shown, word));
  const nlohmann::json toy = info("toy.map");
  EXPECT_EQ(toy["regions"], 3);
  EXPECT_EQ(toy["parameters"].size(), 2u);
  EXPECT_EQ(toy["parameters"][0]["upper"], 2.0);
  EXPECT_EQ(toy["bytes"].get<std::uintmax_t>(), size("toy.map"));
}

// A problem that names its calibration: the map tells which flight its numbers are from.
TEST_F(CommandLine, ShowsWhereTheNumbersOfAMapAreFrom) {
  write("lag.yaml",
        "polyfly_calibration: 1\nkind: drag\ndata: {file: \"a.bag\", checksum: \"xxh64:1\", recorded: \"\"}\n"
        "parameters:\n  drag_x: {value: 0.5, interval_95: [0.4, 0.6], supported: true}\n");
  write("cart.yaml",
        "polyfly_problem: 1\nname: cart\ntype: tracking_mpc\ncalibration: lag.yaml\nmodel:\n"
        "  states: [{name: v, unit: m/s}]\n  inputs: [{name: u, unit: m/s^2, range: [-1, 1]}]\n"
        "  disturbances: []\n  A: [[-0.1]]\n  B: [[1.0]]\n  C: [[1.0]]\nsampling_time: 0.1\nhorizon: 2\n"
        "weights: {Q: [1.0], R: [0.1], R_delta: [0.0]}\n"
        "parameters:\n  - {name: e_v_x, unit: m/s, role: error, of: v, range: [-1, 1]}\n"
        "  - {name: u_ref, unit: m/s^2, role: input_reference, of: u, range: [-0.5, 0.5]}\n");
  output("solve cart.yaml -o cart.map");
  const std::string shown = output("info cart.map");
  for (const char* word : {"file: \"lag.yaml\", checksum: \"xxh64:", "\"a.bag\"", "model.A[0][0]"})
    EXPECT_TRUE(holds(shown, word));
}

TEST_F(CommandLine, EvaluatesRows) {
  solveToy();
  write("plain.csv", "# a, b\n0.25,0.5\r\n\n 2 , 1.5\n3,0\nnan,0\n");
  std::istringstream lines(output("eval toy.map --csv plain.csv"));
  const auto next = [&lines] {
    std::string line;
    std::getline(lines, line);
    return line;
  };
  const auto nextInput = [&next] {
    const std::string line = next();
    EXPECT_EQ(line.substr(0, 7), "inside,");
    return std::stod(line.substr(line.rfind(',') + 1));
  };
  EXPECT_EQ(next(), "status,region," + info("toy.map")["inputs"][0]["name"].get<std::string>());
  EXPECT_NEAR(nextInput(), 0.75, 1e-12);
  EXPECT_NEAR(nextInput(), 1.0, 1e-12);
  EXPECT_EQ(next(), "outside_box,,");
  EXPECT_EQ(next(), "not_finite,,");

  write("named.csv", "theta_1,theta_0\n3,0\n0.5,0.25\n");
  EXPECT_EQ(output("eval toy.map --csv named.csv -o out.csv"), "");
  EXPECT_TRUE(holds(text("out.csv"), "outside_box"));
}

TEST_F(CommandLine, VerifiesARightMapAndRefusesAWrongOne) {
  solveToy();
  EXPECT_TRUE(
      holds(output("verify toy.map --problem toy.json --samples 500 --seed 2 --json report.json"), "PASSED"));
  EXPECT_TRUE(json("report.json")["passed"].get<bool>());
  output("verify toy.map --samples 100");  // against the problem that the map carries
  writeToy("other.json", R"({"b": [0.9, 1]})");
  EXPECT_TRUE(holds(output("verify toy.map --problem other.json --samples 500", 1), "FAILED"));
  writeToy("other.json", R"({"b": [0.9, 1], "ub": [2, 3]})");
  expectRefused("verify toy.map --problem other.json", {"ranges of map and problem differ"});
}

TEST_F(CommandLine, SaysThatAFileMayNotGrow) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 512;  // bytes; the map takes more
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::size_t files = fileCount();
  EXPECT_TRUE(holds(complaint("solve toy.json -o toy.map --quiet", 2), "toy.map: cannot be written"));
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(fileCount(), files) << "a file was left behind";
}

TEST_F(CommandLine, ReducesAMapAndProvesIt) {
  // Two rows with the same bound: u = 1 in two regions, whose union is convex.
  writeToy("two.json", R"({"A": [[1], [1], [-1]], "b": [1, 1, 1], "B": [[0.5, 0], [-0.5, 0], [0, 0]]})");
  output("solve two.json -o two.map");
  EXPECT_TRUE(
      holds(output("reduce two.map -o small.map --stats saved.json --threads 2 --certificate small.cert"),
            "proven to answer as the original"));
  const nlohmann::json saved = json("saved.json");
  EXPECT_TRUE(saved["proven"].get<bool>());
  EXPECT_LE(saved["after"]["regions"], saved["before"]["regions"]);
  EXPECT_EQ(saved["after"]["bytes"].get<std::uintmax_t>(), size("small.map"));
  const nlohmann::json before = info("two.map");
  EXPECT_EQ(info("small.map")["reduced_from"], before["checksum"]);
  EXPECT_EQ(before["reduced_from"], "");

  EXPECT_TRUE(holds(output("verify small.map --reduced-from two.map --json proof.json"), "PROVEN"));
  EXPECT_TRUE(json("proof.json")["proven"].get<bool>());
  output("verify small.map --reduced-from two.map --certificate again.cert");
  EXPECT_EQ(text("again.cert"), text("small.cert"));
  EXPECT_EQ(check("small.cert --map small.map --reduced-from two.map").exit_code, 0);
  EXPECT_EQ(check("small.cert --map two.map --reduced-from two.map").exit_code, 1);
  EXPECT_EQ(check("small.cert --map small.map --reduced-from").exit_code, 2);
  output("verify small.map --samples 300 --quiet");

  solveToy();
  expectRefused("verify small.map --reduced-from toy.map", {"was reduced from the map with"});
  expectRefused("verify two.map --reduced-from two.map", {"was not reduced"});
  expectRefused("verify small.map --exact", {"is a reduced map"});
  expectRefused("reduce small.map -o x.map", {"was reduced before"});
  expectRefused("verify small.map --reduced-from two.map --samples 5", {"--reduced-from"});
  expectRefused("verify two.map --certificate x.cert", {"--certificate"});
}

// min (t + 0.5) z over z >= -1, t in [-2, 2]: without end where t < -0.5.
TEST_F(CommandLine, SaysWhereTheCostIsUnboundedBelow) {
  writeToy("part.json", R"({"H": [[0]], "f": [0.5], "F": [[1, 0]], "A": [[-1]], "b": [1], "B": [[0, 0]]})");
  const Outcome part = run("solve part.json -o part.map --stats stats.json");
  EXPECT_EQ(part.exit_code, 1);
  EXPECT_TRUE(holds(part.err, "the cost is unbounded below at theta = (-"));
  EXPECT_TRUE(holds(part.out, "unbounded, 1 regions"));
  const nlohmann::json stats = json("stats.json");
  EXPECT_EQ(stats["status"], "unbounded");
  EXPECT_LT(stats["unbounded_at"][0].get<double>(), -0.5);
  EXPECT_TRUE(holds(output("info part.map"), "unbounded_at: (-"));
  EXPECT_TRUE(holds(output("verify part.map --problem part.json --samples 200", 1),
                    "the map says that it is unbounded"));
  EXPECT_TRUE(holds(output("verify part.map --problem part.json --exact --certificate part.cert", 1),
                    "proven that the cost is unbounded below at -"));
  EXPECT_FALSE(exists("part.cert"));
}

TEST_F(CommandLine, KeepsAPartialResultAndSaysSo) {
  EXPECT_TRUE(holds(complaint("solve toy.json -o part.map --region-limit 1", 3), "limit reached: kept"));
  EXPECT_TRUE(holds(output("info part.map"), "limited"));
  output("verify part.map --problem toy.json --samples 100", 1);

  // A complete map is worth more than a part of one.
  solveToy();
  const std::string bytes = text("toy.map");
  EXPECT_TRUE(holds(complaint("solve toy.json -o toy.map --region-limit 1", 3), "the existing file stands"));
  EXPECT_EQ(text("toy.map"), bytes);
  output("solve toy.json -o toy.map --region-limit 1 --force", 3);
  EXPECT_NE(text("toy.map"), bytes);
}

// Whether the process has a handler for SIGINT (proc(5), SigCgt).
bool catchesInterrupt(pid_t process) {
  const std::string status = fileText("/proc/" + std::to_string(process) + "/status");
  const std::size_t line = status.find("SigCgt:");
  return line != std::string::npos &&
         (std::stoull(status.substr(line + 7), nullptr, 16) >> (SIGINT - 1) & 1u) != 0;
}

TEST_F(CommandLine, StopsOnASignalAndSaysWhatItCovers) {
  solveToy();
  const pid_t child =
      start({OFFLINE_MPT_PROGRAM, "verify", "toy.map", "--samples", "1000000000", "--threads", "1"});
  while (!catchesInterrupt(child)) {
    ASSERT_EQ(waitpid(child, nullptr, WNOHANG), 0) << "ended by itself";
    sched_yield();
  }
  kill(child, SIGINT);
  const Outcome result = wait(child);
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_TRUE(holds(result.err, "interrupted: the report covers"));
  EXPECT_TRUE(holds(result.out, "stopped before the end"));
}

TEST_F(CommandLine, ReductionsEndAtTheirTimeLimit) {
  solveToy();
  EXPECT_TRUE(holds(complaint("reduce toy.map -o late.map --time-limit 1e-6", 3),
                    "late.map: interrupted: nothing was written"));
  EXPECT_FALSE(exists("late.map"));
}

TEST_F(CommandLine, ToolsTellTheirVersion) {
  EXPECT_EQ(output("--version"), std::string("offline_mpt ") + kVersion + "\n");
  const Outcome checker = check("--version");
  EXPECT_EQ(checker.exit_code, 0);
  EXPECT_EQ(checker.out, std::string("check_certificate ") + kVersion + "\n");
}

TEST_F(CommandLine, HelpsWithExamplesAndExitCodes) {
  const std::string general = output("--help");
  for (const char* word : {"Exit codes", "Examples"}) EXPECT_TRUE(holds(general, word));
  for (const std::string command : {"solve", "info", "eval", "verify", "reduce", "diff", "plot", "explore"}) {
    EXPECT_TRUE(holds(general, command));
    EXPECT_TRUE(holds(output(command + " --help"), "Examples"));
  }
  for (const std::string command : {"set invariant", "analyze"})
    EXPECT_TRUE(holds(output(command + " --help"), "Example"));
}

}  // namespace
}  // namespace polyfly
