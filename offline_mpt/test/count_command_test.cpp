// Runs `offline_mpt count` and `check_count` as a user would.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace polyfly {
namespace {

// z follows theta between two rows: three regions.
const char kToy[] =
    R"({"name": "toy", "H": [[1]], "f": [0], "F": [[-1]], "A": [[1], [-1]], "b": [0.5, 0.25], "B": [[0], [0]],
"eq_ids": [], "lb": [-1], "ub": [1], "A_theta": [], "b_theta": [], "out": [0]})";
constexpr int kToyBytes = 272 + 16 * 2 + 3 * (20 + 4 * 2 + 4) + 4 * 2 + 3 * 16;

class CountCommand : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(path("toy.json")) << kToy; }

  std::string path(const std::string& name) const { return folder_.path(name); }
  Outcome run(std::vector<std::string> words) const {
    return waitForProgram(startProgram(std::move(words), path(".")), path("."));
  }
  Outcome count(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {OFFLINE_MPT_PROGRAM, "count", path("toy.json")});
    return run(std::move(arguments));
  }
  Outcome check(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {CHECK_COUNT, path("toy.count")});
    return run(std::move(arguments));
  }

  ScratchFolder folder_;
};

TEST_F(CountCommand, SaysHowLargeTheMapIsAtLeast) {
  const Outcome result = count({"--stats", path("stats.json")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "toy: complete: 3 regions, all proven, their map takes at least " +
                            std::to_string(kToyBytes) + " bytes\n");
  const auto stats = nlohmann::json::parse(readBytes(path("stats.json")));
  EXPECT_EQ(stats["proven"], 3);
  EXPECT_EQ(stats["laws"], 3);
  EXPECT_EQ(stats["map_bytes"], kToyBytes);
}

TEST_F(CountCommand, WhatDoesNotFitIsSaidAndProven) {
  const Outcome result = count({"--map-limit", "300", "--proof", path("toy.count")});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_NE(result.out.find("does not fit"), std::string::npos) << result.out;
  EXPECT_EQ(check({"--problem", path("toy.json"), "--map-limit", "300"}).exit_code, 0);
  EXPECT_EQ(check({"--map-limit", "1000000"}).exit_code, 1);
}

TEST_F(CountCommand, ALimitIsNoAnswer) {
  const Outcome result = count({"--region-limit", "1", "--map-limit", "1G"});
  EXPECT_EQ(result.exit_code, 3) << result.out;
  EXPECT_EQ(result.out.find("does not fit"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("limited: at least"), std::string::npos) << result.out;
}

TEST_F(CountCommand, TheCheckerReadsItsProblemAndCommandLine) {
  ASSERT_EQ(count({"--proof", path("toy.count")}).exit_code, 0);
  const Outcome right = check({"--problem", path("toy.json"), "--threads", "2"});
  EXPECT_EQ(right.exit_code, 0) << right.err;
  EXPECT_EQ(right.out.rfind("confirmed: at least 3 regions, at least " + std::to_string(kToyBytes), 0), 0u);
  std::ofstream(path("other.json")) << std::string(kToy) + "\n";
  EXPECT_EQ(check({"--problem", path("other.json")}).exit_code, 1);
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"--threads", "0"}, {"--threads"}, {"--map-limit", "x"}, {"--what"}})
    EXPECT_EQ(check(wrong).exit_code, 2);
  EXPECT_EQ(run({CHECK_COUNT}).exit_code, 2);
  EXPECT_EQ(run({CHECK_COUNT, "--help"}).exit_code, 0);
}

TEST_F(CountCommand, BadInputIsRefusedInOneLine) {
  const Outcome missing = run({OFFLINE_MPT_PROGRAM, "count", path("nothing.json")});
  EXPECT_EQ(missing.exit_code, 2);
  std::string text = kToy;
  text.replace(text.find("[[1]]"), 5, "[[0]]");
  std::ofstream(path("toy.json")) << text;
  const Outcome result = count({"--proof", path("toy.count")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("toy.json: H: must be positive definite to count"), std::string::npos) << result.err;
  EXPECT_EQ(check({}).exit_code, 2) << "a proof was left behind";
}

}  // namespace
}  // namespace polyfly
