// `offline_mpt export` and `check_certificate --export` as a user calls them.
#include <filesystem>

#include "run_program.hpp"

namespace polyfly {
namespace {

class ExportCommand : public ToolTest {
 protected:
  void SetUp() override {
    write("toy.json", kToy);
    output("solve toy.json -o toy.map");
  }

  static std::string exportWith(const std::string& options) {
    return "export toy.map -o code --name clip " + options;
  }
  Outcome confirm() const { return check("--export code --map toy.map"); }
  void expectFiles(const std::string& folder, const Words& names) const {
    for (const std::string& name : names)
      EXPECT_TRUE(std::filesystem::is_regular_file(path(folder + "/" + name))) << name;
  }
};

TEST_F(ExportCommand, WritesFourFilesThatAreConfirmed) {
  for (const std::string type : {"double", "float"}) {
    const std::string shown = output(exportWith("--type " + type));
    expectFiles("code", {"clip.c", "clip.h", "clip_test.c", "clip.json"});
    EXPECT_EQ(json("code/clip.json")["type"], type);
    EXPECT_EQ(bool(holds(shown, ": off the map's by at most ")), type != "double") << shown;
    const Outcome confirmed = confirm();
    EXPECT_EQ(confirmed.exit_code, 0) << confirmed.err;
    EXPECT_TRUE(holds(confirmed.out, "confirmed: the code of 3 regions"));
  }
}

TEST_F(ExportCommand, TheSameMapGivesTheSameBytes) {
  output(exportWith("--type float"));
  const std::string code = text("code/clip.c"), facts = text("code/clip.json");
  output(exportWith("--type float"));
  EXPECT_EQ(text("code/clip.c"), code);
  EXPECT_EQ(text("code/clip.json"), facts);
}

TEST_F(ExportCommand, OnlineWritesASolverOfAMapOrAProblem) {
  for (const std::string source : {"toy.map", "toy.json"}) {
    EXPECT_TRUE(holds(output("export " + source + " -o online --name clip --online --iteration-limit 7"),
                      "0 at the iteration limit"));
    expectFiles("online", {"clip.c", "clip.h", "clip_test.c"});
    // One of the two bounds is active at most.
    for (const char* const fact : {"\"iterations\": 7", "\"iterations\": 1,"})
      EXPECT_TRUE(holds(text("online/clip.json"), fact));
  }
  expectRefused(exportWith("--online --flash-limit 1k"));
  expectRefused(exportWith("--iteration-limit 7"));
  expectRefused(exportWith("--online --iteration-limit 0"));
}

TEST_F(ExportCommand, CodeBeyondTheLimitOfFlashIsRefused) {
  output(exportWith(""));
  const int bytes = json("code/clip.json")["flash_bytes"].get<int>();
  output(exportWith("--flash-limit " + std::to_string(bytes)));
  const std::string limit = "--flash-limit " + std::to_string(bytes - 1);
  expectRefused(exportWith(limit), {"in double needs " + std::to_string(bytes) + " bytes; --type float"});
  output(exportWith("--type float " + limit));
}

TEST_F(ExportCommand, TheTypeThatWasRemovedIsRefusedWithWhatToUse) {
  expectRefused(exportWith("--type int16"), {"--type: int16 was removed", "use float"});
}

// Rounding decides all that these limits decide, so no second solver confirms an answer.
TEST_F(ExportCommand, OnlineRefusesWhatCannotBeConfirmed) {
  write("narrow.json", R"({"H": [[2, 1], [1, 2]], "f": [0, 0], "F": [[1, 0], [0, 1]],
    "A": [[1, 0], [-1, 0], [0, 1], [0, -1]], "b": [1e-8, 1e-8, 1e-8, 1e-8],
    "B": [[0, 0], [0, 0], [0, 0], [0, 0]], "lb": [-3, -3], "ub": [3, 3]})");
  expectRefused("export narrow.json -o online --name clip --online --type float",
                {"another solver confirms none of the answers"});
}

// What stands around the tables cannot change the answers.
TEST_F(ExportCommand, ChangedFunctionsAndHeadersAreRefused) {
  output(exportWith(""));
  const auto expectChangeRefused = [&](const std::string& file, const std::string& part,
                                       const std::string& other) {
    const std::string right = text(file);
    write(file, replaced(right, part, other));
    const Outcome result = confirm();
    write(file, right);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(holds(result.err, "the text of the code"));
  };
  EXPECT_EQ(confirm().exit_code, 0);
  expectChangeRefused("code/clip.c", "u[j] = sum;", "u[j] = -sum;");
  expectChangeRefused("code/clip.c", "/* Laws u = K", "#if 0\n/* Laws u = K");
  expectChangeRefused("code/clip.h", "#include <stdint.h>", "#include <stdint.h>\n#define double float");
}

TEST_F(ExportCommand, BadOptionsEndInOneLineAndWriteNothing) {
  for (const char* const options : {" --name 1clip", " --name ../clip", " --name clip --type half", ""})
    expectRefused(std::string("export toy.map -o code") + options);
}

TEST_F(ExportCommand, AnAlteredFolderIsRefused) {
  output(exportWith("--type float"));
  const std::string code = text("code/clip.c");
  write("code/clip.c", replaced(code, "{1.0f, 1.0f,", "{1.1f, 1.0f,"));
  Outcome result = confirm();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(holds(result.err, "refused: the error of input 0 may exceed its bound"));
  // Cut off, empty, and none.
  write("code/clip.c", code.substr(0, code.size() / 3));
  EXPECT_EQ(confirm().exit_code, 1);
  write("code/other.json", "{}");
  result = confirm();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(holds(result.err, "more than one file *.json"));
  std::filesystem::remove_all(path("code"));
  EXPECT_EQ(confirm().exit_code, 2);
}

TEST_F(ExportCommand, OptionsThatExcludeOneAnotherAreRefused) {
  for (const char* const options : {"", " --map toy.map toy.map", " --map toy.map --problem toy.map"})
    EXPECT_EQ(check(std::string("--export code") + options).exit_code, 2) << options;
}

}  // namespace
}  // namespace polyfly
