// One rule of decimal numbers: the same text is the same number in every reader.
#include "polyfly_base/decimal.hpp"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "error_of.hpp"
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

// As logs have them.
TEST(Decimal, NumbersOfLogsMayHaveZerosInFrontAndNames) {
  EXPECT_EQ(numberOf("-007.50"), -7.5);
  EXPECT_EQ(numberOf("1e-320"), 1e-320);
  EXPECT_EQ(numberOf("-INF"), -std::numeric_limits<double>::infinity());
  ASSERT_TRUE(numberOf("NaN"));
  EXPECT_TRUE(std::isnan(*numberOf("NaN")));
  for (const char* const text : {"", "0x8", "+-1", "1e", " 8", "8 ", "8u", "nano", "1e999", "1,5", "true"})
    EXPECT_EQ(numberOf(text), std::nullopt) << text;
}

// The texts are those of std::to_chars.
TEST(Decimal, ShortestTextIsThatOfTheStandard) {
  const std::vector<std::pair<double, std::string>> known = {
      {0.0, "0"},
      {-0.0, "-0"},
      {-3.0, "-3"},
      {1.0 / 3.0, "0.3333333333333333"},
      {1e5, "1e+05"},
      {123456.0, "123456"},
      {100000.5, "100000.5"},
      {1e-4, "1e-04"},
      {0.00012, "0.00012"},
      {1e23, "1e+23"},
      {5e-324, "5e-324"},
      {1.7976931348623157e308, "1.7976931348623157e+308"},
      {std::ldexp(1.0, -44), "5.684341886080802e-14"},
      {std::ldexp(1.0, 70), "1180591620717411303424"},
      {-std::numeric_limits<double>::infinity(), "-inf"}};
  for (const auto& [value, text] : known) EXPECT_EQ(shortestText(value), text);
  EXPECT_EQ(shortestText(0.1F), "0.1");
  EXPECT_EQ(shortestText(1.0F / 3.0F), "0.33333334");
  EXPECT_EQ(shortestText(16777216.0F), "16777216");
  EXPECT_EQ(shortestText(1e-45F), "1e-45");
}

TEST(Decimal, ShortestTextIsReadAsTheNumber) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = random();
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    EXPECT_EQ(numberOf(shortestText(value)), value);
  }
}

// A comma is the point of these languages, where the machine has one of them.
TEST(Decimal, LocaleChangesNothing) {
  for (const char* const name : {"de_DE.UTF-8", "fr_FR.UTF-8", "ps_AF.UTF-8"}) {
    if (std::setlocale(LC_ALL, name) == nullptr) continue;
    EXPECT_EQ(shortestText(-1234.5), "-1234.5") << name;
    EXPECT_EQ(shortestText(6.25e-300), "6.25e-300") << name;
    EXPECT_EQ(numberOf("1234.5"), 1234.5) << name;
  }
  std::setlocale(LC_ALL, "C");
}

std::string refusalOf(const std::string& text) {
  return errorOf([&] { YamlField::parse("n: " + text + "\n", "made").at("n").integer(1, 20); });
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
  return errorOf([&] {
    OptionsFromYaml reader(text, "made");
    reader("group/whole", whole, "", Range{0.0, 20.0});
    reader("group/real", real, "", Range{0.0, 20.0});
    reader("group/list", list);
  });
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
  EXPECT_NE(refusalOfOption("group: {whole: 1e30}"), "no error");
}

}  // namespace
}  // namespace polyfly
