// Runs the program `offline_mpt` as a user would: what it prints, what it returns, what it leaves behind.
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "polyfly_base/version.hpp"
#include "run_program.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;

class CommandLine : public testing::Test {
 protected:
  void SetUp() override { writeBytes(path("toy.json"), kToy); }

  std::string path(const std::string& name) const { return folder_.path(name); }

  Outcome run(const std::vector<std::string>& arguments) const { return wait(start(arguments)); }
  pid_t start(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), OFFLINE_MPT_PROGRAM);
    return startProgram(std::move(arguments), path("."));
  }
  Outcome wait(pid_t child) const { return waitForProgram(child, path(".")); }

  /// The exit code of check_certificate.
  int check(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), CHECK_CERTIFICATE);
    return wait(startProgram(std::move(arguments), path("."))).exit_code;
  }

  std::string solvedToy() const {
    const Outcome result = run({"solve", path("toy.json"), "-o", path("toy.map")});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return path("toy.map");
  }

  // The run fails with one line on standard error that holds all the words, and leaves no file but the given
  // ones.
  void expectRefused(const std::vector<std::string>& arguments, const std::vector<std::string>& words) const {
    const std::size_t before = fileCount();
    const Outcome result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.out << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.err.rfind("offline_mpt: ", 0), 0u) << result.err;
    for (const std::string& word : words)
      EXPECT_NE(result.err.find(word), std::string::npos) << word << " in: " << result.err;
    EXPECT_EQ(fileCount(), before) << "a file was left behind";
  }

  // Files besides the captured output.
  std::size_t fileCount() const {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(path("."))) {
      count += entry.path().filename() != "stdout" && entry.path().filename() != "stderr";
    }
    return count;
  }

  nlohmann::json toy() const { return nlohmann::json::parse(kToy); }
  std::string written(const std::string& name, const nlohmann::json& json) const {
    writeBytes(path(name), json.dump());
    return path(name);
  }

  // min z^2/2 - (a + b) z, |z| <= 1: three regions
  static constexpr const char* kToy = R"({"name": "toy", "H": [[1.0]], "f": [0.0], "F": [[-1.0, -1.0]],
    "A": [[1.0], [-1.0]], "b": [1.0, 1.0], "B": [[0.0, 0.0], [0.0, 0.0]], "eq_ids": [],
    "lb": [-2.0, -2.0], "ub": [2.0, 2.0], "A_theta": [], "b_theta": [], "out": [0]})";

  ScratchFolder folder_;
};

TEST_F(CommandLine, SolvesAndWritesStatistics) {
  const Outcome result =
      run({"solve", path("toy.json"), "-o", path("toy.map"), "--stats", path("stats.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("complete, 3 regions"), std::string::npos) << result.out;
  EXPECT_EQ(result.err, "");
  const nlohmann::json stats = nlohmann::json::parse(readBytes(path("stats.json")));
  EXPECT_EQ(stats["status"], "complete");
  EXPECT_EQ(stats["regions"], 3);
  EXPECT_EQ(stats["parameters"], 2);
  EXPECT_EQ(stats["bytes"].get<std::uintmax_t>(), fs::file_size(path("toy.map")));
}

TEST_F(CommandLine, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const char* threads : {"1", "2", "5"}) {
    const Outcome result =
        run({"solve", path("toy.json"), "-o", path(threads), "--threads", threads, "--quiet"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out + result.err, "");
    EXPECT_EQ(readBytes(path(threads)), readBytes(path("1")));
  }
}

TEST_F(CommandLine, ShowsWhatAMapHolds) {
  const std::string map = solvedToy();
  const Outcome text = run({"info", map});
  EXPECT_EQ(text.exit_code, 0);
  for (const char* word : {"complete", "-2 .. 2", "regions     3", "worst case", "period      none"}) {
    EXPECT_NE(text.out.find(word), std::string::npos) << word << " in: " << text.out;
  }
  const Outcome json = run({"info", map, "--json"});
  const nlohmann::json info = nlohmann::json::parse(json.out);
  EXPECT_EQ(info["regions"], 3);
  EXPECT_EQ(info["parameters"].size(), 2u);
  EXPECT_EQ(info["parameters"][0]["upper"], 2.0);
  EXPECT_EQ(info["bytes"].get<std::uintmax_t>(), fs::file_size(map));
}

// A problem that names its calibration: the map tells which flight its numbers are from.
TEST_F(CommandLine, ShowsWhereTheNumbersOfAMapAreFrom) {
  writeBytes(
      path("lag.yaml"),
      "polyfly_calibration: 1\nkind: drag\ndata: {file: \"a.bag\", checksum: \"xxh64:1\", recorded: \"\"}\n"
      "parameters:\n  drag_x: {value: 0.5, interval_95: [0.4, 0.6], supported: true}\n");
  writeBytes(path("cart.yaml"),
             "polyfly_problem: 1\nname: cart\ntype: tracking_mpc\ncalibration: lag.yaml\nmodel:\n"
             "  states: [{name: v, unit: m/s}]\n  inputs: [{name: u, unit: m/s^2, range: [-1, 1]}]\n"
             "  disturbances: []\n  A: [[-0.1]]\n  B: [[1.0]]\n  C: [[1.0]]\nsampling_time: 0.1\nhorizon: 2\n"
             "weights: {Q: [1.0], R: [0.1], R_delta: [0.0]}\n"
             "parameters:\n  - {name: e_v_x, unit: m/s, role: error, of: v, range: [-1, 1]}\n"
             "  - {name: u_ref, unit: m/s^2, role: input_reference, of: u, range: [-0.5, 0.5]}\n");
  const Outcome solved = run({"solve", path("cart.yaml"), "-o", path("cart.map")});
  ASSERT_EQ(solved.exit_code, 0) << solved.err;
  const std::string text = run({"info", path("cart.map")}).out;
  EXPECT_NE(text.find("file: \"lag.yaml\", checksum: \"xxh64:"), std::string::npos) << text;
  EXPECT_NE(text.find("\"a.bag\""), std::string::npos) << text;
  EXPECT_NE(text.find("model.A[0][0]"), std::string::npos) << text;
}

TEST_F(CommandLine, EvaluatesRows) {
  const std::string map = solvedToy();
  const nlohmann::json info = nlohmann::json::parse(run({"info", map, "--json"}).out);
  const std::string a = info["parameters"][0]["name"], b = info["parameters"][1]["name"];
  writeBytes(path("plain.csv"), "# a, b\n0.25,0.5\r\n\n 2 , 1.5\n3,0\nnan,0\n");
  const Outcome plain = run({"eval", map, "--csv", path("plain.csv")});
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  std::istringstream lines(plain.out);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "status,region," + info["inputs"][0]["name"].get<std::string>());
  std::getline(lines, line);
  EXPECT_EQ(line.substr(0, 7), "inside,");
  EXPECT_NEAR(std::stod(line.substr(line.rfind(',') + 1)), 0.75, 1e-12);
  std::getline(lines, line);
  EXPECT_NEAR(std::stod(line.substr(line.rfind(',') + 1)), 1.0, 1e-12);
  std::getline(lines, line);
  EXPECT_EQ(line, "outside_box,,");
  std::getline(lines, line);
  EXPECT_EQ(line, "not_finite,,");

  writeBytes(path("named.csv"), b + "," + a + "\n3,0\n0.5,0.25\n");
  const Outcome named = run({"eval", map, "--csv", path("named.csv"), "-o", path("out.csv")});
  ASSERT_EQ(named.exit_code, 0) << named.err;
  EXPECT_EQ(named.out, "");
  EXPECT_NE(readBytes(path("out.csv")).find("outside_box"), std::string::npos);
}

TEST_F(CommandLine, NamesTheCellThatIsWrong) {
  const std::string map = solvedToy();
  const std::string name = nlohmann::json::parse(run({"info", map, "--json"}).out)["parameters"][1]["name"];
  const std::string csv = path("bad.csv");
  writeBytes(csv, "0,0\n0,1.5x\n");
  expectRefused({"eval", map, "--csv", csv, "-o", path("out.csv")},
                {"bad.csv:2:", "column 2", name, "'1.5x' is not a number"});
  writeBytes(csv, "0,0\n\n0,0,0\n");
  expectRefused({"eval", map, "--csv", csv}, {"bad.csv:3:", "must have 2 columns, got 3"});
  writeBytes(csv, name + ",wind\n0,0\n");
  expectRefused({"eval", map, "--csv", csv}, {"bad.csv:1:", "column 2", "'wind' is not a parameter"});
  writeBytes(csv, name + "," + name + "\n0,0\n");
  expectRefused({"eval", map, "--csv", csv}, {"bad.csv:1:", "is given twice"});
  writeBytes(csv, name + "\n0\n");
  expectRefused({"eval", map, "--csv", csv}, {"bad.csv:1:", "no column for the parameter"});
  expectRefused({"eval", map, "--csv", path("none.csv")}, {"none.csv: cannot be read"});
}

TEST_F(CommandLine, VerifiesARightMapAndRefusesAWrongOne) {
  const std::string map = solvedToy();
  const Outcome right = run({"verify", map, "--problem", path("toy.json"), "--samples", "500", "--seed", "2",
                             "--json", path("report.json")});
  EXPECT_EQ(right.exit_code, 0) << right.out << right.err;
  EXPECT_NE(right.out.find("PASSED"), std::string::npos);
  EXPECT_TRUE(nlohmann::json::parse(readBytes(path("report.json")))["passed"].get<bool>());
  EXPECT_EQ(run({"verify", map, "--samples", "100"}).exit_code, 0)
      << "against the problem that the map carries";

  nlohmann::json other = toy();
  other["b"] = {0.9, 1.0};
  const Outcome wrong = run({"verify", map, "--problem", written("other.json", other), "--samples", "500"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_NE(wrong.out.find("FAILED"), std::string::npos);

  other["ub"] = {2.0, 3.0};
  expectRefused({"verify", map, "--problem", written("other.json", other)},
                {"ranges of map and problem differ"});
}

// What a command reads is not written over.
TEST_F(CommandLine, KeepsItsInputs) {
  const std::string problem = path("toy.json"), map = solvedToy();
  const std::string text = readBytes(problem), bytes = readBytes(map);
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"solve", problem, "-o", problem},
           {"solve", problem, "-o", path("other.map"), "--stats", path("./toy.json")},
           {"solve", problem, "-o", path("other.map"), "--stats", path("other.map")},
           {"reduce", map, "-o", map},
           {"verify", map, "--problem", problem, "--json", problem},
           {"verify", map, "--exact", "--certificate", map},
           {"explore", map, "-o", map},
           {"plot", map, "--slice", "theta_0,theta_1", "-o", map}}) {
    expectRefused(arguments, {"name of its own"});
  }
  EXPECT_EQ(readBytes(problem), text);
  EXPECT_EQ(readBytes(map), bytes);
}

TEST_F(CommandLine, SaysThatAFileMayNotGrow) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 512;  // bytes; the map takes more
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::size_t files = fileCount();
  const Outcome result = run({"solve", path("toy.json"), "-o", path("toy.map"), "--quiet"});
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_NE(result.err.find("toy.map"), std::string::npos) << result.err;
  EXPECT_EQ(fileCount(), files) << "a file was left behind";
}

TEST_F(CommandLine, ReducesAMapAndProvesIt) {
  // Two rows with the same bound: u = 1 in two regions, whose union is convex.
  nlohmann::json problem = toy();
  problem["A"] = {{1.0}, {1.0}, {-1.0}};
  problem["b"] = {1.0, 1.0, 1.0};
  problem["B"] = {{0.5, 0.0}, {-0.5, 0.0}, {0.0, 0.0}};
  ASSERT_EQ(run({"solve", written("two.json", problem), "-o", path("two.map")}).exit_code, 0);
  const Outcome small = run({"reduce", path("two.map"), "-o", path("small.map"), "--stats",
                             path("saved.json"), "--threads", "2", "--certificate", path("small.cert")});
  ASSERT_EQ(small.exit_code, 0) << small.out << small.err;
  EXPECT_NE(small.out.find("proven to answer as the original"), std::string::npos) << small.out;
  const nlohmann::json saved = nlohmann::json::parse(readBytes(path("saved.json")));
  EXPECT_TRUE(saved["proven"].get<bool>());
  EXPECT_LE(saved["after"]["regions"], saved["before"]["regions"]);
  EXPECT_EQ(saved["after"]["bytes"].get<std::uintmax_t>(), fs::file_size(path("small.map")));

  const nlohmann::json before = nlohmann::json::parse(run({"info", path("two.map"), "--json"}).out);
  const nlohmann::json after = nlohmann::json::parse(run({"info", path("small.map"), "--json"}).out);
  EXPECT_EQ(after["reduced_from"], before["checksum"]);
  EXPECT_EQ(before["reduced_from"], "");

  const Outcome proof =
      run({"verify", path("small.map"), "--reduced-from", path("two.map"), "--json", path("proof.json")});
  EXPECT_EQ(proof.exit_code, 0) << proof.out << proof.err;
  EXPECT_NE(proof.out.find("PROVEN"), std::string::npos);
  EXPECT_TRUE(nlohmann::json::parse(readBytes(path("proof.json")))["proven"].get<bool>());
  run({"verify", path("small.map"), "--reduced-from", path("two.map"), "--certificate", path("again.cert")});
  EXPECT_EQ(readBytes(path("again.cert")), readBytes(path("small.cert")));
  EXPECT_EQ(check({path("small.cert"), "--map", path("small.map"), "--reduced-from", path("two.map")}), 0);
  EXPECT_EQ(check({path("small.cert"), "--map", path("two.map"), "--reduced-from", path("two.map")}), 1);
  EXPECT_EQ(check({path("small.cert"), "--map", path("small.map"), "--reduced-from"}), 2);
  EXPECT_EQ(run({"verify", path("small.map"), "--samples", "300", "--quiet"}).exit_code, 0);

  expectRefused({"verify", path("small.map"), "--reduced-from", solvedToy()},
                {"was reduced from the map with"});
  expectRefused({"verify", path("two.map"), "--reduced-from", path("two.map")}, {"was not reduced"});
  expectRefused({"verify", path("small.map"), "--exact"}, {"is a reduced map"});
  expectRefused({"reduce", path("small.map"), "-o", path("x.map")}, {"was reduced before"});
  // Removed options say what to use.
  expectRefused({"reduce", path("two.map"), "-o", path("x.map"), "--merge", "greedy"},
                {"--merge: was removed; ", "joined in pairs"});
  expectRefused({"reduce", path("two.map"), "--separate", "-o", path("x.map")},
                {"--separate: was removed; ", "small"});
  EXPECT_FALSE(fs::exists(path("x.map")));
  expectRefused({"verify", path("small.map"), "--reduced-from", path("two.map"), "--samples", "5"},
                {"--reduced-from"});
  expectRefused({"verify", path("two.map"), "--certificate", path("x.cert")}, {"--certificate"});
}

TEST_F(CommandLine, RefusesBadProblems) {
  const std::string map = path("none.map");
  expectRefused({"solve", path("missing.yaml"), "-o", map}, {"missing.yaml"});
  expectRefused({"solve", path("missing.json"), "-o", map}, {"missing.json"});
  writeBytes(path("problem.txt"), "x");
  expectRefused({"solve", path("problem.txt"), "-o", map}, {"problem.txt"});
  writeBytes(path("malformed.yaml"), "name: x\nstates: [a, b\nhorizon: }\n");
  expectRefused({"solve", path("malformed.yaml"), "-o", map}, {"malformed.yaml:"});
  writeBytes(path("malformed.json"), "{\"H\": [[1.0]");
  expectRefused({"solve", path("malformed.json"), "-o", map}, {"malformed.json"});

  nlohmann::json problem = toy();
  problem["F"] = {{-1.0, -1.0, 0.0}};
  expectRefused({"solve", written("sizes.json", problem), "-o", map}, {"sizes.json", "F"});
  problem = toy();
  problem["ub"][1] = nullptr;
  expectRefused({"solve", written("unbounded.json", problem), "-o", map}, {"unbounded.json", "ub"});
  problem = toy();
  problem["b"] = {-1.0, -1.0};
  expectRefused({"solve", written("infeasible.json", problem), "-o", map}, {"infeasible.json", "infeasible"});
  problem = toy();
  problem["H"] = {{-1.0}};
  expectRefused({"solve", written("concave.json", problem), "-o", map}, {"concave.json: ", "H: must be"});
  problem["H"] = {{1.0, 1.0}, {1.0, 1.0}};
  problem["f"] = {0.0, 0.0};
  problem["F"] = {{1.0, 0.0}, {0.0, 1.0}};
  problem["A"] = {{1.0, 0.0}, {-1.0, 0.0}};
  expectRefused({"solve", written("singular.json", problem), "-o", map},
                {"singular.json: ", "H: is singular, and not zero"});
  // A removed command says what to use.
  expectRefused({"count", path("concave.json"), "--map-limit", "24G"},
                {"count: was removed; ", "--region-limit"});
  expectRefused({"bounds", path("concave.json"), "flight.csv"},
                {"bounds: was removed; ", "disturbance_ranges"});
  problem = toy();
  problem["A"] = {{1.0}, {-1.0}, {1.0}, {1.0}};
  problem["b"] = {1.0, 1.0, 0.0, 1e-9};
  problem["B"] = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
  problem["eq_ids"] = {2, 3};
  expectRefused({"solve", written("equalities.json", problem), "-o", map},
                {"equalities.json: eq_ids: row 3 depends on other equalities"});
}

// min (t + 0.5) z over z >= -1, t in [-2, 2]: without end where t < -0.5.
TEST_F(CommandLine, SaysWhereTheCostIsUnboundedBelow) {
  nlohmann::json problem = toy();
  problem.update(nlohmann::json::parse(
      R"({"H": [[0]], "f": [0.5], "F": [[1, 0]], "A": [[-1]], "b": [1], "B": [[0, 0]]})"));
  const std::string map = path("part.map"), file = written("part.json", problem);
  const Outcome part = run({"solve", file, "-o", map, "--stats", path("stats.json")});
  EXPECT_EQ(part.exit_code, 1);
  EXPECT_NE(part.err.find("the cost is unbounded below at theta = (-"), std::string::npos) << part.err;
  EXPECT_NE(part.out.find("unbounded, 1 regions"), std::string::npos) << part.out;
  const nlohmann::json stats = nlohmann::json::parse(readBytes(path("stats.json")));
  EXPECT_EQ(stats["status"], "unbounded");
  EXPECT_LT(stats["unbounded_at"][0].get<double>(), -0.5);
  EXPECT_NE(run({"info", map}).out.find("unbounded_at: (-"), std::string::npos);

  const Outcome sampled = run({"verify", map, "--problem", file, "--samples", "200"});
  EXPECT_EQ(sampled.exit_code, 1);
  EXPECT_NE(sampled.out.find("the map says that it is unbounded"), std::string::npos) << sampled.out;
  const Outcome exact =
      run({"verify", map, "--problem", file, "--exact", "--certificate", path("part.certificate")});
  EXPECT_EQ(exact.exit_code, 1);
  EXPECT_NE(exact.out.find("proven that the cost is unbounded below at -"), std::string::npos) << exact.out;
  EXPECT_FALSE(fs::exists(path("part.certificate")));

  problem["f"] = {-3.0};
  expectRefused({"solve", written("whole.json", problem), "-o", path("whole.map")},
                {"whole.json", "the cost is unbounded below at theta = "});
}

TEST_F(CommandLine, RefusesDamagedMaps) {
  const std::string bytes = readBytes(solvedToy());
  const std::string map = path("damaged.map");
  const auto refuse = [&](const std::string& damaged, const std::vector<std::string>& words) {
    writeBytes(map, damaged);
    expectRefused({"info", map}, words);
    expectRefused({"verify", map, "--problem", path("toy.json")}, words);
  };
  refuse(bytes.substr(0, bytes.size() - 100), {"damaged.map"});
  refuse(bytes.substr(0, 20), {"damaged.map"});
  refuse("", {"damaged.map"});
  refuse(std::string(4096, 'x'), {"damaged.map"});
  for (const std::size_t position : {std::size_t{3}, bytes.size() / 3, bytes.size() / 2, bytes.size() - 1}) {
    std::string flipped = bytes;
    flipped[position] = static_cast<char>(flipped[position] ^ 0x10);
    refuse(flipped, {"damaged.map"});
  }
  fs::remove(map);
  expectRefused({"info", map}, {"damaged.map"});
  expectRefused({"plot", map, "--slice", "a,b", "-o", path("x.svg")}, {"damaged.map"});
  expectRefused({"explore", map, "-o", path("x.html")}, {"damaged.map"});
}

TEST_F(CommandLine, RefusesBadOptions) {
  const std::string map = solvedToy();
  expectRefused({"solve", path("toy.json")}, {"--output"});
  expectRefused({"solve", path("toy.json"), "-o", path("x.map"), "--threads", "0"}, {"--threads"});
  expectRefused({"solve", path("toy.json"), "-o", path("x.map"), "--wings", "2"}, {"--wings"});
  expectRefused({"solve", path("toy.json"), "-o", path("no/such/folder.map")}, {"no/such"});
  expectRefused({"solve", path("toy.json"), "-o", path(".")}, {"is a folder"});
  expectRefused({"land"}, {"land"});
  expectRefused({}, {"subcommand"});
  expectRefused({"verify", map, "--samples", "0"}, {"--samples"});
  expectRefused({"plot", map, "--slice", "theta", "-o", path("x.svg")}, {"--slice", "'theta'"});
  expectRefused({"plot", map, "--slice", "no,such", "-o", path("x.svg")}, {"no"});
  expectRefused({"plot", map, "--slice", "a,b", "--at", "c", "-o", path("x.svg")}, {"--at", "'c'"});
}

TEST_F(CommandLine, KeepsAPartialResultAndSaysSo) {
  const Outcome limited = run({"solve", path("toy.json"), "-o", path("part.map"), "--region-limit", "1"});
  EXPECT_EQ(limited.exit_code, 3) << limited.err;
  EXPECT_NE(limited.err.find("limit reached: kept"), std::string::npos) << limited.err;
  EXPECT_NE(run({"info", path("part.map")}).out.find("limited"), std::string::npos);
  EXPECT_EQ(run({"verify", path("part.map"), "--problem", path("toy.json"), "--samples", "100"}).exit_code,
            1);

  // A complete map is worth more than a part of one.
  const std::string complete = solvedToy(), bytes = readBytes(complete);
  const Outcome again = run({"solve", path("toy.json"), "-o", complete, "--region-limit", "1"});
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_NE(again.err.find("the existing file stands"), std::string::npos) << again.err;
  EXPECT_EQ(readBytes(complete), bytes);
  EXPECT_EQ(run({"solve", path("toy.json"), "-o", complete, "--region-limit", "1", "--force"}).exit_code, 3);
  EXPECT_NE(readBytes(complete), bytes);
}

// Whether the process has a handler for SIGINT (proc(5), SigCgt).
bool catchesInterrupt(pid_t process) {
  const std::string status = readBytes("/proc/" + std::to_string(process) + "/status");
  const std::size_t line = status.find("SigCgt:");
  return line != std::string::npos &&
         (std::stoull(status.substr(line + 7), nullptr, 16) >> (SIGINT - 1) & 1u) != 0;
}

TEST_F(CommandLine, StopsOnASignalAndSaysWhatItCovers) {
  const std::string map = solvedToy();
  const pid_t child = start({"verify", map, "--samples", "1000000000", "--threads", "1"});
  while (!catchesInterrupt(child)) {
    ASSERT_EQ(waitpid(child, nullptr, WNOHANG), 0) << "ended by itself";
    sched_yield();
  }
  kill(child, SIGINT);
  const Outcome result = wait(child);
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_NE(result.err.find("interrupted: the report covers"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("stopped before the end"), std::string::npos) << result.out;
}

TEST_F(CommandLine, ReductionsEndAtTheirTimeLimit) {
  const Outcome late = run({"reduce", solvedToy(), "-o", path("late.map"), "--time-limit", "1e-6"});
  EXPECT_EQ(late.exit_code, 3) << late.err;
  EXPECT_NE(late.err.find("late.map: interrupted: nothing was written"), std::string::npos) << late.err;
  EXPECT_FALSE(fs::exists(path("late.map")));
  expectRefused({"reduce", solvedToy(), "-o", path("late.map"), "--time-limit", "-1"}, {"--time-limit"});
}

TEST_F(CommandLine, ToolsTellTheirVersion) {
  EXPECT_EQ(run({"--version"}).out, std::string("offline_mpt ") + kVersion + "\n");
  const Outcome checker = wait(startProgram({CHECK_CERTIFICATE, "--version"}, path(".")));
  EXPECT_EQ(checker.exit_code, 0);
  EXPECT_EQ(checker.out, std::string("check_certificate ") + kVersion + "\n");
}

TEST_F(CommandLine, HelpsWithExamplesAndExitCodes) {
  const Outcome general = run({"--help"});
  EXPECT_EQ(general.exit_code, 0);
  for (const char* word :
       {"Exit codes", "solve", "info", "eval", "verify", "reduce", "diff", "plot", "explore", "Examples"}) {
    EXPECT_NE(general.out.find(word), std::string::npos) << word;
  }
  for (const char* command : {"solve", "info", "eval", "verify", "reduce", "diff", "plot", "explore"}) {
    const Outcome help = run({command, "--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.out.find("Examples"), std::string::npos) << command;
  }
}

}  // namespace
}  // namespace polyfly
