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
    write("triangle.json", R"({"polyfly_set": 1, "vertices": [[0, 0], [1, 0], [0, 1]]})");
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

TEST_F(SetCommand, InfoAndVolume) {
  const nlohmann::json info = json("set info box.yaml");
  EXPECT_EQ(info["volume"]["exact"], "7/30");
  EXPECT_EQ(info["vertices"], 4);
  EXPECT_EQ(info["upper"]["exact"][0], "1/10");
  EXPECT_NEAR(info["ball_radius"].get<double>(), 0.05, 1e-12);
  EXPECT_EQ(json("set volume box.yaml")["volume"]["exact"], "7/30");
  EXPECT_NEAR(std::stod(run("set volume box.yaml --float").out), 7.0 / 30.0, 1e-12);
  EXPECT_EQ(json("set vertices triangle.json")["vertices"].size(), 3u);
}

TEST_F(SetCommand, OperationsWriteSetsThatAreReadBack) {
  EXPECT_EQ(run("set minkowski box.yaml triangle.json -o sum.json").exit_code, 0);
  EXPECT_EQ(run("set pontryagin sum.json triangle.json -o back.json").exit_code, 0);
  EXPECT_EQ(run("set equal back.json box.yaml").out, "yes\n");
  EXPECT_EQ(run("set subset box.yaml sum.json").exit_code, 0);
  const Outcome no = run("set equal sum.json box.yaml");
  EXPECT_EQ(no.exit_code, 1);
  EXPECT_EQ(no.out, "no\n");
  EXPECT_EQ(run("set project triangle.json --keep 2 -o side.json").exit_code, 0);
  EXPECT_EQ(json("set volume side.json")["volume"]["exact"], "1");
  EXPECT_EQ(run("set image box.yaml --matrix '0,1;1,0' -o turned.json").exit_code, 0);
  EXPECT_EQ(run("set preimage turned.json --matrix '0,1;1,0' -o again.json").exit_code, 0);
  EXPECT_EQ(run("set equal again.json box.yaml").exit_code, 0);
  EXPECT_EQ(run("set contains triangle.json --point 1/2,1/2").exit_code, 0);
  EXPECT_EQ(run("set contains triangle.json --point 0.5,0.51").exit_code, 1);
  EXPECT_EQ(json("set support triangle.json --direction 2,1")["value"]["exact"], "2");
}

TEST_F(SetCommand, InvariantSetAndItsProof) {
  const nlohmann::json result = json("set invariant model.yaml -o safe.json");
  EXPECT_EQ(result["status"], "maximal");
  EXPECT_EQ(result["proven_invariant"], true);
  EXPECT_EQ(run("set check model.yaml safe.json").exit_code, 0);
  EXPECT_EQ(run("set check wild.yaml safe.json").exit_code, 1);
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
       {"set", "set nothing box.yaml", "set info missing.yaml", "set info bad.yaml", "set info model.yaml",
        "set intersect box.yaml", "set project box.yaml --keep 3", "set contains box.yaml --point 1",
        "set contains box.yaml --point 1,a", "set image box.yaml --matrix '1,0;1'",
        "set volume box.yaml --tolerance 1", "set minimal box.yaml -o missing/out.json",
        "set invariant other.yaml", "analyze scalar.map", "analyze scalar.map --model other.yaml",
        "analyze scalar.map --model box.yaml", "analyze scalar.map --model model.yaml --within box.yaml",
        "analyze scalar.json --model model.yaml", "analyze scalar.map --model model.yaml --tolerance -1"}) {
    const Outcome result = run(words);
    EXPECT_EQ(result.exit_code, 2) << words << "\n" << result.out << result.err;
    EXPECT_EQ(result.out, "") << words;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << words << "\n" << result.err;
    EXPECT_EQ(result.err.rfind("offline_mpt: ", 0), 0u) << result.err;
  }
}

TEST_F(SetCommand, HelpShowsExamples) {
  for (const char* words : {"set --help", "analyze --help"}) {
    const Outcome result = run(words);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.out.find("Examples:"), std::string::npos);
  }
}

}  // namespace
}  // namespace polyfly
