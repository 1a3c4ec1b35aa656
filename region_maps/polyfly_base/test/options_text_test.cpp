// Options as YAML, and back.
#include "polyfly_base/options_text.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>

#include "error_of.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/load_yaml.hpp"
#include "polyfly_base/options_from_yaml.hpp"

namespace polyfly {
namespace {

struct Made {
  double mass = 1.52;
  double small = 1e-6;
  int periods = 10;
  bool on = true;
  std::vector<double> list{0.1, 2.0};
  std::string name = "a \"quoted\" \\ name";
  std::optional<bool> perhaps = false;
  std::string empty;
  std::vector<double> none;
  std::optional<bool> unset;
};

template <class Options, class Visit>
void visitMade(Options& made, Visit&& visit) {
  visit("vehicle/mass", made.mass, "kg", Range{0.01, 1000.0});
  visit("name", made.name);
  visit("vehicle/small", made.small, "", Range{0.0, 1.0});
  visit("node/periods", made.periods, "samples", Range{0.0, 100.0});
  visit("node/active", made.on);
  visit("node/list", made.list);
  visit("perhaps", made.perhaps);
  visit("empty", made.empty);
  visit("none", made.none);
  visit("unset", made.unset);
}

TEST(OptionsText, IsGroupedWithUnitsAndRanges) {
  OptionsText text;
  const Made made;
  visitMade(made, text);
  text.matrix("in_force/model/lateral", {{1.0, -0.5}, {0.0, 1e-7}});
  text.number("in_force/period", 0.1);
  EXPECT_EQ(text.yaml(),
            "vehicle:\n"
            "  mass: 1.52  # [kg] 0.01 .. 1000\n"
            "  small: 1.0e-06  # 0 .. 1\n"
            "name: \"a \\\"quoted\\\" \\\\ name\"\n"
            "node:\n"
            "  periods: 10  # [samples] 0 .. 100\n"
            "  active: true\n"
            "  list: [0.1, 2.0]\n"
            "perhaps: false\n"
            "in_force:\n"
            "  model:\n"
            "    lateral: [[1.0, -0.5], [0.0, 1.0e-07]]\n"
            "  period: 0.1\n");
}

TEST(OptionsText, IsReadBackExactly) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 200; ++round) {
    Made made;
    const std::uint64_t bits = random();
    std::memcpy(&made.mass, &bits, sizeof made.mass);
    if (!(std::abs(made.mass) < std::numeric_limits<double>::max())) continue;
    const Range any{-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
    OptionsText text;
    text("group/value", made.mass, "", any);
    Made back;
    OptionsFromYaml reader(text.yaml(), "made.yaml");
    reader("group/value", back.mass, "", any);
    EXPECT_EQ(back.mass, made.mass) << text.yaml();
  }
  OptionsText text;
  const Made made;
  visitMade(made, text);
  Made back;
  back.mass = back.small = 0.5;
  back.list.clear();
  back.name.clear();
  back.perhaps.reset();
  OptionsFromYaml reader(text.yaml(), "made.yaml");
  visitMade(back, reader);
  OptionsText again;
  visitMade(back, again);
  EXPECT_EQ(again.yaml(), text.yaml());
  reader.refuseUnknownKeys({"vehicle", "node"});
  reader.refuseUnknownGroups({"vehicle", "node"}, {"name", "perhaps"});
}

// ROS reads YAML 1.1 by PyYAML, for which a number needs a point, and an exponent a sign.
TEST(OptionsText, NumbersAreNumbersOfYaml11) {
  EXPECT_EQ(exactNumber(20.0), "20.0");
  EXPECT_EQ(exactNumber(1.0 / 3.0), "0.3333333333333333");
  for (const double value : {1.0, -3.0, 1e-6, 2.5e-9, 1e22, 123456789.0, 0.1, -1e-300, 0.0}) {
    const std::string text = exactNumber(value);
    EXPECT_NE(text.find('.'), std::string::npos) << text;
    const std::size_t exponent = text.find('e');
    EXPECT_TRUE(exponent == std::string::npos || text[exponent + 1] == '-' || text[exponent + 1] == '+')
        << text;
    EXPECT_EQ(std::strtod(text.c_str(), nullptr), value);
  }
}

std::string errorIn(const std::string& text) {
  return errorOf([&] {
    Made made;
    OptionsFromYaml reader(text, "made.yaml");
    visitMade(made, reader);
    reader.refuseUnknownKeys({"vehicle", "node"});
    reader.refuseUnknownGroups({"vehicle", "node"}, {"name"});
  });
}

TEST(OptionsFromYaml, RefusesByLineKeyAndRule) {
  EXPECT_EQ(errorIn("vehicle: {mass: 2}\n"), "no error");
  EXPECT_EQ(errorIn("name: x\nvehicle: {mass: 2000}\n"),
            "made.yaml:2: vehicle/mass: must lie in [0.01, 1000] kg, got 2000");
  EXPECT_EQ(errorIn("vehicle: {mass: .nan}\n"),
            "made.yaml:1: vehicle/mass: must be a number (decimal digits, without leading zeros)");
  EXPECT_EQ(errorIn("vehicle: {mass: heavy}\n"),
            "made.yaml:1: vehicle/mass: must be a number (decimal digits, without leading zeros)");
  EXPECT_EQ(errorIn("node: {periods: 2.5}\n"), "made.yaml:1: node/periods: must be a whole number");
  EXPECT_EQ(errorIn("node: {active: 3}\n"), "made.yaml:1: node/active: must be true or false");
  EXPECT_EQ(errorIn("node: {list: [a]}\n"),
            "made.yaml:1: node/list: must be a number (decimal digits, without leading zeros)");
  EXPECT_EQ(errorIn("name: \"\"\n"), "made.yaml:1: name: must be a text that is not empty");
  EXPECT_EQ(errorIn("node: {odd: 1}\n"), "made.yaml:1: node/odd: unknown key");
  EXPECT_EQ(errorIn("vehicle: 3\n"), "made.yaml:1: vehicle: must be a map");
  EXPECT_EQ(errorIn("vehicel: {mass: 1}\n"), "made.yaml:1: vehicel: unknown group; is 'vehicle' meant?");
  EXPECT_EQ(errorIn("- 1\n"), "made.yaml: must be a map with the groups of a node's options");
}

// yaml-cpp 0.6 grows without end on these, and each version ends at a control character.
TEST(LoadYaml, TextsOnWhichAParserNeverEndsAreRefused) {
  const std::string rule = "must have a space or a line break between ':' and ']' or the end";
  for (const char* const text : {"\n[a:]\n", "\n{a: [b, c:]}\n", "\n{a: {b:", "\n[:", "\nname: x:"})
    EXPECT_EQ(errorIn(text), "made.yaml:2: file: " + rule) << text;
  const std::string controls = "made.yaml:3: file: must be UTF-8 without control characters";
  EXPECT_EQ(errorIn("name: x\n\n\4odd: 1\n"), controls);
  EXPECT_EQ(errorIn("name: x\n\n" + std::string(1, '\0')), controls);
  EXPECT_EQ(loadYaml("a: [b, {c: }]\r\nd:\t1\n", "made.yaml")["a"].size(), 2u);
}

// Whoever walks through it would never come to an end.
TEST(LoadYaml, AnAliasOfWhatHoldsItIsRefused) {
  for (const char* const text : {"a: &x [1, *x]\n", "a: &x {b: [*x]}\n", "&x [[*x]]\n"})
    EXPECT_EQ(errorIn(text), "made.yaml:1: file: is not valid YAML: an alias of what holds it") << text;
  EXPECT_EQ(loadYaml("a: &x [1, 2]\nb: *x\n", "made.yaml")["b"].size(), 2u);
}

// A file may be cut anywhere.
TEST(LoadYaml, EachCutOfATextEnds) {
  const std::string whole = "a: [b:\n, 'c:]', {d: [e: 1]}]\nf: {g: \"h:\"}\n";
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    for (const char* const end : {"", "]", "}", ":", "\n"}) {
      try {
        loadYaml(whole.substr(0, length) + end, "made.yaml");
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find("made.yaml:"), 0u);
      }
    }
  }
}

}  // namespace
}  // namespace polyfly
