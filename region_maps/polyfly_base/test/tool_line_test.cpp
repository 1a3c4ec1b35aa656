// What a tool says about a command line that breaks a rule, and how it ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <new>
#include <stdexcept>

#include "command_line/command_line.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/version.hpp"
#include "polyfly_base/visible.hpp"

namespace polyfly {
namespace {

enum class Shade : std::uint8_t { kDark, kLight };

struct Ended {
  int code = -1;
  std::string said;     // on standard error
  std::string printed;  // on standard output
};

class ToolLine : public testing::Test {
 protected:
  ToolLine() {
    app_.add_option("--seed", seed_)->check(wholeNumber<std::uint64_t>());
    app_.add_option("--threads", threads_)->check(wholeNumber(1, 256));
    app_.add_option("--samples", samples_)->check(wholeNumber<int>(1));
    app_.add_option("--mass", mass_)->check(numberAbove(0.0));
    app_.add_option("--wind", wind_)->check(numberFrom(0.0));
    app_.add_option("--share", share_)->check(numberFrom(0.5, 0.9999));
    app_.add_option("--offset", offset_)->check(finiteNumber());
    app_.add_option("--limit", limit_)->transform(byteCount());
    app_.add_option("--shade", shade_)
        ->transform(oneOf(std::map<std::string, Shade>{{"dark", Shade::kDark}, {"light", Shade::kLight}}));
    app_.add_option("--word", word_)->check(oneOf(std::vector<std::string>{"keep", "widen"}));
  }

  Ended run(
      std::vector<std::string> words, const std::function<int()>& work = [] { return 0; }) {
    words.insert(words.begin(), "toy");
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = runTool(app_, static_cast<int>(argv.size()), argv.data(), work);
    return {code, testing::internal::GetCapturedStderr(), testing::internal::GetCapturedStdout()};
  }

  void expectRefused(const std::string& option, const std::string& value, const std::string& sentence) {
    const Ended ended = run({option, value});
    EXPECT_EQ(ended.code, kBadUsage) << option << " " << value;
    EXPECT_EQ(ended.said, "toy: " + option + ": " + sentence + " (see toy --help)\n");
  }

  CLI::App app_{"A toy.", "toy"};
  std::uint64_t seed_ = 0, limit_ = 0;
  int threads_ = 0, samples_ = 0;
  double mass_ = 0.0, wind_ = 0.0, share_ = 0.0, offset_ = 0.0;
  Shade shade_ = Shade::kDark;
  std::string word_;
};

TEST_F(ToolLine, WholeNumbersNeitherWrapNorSaturate) {
  expectRefused("--seed", "-1", "-1 is not a whole number of at least 0");
  expectRefused("--seed", "18446744073709551616",
                "18446744073709551616 is not a whole number of at most 18446744073709551615");
  expectRefused("--seed", "1.5", "1.5 is not a whole number of at least 0");
  expectRefused("--seed", "nan", "nan is not a whole number of at least 0");
  expectRefused("--seed", "010", "010 is not a whole number of at least 0");
  expectRefused("--seed", "", "its value is empty");
  expectRefused("--threads", "0", "0 is not a whole number from 1 to 256");
  expectRefused("--threads", "257", "257 is not a whole number from 1 to 256");
  expectRefused("--samples", "2147483648", "2147483648 is not a whole number from 1 to 2147483647");
  EXPECT_EQ(run({"--seed", "18446744073709551615", "--threads", "256"}).code, 0);
  EXPECT_EQ(seed_, 18446744073709551615u);
  EXPECT_EQ(threads_, 256);
}

TEST_F(ToolLine, NumbersAreFiniteAndInTheirRange) {
  expectRefused("--mass", "nan", "nan is not a finite number above 0");
  expectRefused("--mass", "0", "0 is not a finite number above 0");
  expectRefused("--mass", "1e999", "1e999 is not a finite number above 0");
  expectRefused("--wind", "inf", "inf is not a finite number of at least 0");
  expectRefused("--wind", "-0.5", "-0.5 is not a finite number of at least 0");
  expectRefused("--share", "1", "1 is not a number from 0.5 to 0.9999");
  expectRefused("--offset", "north", "north is not a finite number");
  expectRefused("--offset", "0x10", "0x10 is not a finite number");
  expectRefused("--offset", "1 m", "'1 m' is not a finite number");
  EXPECT_EQ(run({"--mass", "1e-3", "--wind", "0", "--share", "0.5", "--offset", "-2"}).code, 0);
  EXPECT_EQ(mass_, 1e-3);
  EXPECT_EQ(offset_, -2.0);
}

TEST_F(ToolLine, BytesHaveUnits) {
  expectRefused("--limit", "-1", "-1 is not a number of bytes of at least 0, such as 500M or 4G");
  expectRefused("--limit", "4X", "4X is not a number of bytes of at least 0, such as 500M or 4G");
  expectRefused("--limit", "99999999999G",
                "99999999999G is not a number of bytes of at least 0, such as 500M or 4G");
  for (const char* text : {"2147483648", "2097152k", "2048MB", "2g", "2GiB"}) {
    EXPECT_EQ(run({"--limit", text}).code, 0) << text;
    EXPECT_EQ(limit_, std::uint64_t{1} << 31u) << text;
  }
}

TEST_F(ToolLine, UnknownWordsNameTheKnownOnes) {
  expectRefused("--shade", "foo", "foo is not one of dark, light");
  expectRefused("--word", "red wine", "'red wine' is not one of keep, widen");
  EXPECT_EQ(run({"--shade", "Light", "--word", "widen"}).code, 0);
  EXPECT_EQ(shade_, Shade::kLight);
}

TEST_F(ToolLine, LongValuesAreCutShort) {
  expectRefused("--seed", std::string(5000, 'x'),
                std::string(40, 'x') + ".. is not a whole number of at least 0");
}

TEST_F(ToolLine, EveryErrorIsOneLineWithTheToolsName) {
  const auto failing = [&](const std::function<int()>& work) { return run({}, work); };
  const Ended bad = failing([]() -> int { throw Error("a\nb.map: \x1b]0;x\x07 is bad"); });
  EXPECT_EQ(bad.code, kBadUsage);
  EXPECT_EQ(bad.said, "toy: a\\nb.map: \\x1b]0;x\\x07 is bad\n");
  EXPECT_EQ(failing([]() -> int { throw std::bad_alloc(); }).said, "toy: out of memory\n");
  EXPECT_EQ(failing([]() -> int { throw std::length_error("vector"); }).said, "toy: out of memory\n");
  EXPECT_EQ(failing([]() -> int { throw std::runtime_error("x"); }).code, kBadUsage);
  EXPECT_EQ(failing([] { return 3; }).code, 3);
  const Ended unknown = run({"--wings\n", "2"});
  EXPECT_EQ(unknown.code, kBadUsage);
  EXPECT_EQ(std::count(unknown.said.begin(), unknown.said.end(), '\n'), 1) << unknown.said;
}

TEST_F(ToolLine, NamesThatATerminalWouldActOnAreRefused) {
  EXPECT_EQ(run({"--word", "\x1b[31mred"}).said,
            "toy: '\\x1b[31mred': control characters are not taken (see toy --help)\n");
  EXPECT_EQ(run({"--word=\xc2\x9b"}).code, kBadUsage);
}

TEST_F(ToolLine, EmptyWordsAreRefusedBeforeTheWork) {
  const auto never = []() -> int { throw Error("worked"); };
  EXPECT_EQ(run({"--word", ""}, never).said, "toy: --word: its value is empty (see toy --help)\n");
  EXPECT_EQ(run({"--word="}, never).said, "toy: --word= has no value (see toy --help)\n");
  EXPECT_EQ(run({""}, never).said, "toy: an argument is empty (see toy --help)\n");
}

TEST_F(ToolLine, ADiskThatIsFullIsAnError) {
  const auto printed = [&](const char* word) {
    if (std::freopen("/dev/full", "w", stdout) == nullptr) return 0;
    const std::vector<const char*> argv{"toy", word};
    return runTool(app_, 2, argv.data(), [] {
      std::puts("a line");
      return 0;
    });
  };
  EXPECT_EXIT(std::exit(printed("--seed=1")), testing::ExitedWithCode(kBadUsage),
              "toy: the standard output cannot be");
  EXPECT_EXIT(std::exit(printed("--help")), testing::ExitedWithCode(kBadUsage),
              "toy: the standard output cannot be");
}

TEST_F(ToolLine, AWordThatIsNoCommandIsNamed) {
  app_.add_subcommand("fly", "flies");
  EXPECT_EQ(run({"land"}).said, "toy: 'land' is no command (see toy --help)\n");
  EXPECT_EQ(run({"fly"}).code, 0);
}

TEST_F(ToolLine, EveryToolTellsItsVersion) {
  app_.require_subcommand(1);
  app_.add_subcommand("fly", "flies");
  const Ended ended = run({"--version"}, [] { return 3; });
  EXPECT_EQ(ended.code, 0);
  EXPECT_EQ(ended.printed, std::string("toy ") + kVersion + "\n");
  EXPECT_EQ(ended.said, "");
}

TEST(Visible, KeepsTextAndShowsWhatATerminalWouldActOn) {
  EXPECT_EQ(visible("r\xc3\xb6hre \xe2\x82\xac.bag"), "r\xc3\xb6hre \xe2\x82\xac.bag");
  EXPECT_EQ(visible("\x1b[2J\r\n\t\x7f"), "\\x1b[2J\\r\\n\\t\\x7f");
  EXPECT_EQ(visible("\xc2\x9b"
                    "1m"),
            "\\xc2\\x9b"
            "1m")
      << "C1 controls act as escapes do";
  EXPECT_EQ(visible("\xff\xc3"), "\\xff\\xc3");
  EXPECT_EQ(visible("a\xe2\x80\xaegpj.exe"), "a\\xe2\\x80\\xaegpj.exe") << "turns what follows around";
  EXPECT_EQ(visible("\xd8\x9c"), "\\xd8\\x9c");
  EXPECT_EQ(visibleLines("a\x1b\nb\n"), "a\\x1b\nb\n");
  EXPECT_TRUE(hasControl("a\tb"));
  EXPECT_FALSE(hasControl("r\xc3\xb6hre \xff.bag"));
  EXPECT_EQ(visible(std::string("a\0b", 3)), "a\\x00b");
}

}  // namespace
}  // namespace polyfly
