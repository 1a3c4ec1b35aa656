// Every option that takes a number, as `--help` lists them, refuses what is no such number.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace polyfly {
namespace {

using Words = std::vector<std::string>;

class BadOptions : public testing::Test {
 protected:
  Outcome run(const std::string& program, const Words& words) const {
    Words all{program};
    all.insert(all.end(), words.begin(), words.end());
    return waitForProgram(startProgram(all, folder_.path(".")), folder_.path("."));
  }

  /// One line on standard error that begins so, exit code 2, and nothing else.
  void expectLine(const std::string& program, const Words& words, const std::string& begin) const {
    const Outcome result = run(program, words);
    EXPECT_EQ(result.exit_code, 2) << begin;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err.rfind(begin, 0), 0u) << begin << " in: " << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_LT(result.err.size(), 500u) << result.err;
  }

  ScratchFolder folder_;
};

TEST_F(BadOptions, EveryNumberIsCheckedByEveryCommand) {
  int seen = 0;
  for (const Words& command : std::vector<Words>{
           {"solve"}, {"verify"}, {"reduce"}, {"diff"}, {"analyze"}, {"bounds"}, {"set", "invariant"}}) {
    Words help = command;
    help.emplace_back("--help");
    std::istringstream lines(run(OFFLINE_MPT_PROGRAM, help).out);
    for (std::string line; std::getline(lines, line);) {
      std::string names, type;
      std::istringstream(line) >> names >> type;
      const std::size_t dashes = names.find("--");
      const bool is_real = type.rfind("FLOAT", 0) == 0;
      if (dashes == std::string::npos || (!is_real && type.find("INT") > 1)) continue;
      ++seen;
      const std::string option = names.substr(dashes);
      Words values{"nan", "-1", "1e999", "x", ""};
      if (!is_real) values.insert(values.end(), {"1.5", "999999999999999999999999"});
      for (const std::string& value : values) {
        Words words = command;
        words.insert(words.end(), {option, value});
        SCOPED_TRACE(command.back() + " " + option + " " + value);
        expectLine(OFFLINE_MPT_PROGRAM, words,
                   "offline_mpt: " + option + ": " + (value.empty() ? "its value is empty" : value));
      }
    }
  }
  EXPECT_GE(seen, 20) << "options that take a number";
}

TEST_F(BadOptions, UnknownWordsNameTheKnownOnes) {
  expectLine(OFFLINE_MPT_PROGRAM, {"reduce", "a.map", "-o", "b.map", "--tree", "foo"},
             "offline_mpt: --tree: foo is not one of auto, small");
}

TEST_F(BadOptions, EndlessFilesEndInALine) {
  expectLine(OFFLINE_MPT_PROGRAM, {"info", "/dev/zero"}, "offline_mpt: /dev/zero: ");
  expectLine(CHECK_CERTIFICATE, {"/dev/zero", "--map", "/dev/zero"}, "check_certificate: /dev/zero: ");
}

TEST_F(BadOptions, TheCheckerTellsWhatIsWrongWithItsCommandLine) {
  expectLine(CHECK_CERTIFICATE, {}, "check_certificate: the file to check is missing");
  expectLine(CHECK_CERTIFICATE, {"a.cert"}, "check_certificate: --map is missing");
  expectLine(CHECK_CERTIFICATE, {"a.cert", "--map"}, "check_certificate: --map: its value is missing");
  expectLine(CHECK_CERTIFICATE, {"a.cert", "--map", ""}, "check_certificate: --map: its value is missing");
  expectLine(CHECK_CERTIFICATE, {"a.cert", "--wings"}, "check_certificate: '--wings' is no option");
  expectLine(CHECK_CERTIFICATE, {"a.cert", "--map", "\x1b[31m"}, "check_certificate: ?[31m: no such file");
}

TEST_F(BadOptions, NoEscapeSequenceReachesTheTerminal) {
  expectLine(OFFLINE_MPT_PROGRAM, {"info", "\x1b[2J.map"}, "offline_mpt: '\\x1b[2J.map': control characters");
  writeBytes(folder_.path("a.json"),
             R"({"H": [[1]], "f": [0], "F": [[1]], "A": [], "b": [], "B": [], "lb": [0], "ub": [1],
                 "\u001b[31mred": 1})");
  const Words words{"solve", folder_.path("a.json"), "-o", folder_.path("a.map")};
  expectLine(OFFLINE_MPT_PROGRAM, words,
             "offline_mpt: " + folder_.path("a.json") + ": \\x1b[31mred: unknown key");
}

}  // namespace
}  // namespace polyfly
