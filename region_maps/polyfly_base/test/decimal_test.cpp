// One rule of decimal numbers: the same text is the same number in every reader.
#include "polyfly_base/decimal.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "polyfly_base/error.hpp"
#include "polyfly_base/options_from_yaml.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {
namespace {

TEST(Decimal, NumbersAreReadAsTheyAreWritten) {
  EXPECT_EQ(decimalNumber("8"), 8.0);
  EXPECT_EQ(decimalNumber("8.0"), 8.0);
  EXPECT_EQ(decimalNumber("-0.25"), -0.25);
  EXPECT_EQ(decimalNumber("+.5"), 0.5);
  EXPECT_EQ(decimalNumber("5."), 5.0);
  EXPECT_EQ(decimalNumber("0"), 0.0);
  EXPECT_EQ(decimalNumber("0e0"), 0.0);
  EXPECT_EQ(decimalNumber("1e06"), 1e6);
  EXPECT_EQ(decimalNumber("2.5E-3"), 2.5e-3);
}

TEST(Decimal, WhatReadersDisagreeOnIsNone) {
  for (const char* const text :
       {"",      "010",  "08",  "-010", "00",   "00.5", "01e2",  "0x8", "0X1p3", "0o10",  "0b1",
        "1_000", "1:30", ".",   "-",    "+-1",  "1e",   "1e+",   "e5",  ".e5",   "1.2.3", " 8",
        "8 ",    "8u",   "nan", "inf",  ".inf", ".nan", "1e999", "1,5", "true"})
    EXPECT_EQ(decimalNumber(text), std::nullopt) << text;
}

std::string refusalOf(const std::string& text) {
  try {
    YamlField::parse("n: " + text + "\n", "made").at("n").integer(1, 20);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Decimal, YamlFieldsKeepTheRule) {
  EXPECT_EQ(YamlField::parse("n: 8.0\n", "made").at("n").integer(1, 20), 8);
  for (const char* const text : {"010", "08", "0x8", "0o10"})
    EXPECT_EQ(refusalOf(text), "made:1: n: must be a finite number, got '" + std::string(text) +
                                   "' (decimal digits, without leading zeros)");
}

std::string refusalOfOption(const std::string& text) {
  int whole = 0;
  double real = 0.0;
  std::vector<double> list;
  try {
    OptionsFromYaml reader(text, "made");
    reader("group/whole", whole, "", Range{0.0, 20.0});
    reader("group/real", real, "", Range{0.0, 20.0});
    reader("group/list", list);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Decimal, OptionsOfNodesKeepTheRule) {
  int whole = 0;
  OptionsFromYaml("group: {whole: 8.0}", "made")("group/whole", whole, "", Range{0.0, 20.0});
  EXPECT_EQ(whole, 8);
  for (const char* const key : {"whole: ", "real: ", "list: "}) {
    const bool is_list = key[0] == 'l';
    for (const char* const number : {"010", "08", "0x8", "'8'", ".inf"}) {
      const std::string value = is_list ? std::string("[1, ") + number + "]" : number;
      EXPECT_NE(refusalOfOption("group: {" + (key + value) + "}").find("leading zeros"), std::string::npos)
          << key << value;
    }
  }
  EXPECT_NE(refusalOfOption("group: {whole: 8.5}").find("must be a whole number"), std::string::npos);
  EXPECT_NE(refusalOfOption("group: {whole: 1e30}"), "");
}

}  // namespace
}  // namespace polyfly
