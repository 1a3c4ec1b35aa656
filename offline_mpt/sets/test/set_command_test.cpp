// `offline_mpt set` and `offline_mpt analyze` as a user would run them.
#include <cmath>

#include "../../test/run_program.hpp"

namespace polyfly {
namespace {

class SetCommand : public ToolTest {
 protected:
  void SetUp() override {
    write("box.yaml", "polyfly_set: 1\nbox: [[0, 0.1], [-1/3, 2]]\n");
    writeModel("model.yaml", "[-0.5, 0.5]");
    writeModel("wild.yaml", "[-1.5, 1.5]");
    write("scalar.json",
          R"({"name": "scalar", "H": [[2]], "f": [0], "F": [[1]], "A": [[1], [-1]], "b": [1, 1],
      "B": [[0], [0]], "lb": [-5], "ub": [5]})");
  }

  void writeModel(const std::string& name, const std::string& disturbance) const {
    write(name,
          "polyfly_model: 1\nname: scalar\nstates: [{name: theta_0, unit: 1, range: [-5, 5]}]\n"
          "inputs: [{name: u_0, unit: 1, range: [-1, 1]}]\n"
          "disturbances: [{name: d, unit: 1, range: " +
              disturbance + "}]\nA: [[1]]\nB: [[1]]\nE: [[1]]\n");
  }
};

TEST_F(SetCommand, InvariantSetAndItsProof) {
  const auto result = nlohmann::json::parse(output("set invariant model.yaml -o safe.json --json"));
  EXPECT_EQ(result["status"], "maximal");
  EXPECT_EQ(result["proven_invariant"], true);
  EXPECT_EQ(result["set"], json("safe.json"));
  output("set invariant wild.yaml", 1);  // empty
  output("set invariant model.yaml --float");
}

TEST_F(SetCommand, AnalyzeAnswersByExitCodeAndReport) {
  output("solve scalar.json -o scalar.map --quiet");
  EXPECT_TRUE(holds(output("analyze scalar.map --model model.yaml --json report.json"),
                    "recursive feasibility HOLDS"));
  EXPECT_EQ(json("report.json")["holds"], true);
  const std::string bad = output("analyze scalar.map --model wild.yaml --json report.json", 1);
  for (const char* part : {"recursive feasibility FAILS", "successor"}) EXPECT_TRUE(holds(bad, part));
  const nlohmann::json report = json("report.json");
  EXPECT_EQ(report["witness"]["verified"], true);
  EXPECT_GT(std::abs(report["witness"]["successor"][0].get<double>()), 5.0);
  write("inner.yaml", "polyfly_set: 1\nbox: [[-3, 3]]\n");
  output("analyze scalar.map --model model.yaml --within inner.yaml --quiet");
  const Outcome quiet = run("analyze scalar.map --model wild.yaml --quiet");
  EXPECT_EQ(quiet.exit_code, 1);
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(SetCommand, BadInputIsRefusedInOneLine) {
  output("solve scalar.json -o scalar.map --quiet");
  write("other.yaml", "polyfly_model: 1\nname: a\nstates: [{name: x, unit: 1}]\nA: [[1]]\n");
  write("bad.yaml", "polyfly_set: 1\nA: [[1, x]]\nb: [1]\n");
  for (const char* line :
       {"set", "set nothing box.yaml", "set invariant missing.yaml", "set invariant box.yaml",
        "set invariant model.yaml --tolerance 1", "set invariant model.yaml -o missing/out.json",
        "set volume box.yaml", "set minkowski box.yaml box.yaml -o sum.json", "set invariant other.yaml",
        "analyze scalar.map --model model.yaml --within bad.yaml", "analyze scalar.map",
        "analyze scalar.map --model other.yaml", "analyze scalar.map --model box.yaml",
        "analyze scalar.map --model model.yaml --within box.yaml", "analyze scalar.json --model model.yaml",
        "analyze scalar.map --model model.yaml --tolerance -1"})
    expectRefused(line);
}

}  // namespace
}  // namespace polyfly
