// `offline_mpt export` and `check_certificate --export` as a user calls them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "project_root.hpp"
#include "run_program.hpp"

namespace polyfly {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

// min z^2/2 - (a + b) z, |z| <= 1: three regions
const char* const kClip = R"({"name": "clip", "H": [[1.0]], "f": [0.0], "F": [[-1.0, -1.0]],
    "A": [[1.0], [-1.0]], "b": [1.0, 1.0], "B": [[0.0, 0.0], [0.0, 0.0]], "eq_ids": [],
    "lb": [-2.0, -2.0], "ub": [2.0, 2.0], "A_theta": [], "b_theta": [], "out": [0]})";

// A level behind a lagging valve, with a soft limit.
const char* const kTank = R"(polyfly_problem: 1
name: tank
type: tracking_mpc
model:
  states: [{name: h, unit: m}, {name: q, unit: m^3/s}]
  inputs: [{name: v, unit: V, range: [-1.3, 0.9]}]
  A: [[-0.21, 0.77], [0, -1.9]]
  B: [[0], [1.7]]
  C: [[1, 0]]
sampling_time: 0.35
horizon: 8
moves: [1, 2, 5]
weights: {Q: [7.3, 0.9], R: [0.6], R_delta: [0.11], terminal: riccati}
constraints:
  - {of: h, range: [-1.1, 0.8], soft: {linear: 60, quadratic: 5, slack: horizon}}
parameters:
  - {name: h_ref, role: state_reference, of: h, unit: m, range: [-0.7, 0.7]}
  - {name: e_h, role: error, of: h, unit: m, range: [-1.7, 1.4]}
  - {name: e_q, role: error, of: q, unit: m^3/s, range: [-1.2, 1.1]}
  - {name: v_prev, role: previous_input, of: v, unit: V, range: [-1.3, 0.9]}
  - {name: v_ref, role: input_reference, of: v, unit: V, range: [-0.5, 0.4]}
)";

class ExportCommand : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(work_);
    writeBytes(path("clip.json"), kClip);
    ASSERT_EQ(run({OFFLINE_MPT_PROGRAM, "solve", path("clip.json"), "-o", map_}).exit_code, 0);
  }

  std::string path(const std::string& name) const { return work_ + "/" + name; }

  Outcome run(Words words) const {
    return waitForProgram(startProgram(std::move(words), folder_.path(".")), folder_.path("."));
  }

  Outcome exportMap(Words options) const {
    options.insert(options.begin(), {OFFLINE_MPT_PROGRAM, "export", map_, "-o", path("code")});
    return run(options);
  }

  Outcome confirm() const { return run({CHECK_CERTIFICATE, "--export", path("code"), "--map", map_}); }

  ScratchFolder folder_;
  const std::string work_ = folder_.path("work");
  const std::string map_ = path("clip.map");
};

TEST_F(ExportCommand, WritesFourFilesThatAreConfirmed) {
  for (const char* const type : {"double", "float", "int16"}) {
    const Outcome result = exportMap({"--name", "clip", "--type", type});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    for (const char* const name : {"clip.c", "clip.h", "clip_test.c", "clip.json"})
      EXPECT_TRUE(fs::is_regular_file(path("code") + "/" + name)) << name;
    EXPECT_NE(readBytes(path("code/clip.json")).find(std::string("\"type\": \"") + type), std::string::npos);
    const bool differs = std::string(type) != "double";
    EXPECT_EQ(result.out.find(": off the map's by at most ") != std::string::npos, differs) << result.out;
    const Outcome confirmed = confirm();
    EXPECT_EQ(confirmed.exit_code, 0) << confirmed.err;
    EXPECT_NE(confirmed.out.find("confirmed: the code of 3 regions"), std::string::npos) << confirmed.out;
  }
}

TEST_F(ExportCommand, TheSameMapGivesTheSameBytes) {
  ASSERT_EQ(exportMap({"--name", "clip", "--type", "float"}).exit_code, 0);
  const std::string code = readBytes(path("code/clip.c")), facts = readBytes(path("code/clip.json"));
  ASSERT_EQ(exportMap({"--name", "clip", "--type", "float"}).exit_code, 0);
  EXPECT_EQ(readBytes(path("code/clip.c")), code);
  EXPECT_EQ(readBytes(path("code/clip.json")), facts);
}

TEST_F(ExportCommand, OnlineWritesASolverOfAMapOrAProblem) {
  for (const std::string& source : {map_, path("clip.json")}) {
    const Outcome result = run({OFFLINE_MPT_PROGRAM, "export", source, "-o", path("online"), "--name", "clip",
                                "--online", "--iteration-limit", "7"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("0 at the iteration limit"), std::string::npos) << result.out;
    for (const char* const name : {"clip.c", "clip.h", "clip_test.c"})
      EXPECT_TRUE(fs::is_regular_file(path("online") + "/" + name)) << name;
    const std::string facts = readBytes(path("online/clip.json"));
    EXPECT_NE(facts.find("\"iterations\": 7"), std::string::npos) << facts;
    // One of the two bounds is active at most.
    EXPECT_NE(facts.find("\"iterations\": 1,"), std::string::npos) << facts;
  }
  EXPECT_EQ(exportMap({"--name", "clip", "--online", "--flash-limit", "1k"}).exit_code, 2);
  EXPECT_EQ(exportMap({"--name", "clip", "--iteration-limit", "7"}).exit_code, 2);
  EXPECT_EQ(exportMap({"--name", "clip", "--online", "--iteration-limit", "0"}).exit_code, 2);
}

TEST_F(ExportCommand, TheTypeFollowsTheLimitOfFlash) {
  const auto bytes = [&](const char* type) {
    EXPECT_EQ(exportMap({"--name", "clip", "--type", type}).exit_code, 0);
    const std::string facts = readBytes(path("code/clip.json"));
    return std::stoi(facts.substr(facts.find("\"flash_bytes\": ") + 15));
  };
  const int in_double = bytes("double"), in_float = bytes("float"), in_int16 = bytes("int16");
  ASSERT_LT(in_float, in_double);
  ASSERT_LT(in_int16, in_float);
  const auto typeWithin = [&](int limit) -> std::string {
    const Outcome result = exportMap({"--name", "clip", "--flash-limit", std::to_string(limit)});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const std::string facts = readBytes(path("code/clip.json"));
    const std::size_t first = facts.find("\"type\": \"") + 9;
    return facts.substr(first, facts.find('"', first) - first);
  };
  EXPECT_EQ(typeWithin(in_double), "double");
  EXPECT_EQ(typeWithin(in_double - 1), "float");
  EXPECT_EQ(typeWithin(in_float), "float");
  EXPECT_EQ(typeWithin(in_int16), "int16");
  EXPECT_EQ(confirm().exit_code, 0);
  // No map in no type is smaller than this.
  const Outcome refused = exportMap({"--name", "clip", "--flash-limit", "60"});
  EXPECT_EQ(refused.exit_code, 2);
  for (const std::string& need : {std::to_string(in_double) + " bytes as the map in double",
                                  std::to_string(in_float) + " bytes as the map in float",
                                  std::to_string(in_int16) + " bytes as the map in int16"})
    EXPECT_NE(refused.err.find(need), std::string::npos) << refused.err;
  EXPECT_EQ(exportMap({"--name", "clip", "--type", "double", "--flash-limit", "60"}).exit_code, 2);
}

// The tank's bound is 12 % of the input's range, and below 1 % once reduced. No code of the filter is within what its proof
// allows, and the reduced map has the least error, but not the least size.
TEST_F(ExportCommand, TheLimitOfFlashPassesGreatErrorsOver) {
  writeBytes(path("tank.yaml"), kTank);
  const std::string filter = projectRoot() + "/region_maps/problems/safety/double_integrator_float.yaml";
  for (const std::string& problem : {path("tank.yaml"), filter}) {
    const std::string map = path("other.map");
    ASSERT_EQ(run({OFFLINE_MPT_PROGRAM, "solve", problem, "-o", map, "--force"}).exit_code, 0);
    const Words words = {
        OFFLINE_MPT_PROGRAM, "export", map, "-o", path("code"), "--name", "code", "--type", "int16"};
    const Outcome given = run(words);
    EXPECT_NE(given.out.find("the map in int16"), std::string::npos) << given.out;
    Words limited = words;
    limited.insert(limited.end(), {"--flash-limit", "5k"});
    const Outcome chosen = run(limited);
    EXPECT_EQ(chosen.exit_code, 0) << chosen.err;
    EXPECT_NE(chosen.out.find("the reduced map in int16"), std::string::npos) << chosen.out;
  }
}

TEST_F(ExportCommand, BadOptionsEndInOneLineAndWriteNothing) {
  for (const Words& options : std::vector<Words>{
           {"--name", "1clip"}, {"--name", "../clip"}, {"--name", "clip", "--type", "half"}, {}}) {
    const Outcome result = exportMap(options);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(path("code")));
  }
}

TEST_F(ExportCommand, AnAlteredFolderIsRefused) {
  ASSERT_EQ(exportMap({"--name", "clip", "--type", "float"}).exit_code, 0);
  std::string code = readBytes(path("code/clip.c"));
  const std::size_t law = code.find("{1.0f, 1.0f,");
  ASSERT_NE(law, std::string::npos) << code;
  writeBytes(path("code/clip.c"), code.replace(law + 1, 4, "1.1f"));
  Outcome result = confirm();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("refused: the error of input 0 may exceed its bound"), std::string::npos)
      << result.err;
  // Cut off, empty, and none.
  writeBytes(path("code/clip.c"), code.substr(0, code.size() / 3));
  EXPECT_EQ(confirm().exit_code, 1);
  writeBytes(path("code/other.json"), "{}");
  result = confirm();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("more than one file *.json"), std::string::npos) << result.err;
  fs::remove_all(path("code"));
  EXPECT_EQ(confirm().exit_code, 2);
}

TEST_F(ExportCommand, OptionsThatExcludeOneAnotherAreRefused) {
  for (const Words& words :
       std::vector<Words>{{CHECK_CERTIFICATE, "--export", path("code")},
                          {CHECK_CERTIFICATE, "--export", path("code"), "--map", map_, map_},
                          {CHECK_CERTIFICATE, "--export", path("code"), "--map", map_, "--problem", map_}}) {
    EXPECT_EQ(run(words).exit_code, 2);
  }
}

}  // namespace
}  // namespace polyfly
