// What is no problem, map or option of `offline_mpt` and `check_certificate` is refused in one line.
#include "run_program.hpp"

namespace polyfly {
namespace {

class BadOptions : public ToolTest {
 protected:
  void expectCheckerRefuses(Words words, const std::string& part) const {
    words.insert(words.begin(), CHECK_CERTIFICATE);
    expectRefused(words, {"check_certificate: " + part});
  }

  /// The toy problem with these fields in the place of its own is refused.
  void expectProblemRefused(const std::string& fields, const Words& parts) const {
    nlohmann::json problem = nlohmann::json::parse(kToy);
    problem.update(nlohmann::json::parse(fields));
    write("toy.json", problem.dump());
    expectRefused("solve toy.json -o none.map", parts);
  }
};

// As `--help` lists them.
TEST_F(BadOptions, EveryNumberIsCheckedByEveryCommand) {
  int seen = 0;
  for (const Words& command : std::vector<Words>{
           {"solve"}, {"verify"}, {"reduce"}, {"diff"}, {"analyze"}, {"bounds"}, {"set", "invariant"}}) {
    Words words = command;
    words.insert(words.begin(), OFFLINE_MPT_PROGRAM);
    words.emplace_back("--help");
    std::istringstream lines(wait(start(words)).out);
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
        words.resize(1 + command.size());
        words.insert(words.end(), {option, value});
        expectRefused(words,
                      {"offline_mpt: " + option + ": " + (value.empty() ? "its value is empty" : value)});
      }
    }
  }
  EXPECT_GE(seen, 20) << "options that take a number";
}

TEST_F(BadOptions, UnknownWordsNameTheKnownOnes) {
  expectRefused("reduce a.map -o b.map --tree foo", {"offline_mpt: --tree: foo is not one of auto, small"});
}

TEST_F(BadOptions, EndlessFilesEndInALine) {
  expectRefused("info /dev/zero", {"offline_mpt: /dev/zero: "});
  expectCheckerRefuses({"/dev/zero", "--map", "/dev/zero"}, "/dev/zero: ");
}

TEST_F(BadOptions, TheCheckerTellsWhatIsWrongWithItsCommandLine) {
  expectCheckerRefuses({}, "the file to check is missing");
  expectCheckerRefuses({"a.cert"}, "--map is missing");
  expectCheckerRefuses({"a.cert", "--map"}, "--map: its value is missing");
  expectCheckerRefuses({"a.cert", "--map", ""}, "--map: its value is missing");
  expectCheckerRefuses({"a.cert", "--wings"}, "'--wings' is no option");
  expectCheckerRefuses({"a.cert", "--map", "\x1b[31m"}, "?[31m: no such file");
}

TEST_F(BadOptions, NoEscapeSequenceReachesTheTerminal) {
  expectRefused("info \x1b[2J.map", {"offline_mpt: '\\x1b[2J.map': control characters"});
  expectProblemRefused(R"({"\u001b[31mred": 1})", {"offline_mpt: toy.json: \\x1b[31mred: unknown key"});
}

TEST_F(BadOptions, OptionsThatAreMissingUnknownOrWrong) {
  write("toy.json", kToy);
  output("solve toy.json -o toy.map");
  expectRefused("solve toy.json", {"--output"});
  expectRefused("solve toy.json -o x.map --threads 0", {"--threads"});
  expectRefused("solve toy.json -o x.map --wings 2", {"--wings"});
  expectRefused("solve toy.json -o no/such/folder.map", {"no/such"});
  expectRefused("solve toy.json -o .", {"is a folder"});
  expectRefused("land", {"land"});
  expectRefused("", {"subcommand"});
  expectRefused("verify toy.map --samples 0", {"--samples"});
  expectRefused("reduce toy.map -o x.map --time-limit -1", {"--time-limit"});
  expectRefused("plot toy.map --slice theta -o x.svg", {"--slice", "'theta'"});
  expectRefused("plot toy.map --slice no,such -o x.svg", {"no"});
  expectRefused("plot toy.map --slice a,b --at c -o x.svg", {"--at", "'c'"});
}

TEST_F(BadOptions, WhatWasRemovedSaysWhatToUse) {
  write("toy.json", kToy);
  output("solve toy.json -o toy.map");
  expectRefused("count toy.json --map-limit 24G", {"count: was removed; ", "--region-limit"});
  expectRefused("bounds toy.json flight.csv", {"bounds: was removed; ", "disturbance_ranges"});
  expectRefused("reduce toy.map -o x.map --merge greedy", {"--merge: was removed; ", "joined in pairs"});
  expectRefused("reduce toy.map --separate -o x.map", {"--separate: was removed; ", "small"});
}

TEST_F(BadOptions, FilesThatHoldNoProblem) {
  write("problem.txt", "x");
  write("malformed.yaml", "name: x\nstates: [a, b\nhorizon: }\n");
  write("malformed.json", "{\"H\": [[1.0]");
  for (const std::string name :
       {"missing.yaml", "missing.json", "problem.txt", "malformed.yaml", "malformed.json"})
    expectRefused("solve " + name + " -o none.map", {name + ":"});
}

TEST_F(BadOptions, ProblemsThatCannotBeSolved) {
  expectProblemRefused(R"({"F": [[-1, -1, 0]]})", {"toy.json", "F"});
  expectProblemRefused(R"({"ub": [2, null]})", {"toy.json", "ub"});
  expectProblemRefused(R"({"b": [-1, -1]})", {"toy.json", "infeasible"});
  expectProblemRefused(R"({"H": [[-1]]})", {"toy.json: ", "H: must be"});
  expectProblemRefused(
      R"({"H": [[1, 1], [1, 1]], "f": [0, 0], "F": [[1, 0], [0, 1]], "A": [[1, 0], [-1, 0]]})",
      {"toy.json: ", "H: is singular, and not zero"});
  expectProblemRefused(R"({"A": [[1], [-1], [1], [1]], "b": [1, 1, 0, 1e-9], "eq_ids": [2, 3],
      "B": [[0, 0], [0, 0], [0, 0], [0, 0]]})",
                       {"toy.json: eq_ids: row 3 depends on other equalities"});
  expectProblemRefused(R"({"H": [[0]], "f": [-3], "F": [[1, 0]], "A": [[-1]], "b": [1], "B": [[0, 0]]})",
                       {"toy.json", "the cost is unbounded below at theta = "});
}

TEST_F(BadOptions, DamagedMaps) {
  write("toy.json", kToy);
  output("solve toy.json -o toy.map");
  const std::string bytes = text("toy.map");
  Words damaged{bytes.substr(0, bytes.size() - 100), bytes.substr(0, 20), "", std::string(4096, 'x')};
  for (const std::size_t position : {std::size_t{3}, bytes.size() / 3, bytes.size() / 2, bytes.size() - 1}) {
    damaged.push_back(bytes);
    damaged.back()[position] ^= 0x10;
  }
  for (const std::string& map : damaged) {
    write("damaged.map", map);
    expectRefused("info damaged.map", {"damaged.map"});
    expectRefused("verify damaged.map --problem toy.json", {"damaged.map"});
  }
  expectRefused("info gone.map", {"gone.map"});
  expectRefused("plot gone.map --slice a,b -o x.svg", {"gone.map"});
  expectRefused("explore gone.map -o x.html", {"gone.map"});
}

TEST_F(BadOptions, TheCellThatIsWrongIsNamed) {
  write("toy.json", kToy);
  output("solve toy.json -o toy.map");
  const auto refused = [this](const std::string& cells, const Words& parts) {
    write("bad.csv", cells);
    expectRefused("eval toy.map --csv bad.csv -o out.csv", parts);
  };
  refused("0,0\n0,1.5x\n", {"bad.csv:2:", "column 2", "theta_1", "'1.5x' is not a number"});
  refused("0,0\n\n0,0,0\n", {"bad.csv:3:", "must have 2 columns, got 3"});
  refused("theta_1,wind\n0,0\n", {"bad.csv:1:", "column 2", "'wind' is not a parameter"});
  refused("theta_1,theta_1\n0,0\n", {"bad.csv:1:", "is given twice"});
  refused("theta_1\n0\n", {"bad.csv:1:", "no column for the parameter"});
  expectRefused("eval toy.map --csv none.csv", {"none.csv: cannot be read"});
}

}  // namespace
}  // namespace polyfly
