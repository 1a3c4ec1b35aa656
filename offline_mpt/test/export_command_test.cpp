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
  for (const char* const type : {"double", "float"}) {
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

TEST_F(ExportCommand, CodeBeyondTheLimitOfFlashIsRefused) {
  ASSERT_EQ(exportMap({"--name", "clip"}).exit_code, 0);
  const std::string facts = readBytes(path("code/clip.json"));
  const int bytes = std::stoi(facts.substr(facts.find("\"flash_bytes\": ") + 15));
  EXPECT_EQ(exportMap({"--name", "clip", "--flash-limit", std::to_string(bytes)}).exit_code, 0);
  const Outcome refused = exportMap({"--name", "clip", "--flash-limit", std::to_string(bytes - 1)});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("in double needs " + std::to_string(bytes) + " bytes; --type float"),
            std::string::npos)
      << refused.err;
  EXPECT_EQ(
      exportMap({"--name", "clip", "--type", "float", "--flash-limit", std::to_string(bytes - 1)}).exit_code,
      0);
}

TEST_F(ExportCommand, TheTypeThatWasRemovedIsRefusedWithWhatToUse) {
  const Outcome result = exportMap({"--name", "clip", "--type", "int16"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("--type: int16 was removed"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("use float"), std::string::npos) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_FALSE(fs::exists(path("code")));
}

// Rounding decides all that these limits decide, so no second solver confirms an answer.
TEST_F(ExportCommand, OnlineRefusesWhatCannotBeConfirmed) {
  writeBytes(path("narrow.json"), R"({"H": [[2, 1], [1, 2]], "f": [0, 0], "F": [[1, 0], [0, 1]],
    "A": [[1, 0], [-1, 0], [0, 1], [0, -1]], "b": [1e-8, 1e-8, 1e-8, 1e-8],
    "B": [[0, 0], [0, 0], [0, 0], [0, 0]], "lb": [-3, -3], "ub": [3, 3]})");
  const Outcome result = run({OFFLINE_MPT_PROGRAM, "export", path("narrow.json"), "-o", path("online"),
                              "--name", "clip", "--online", "--type", "float"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("another solver confirms none of the answers"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(path("online")));
}

// What stands around the tables cannot change the answers.
TEST_F(ExportCommand, ChangedFunctionsAndHeadersAreRefused) {
  ASSERT_EQ(exportMap({"--name", "clip"}).exit_code, 0);
  const auto refused = [&](const char* name, const std::string& part, const std::string& other) {
    const std::string file = path(std::string("code/") + name), text = readBytes(file);
    EXPECT_NE(text.find(part), std::string::npos) << part;
    std::string changed = text;
    writeBytes(file, changed.replace(changed.find(part), part.size(), other));
    const Outcome result = confirm();
    writeBytes(file, text);
    return result.exit_code == 1 && result.err.find("the text of the code") != std::string::npos;
  };
  EXPECT_EQ(confirm().exit_code, 0);
  EXPECT_TRUE(refused("clip.c", "u[j] = sum;", "u[j] = -sum;"));
  EXPECT_TRUE(refused("clip.c", "/* Laws u = K", "#if 0\n/* Laws u = K"));
  EXPECT_TRUE(refused("clip.h", "#include <stdint.h>", "#include <stdint.h>\n#define double float"));
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
