// `offline_mpt set` and `offline_mpt analyze` as a user would run them.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace polyfly {
namespace {

namespace fs = std::filesystem;

std::string readText(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

struct Outcome {
  int exit_code;
  std::string out;
  std::string err;
};

class SetCommand : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "set_command_test_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    write("box.yaml", "polyfly_set: 1\nbox: [[0, 0.1], [-1/3, 2]]\n");
    write("model.yaml",
          "polyfly_model: 1\nname: scalar\nstates: [{name: theta_0, unit: 1, range: [-5, 5]}]\n"
          "inputs: [{name: u_0, unit: 1, range: [-1, 1]}]\n"
          "disturbances: [{name: d, unit: 1, range: [-0.5, 0.5]}]\nA: [[1]]\nB: [[1]]\nE: [[1]]\n");
    write("wild.yaml",
          "polyfly_model: 1\nname: scalar\nstates: [{name: theta_0, unit: 1, range: [-5, 5]}]\n"
          "inputs: [{name: u_0, unit: 1, range: [-1, 1]}]\n"
          "disturbances: [{name: d, unit: 1, range: [-1.5, 1.5]}]\nA: [[1]]\nB: [[1]]\nE: [[1]]\n");
    write("scalar.json",
          R"({"name": "scalar", "H": [[2]], "f": [0], "F": [[1]], "A": [[1], [-1]], "b": [1, 1],
      "B": [[0], [0]], "lb": [-5], "ub": [5]})");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  // Runs in the folder; words hold no spaces.
  Outcome run(const std::string& words) const {
    const std::string command =
        "cd '" + folder_.string() + "' && '" + OFFLINE_MPT_PROGRAM + "' " + words + " > stdout 2> stderr";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readText(folder_ / "stdout"),
            readText(folder_ / "stderr")};
  }

  nlohmann::json json(const std::string& words) const {
    const Outcome result = run(words + " --json");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out);
  }

  fs::path folder_;
};

TEST_F(SetCommand, InvariantSetAndItsProof) {
  const nlohmann::json result = json("set invariant model.yaml -o safe.json");
  EXPECT_EQ(result["status"], "maximal");
  EXPECT_EQ(result["proven_invariant"], true);
  EXPECT_EQ(result["set"], nlohmann::json::parse(readText(folder_ / "safe.json")));
  EXPECT_EQ(run("set invariant wild.yaml").exit_code, 1);  // empty
  EXPECT_EQ(run("set invariant model.yaml --float").exit_code, 0);
}

TEST_F(SetCommand, AnalyzeAnswersByExitCodeAndReport) {
  ASSERT_EQ(run("solve scalar.json -o scalar.map --quiet").exit_code, 0);
  const Outcome good = run("analyze scalar.map --model model.yaml --json report.json");
  EXPECT_EQ(good.exit_code, 0) << good.out << good.err;
  EXPECT_NE(good.out.find("recursive feasibility HOLDS"), std::string::npos) << good.out;
  EXPECT_EQ(nlohmann::json::parse(readText(folder_ / "report.json"))["holds"], true);
  const Outcome bad = run("analyze scalar.map --model wild.yaml --json report.json");
  EXPECT_EQ(bad.exit_code, 1) << bad.out;
  EXPECT_NE(bad.out.find("recursive feasibility FAILS"), std::string::npos) << bad.out;
  EXPECT_NE(bad.out.find("successor"), std::string::npos);
  const nlohmann::json report = nlohmann::json::parse(readText(folder_ / "report.json"));
  EXPECT_EQ(report["witness"]["verified"], true);
  EXPECT_GT(std::abs(report["witness"]["successor"][0].get<double>()), 5.0);
  write("inner.yaml", "polyfly_set: 1\nbox: [[-3, 3]]\n");
  EXPECT_EQ(run("analyze scalar.map --model model.yaml --within inner.yaml --quiet").exit_code, 0);
  const Outcome quiet = run("analyze scalar.map --model wild.yaml --quiet");
  EXPECT_EQ(quiet.exit_code, 1);
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(SetCommand, BadInputIsRefusedInOneLine) {
  ASSERT_EQ(run("solve scalar.json -o scalar.map --quiet").exit_code, 0);
  write("other.yaml", "polyfly_model: 1\nname: a\nstates: [{name: x, unit: 1}]\nA: [[1]]\n");
  write("bad.yaml", "polyfly_set: 1\nA: [[1, x]]\nb: [1]\n");
  for (const char* words :
       {"set", "set nothing box.yaml", "set invariant missing.yaml", "set invariant box.yaml",
        "set invariant model.yaml --tolerance 1", "set invariant model.yaml -o missing/out.json",
        "set volume box.yaml", "set minkowski box.yaml box.yaml -o sum.json", "set invariant other.yaml",
        "analyze scalar.map --model model.yaml --within bad.yaml", "analyze scalar.map",
        "analyze scalar.map --model other.yaml", "analyze scalar.map --model box.yaml",
        "analyze scalar.map --model model.yaml --within box.yaml", "analyze scalar.json --model model.yaml",
        "analyze scalar.map --model model.yaml --tolerance -1"}) {
    const Outcome result = run(words);
    EXPECT_EQ(result.exit_code, 2) << words << "\n" << result.out << result.err;
    EXPECT_EQ(result.out, "") << words;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << words << "\n" << result.err;
    EXPECT_EQ(result.err.rfind("offline_mpt: ", 0), 0u) << result.err;
  }
}

TEST_F(SetCommand, HelpShowsExamples) {
  for (const char* words : {"set invariant --help", "analyze --help"}) {
    const Outcome result = run(words);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.out.find("Example"), std::string::npos);
  }
}

}  // namespace
}  // namespace polyfly
