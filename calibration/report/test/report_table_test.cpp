#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <limits>

#include "report/yaml.hpp"

namespace polyfly {
namespace {

using Rule = ReportColumn::Rule;

const Json kAxes = {{{"axis", "x"}, {"faults", 0}, {"use", {{"least", 0.12345}}}, {"supported", true}},
                    {{"axis", "y"}, {"faults", 2}, {"use", {{"least", nullptr}}}, {"supported", true}},
                    {{"axis", "z"}, {"faults", 0}, {"supported", false}}};

TEST(ReportTable, ShowsFieldsOfObjectsAndMarksFaults) {
  const ReportTable table = tableOf(kAxes, {{"axis", "/axis"},
                                            {"faults", "/faults", Rule::kZero},
                                            {"least", "/use/least"},
                                            {"supported", "/supported", Rule::kTrue}});
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_EQ(table.rows[0].cells, (std::vector<std::string>{"x", "0", "0.123", "yes"}));
  EXPECT_TRUE(table.rows[0].good);
  EXPECT_FALSE(table.rows[1].good);
  EXPECT_FALSE(table.rows[2].good);
  // What is not there is a dash, and no fault is read into it.
  EXPECT_EQ(table.rows[2].cells[2], "–");
}

TEST(ReportTable, AcrossHasOneColumnForEachObject) {
  const ReportTable table =
      tableAcross(kAxes, "/axis", {{"faults", "/faults", Rule::kZero}, {"least", "/use/least"}});
  EXPECT_EQ(table.columns, (std::vector<std::string>{"", "x", "y", "z"}));
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].cells, (std::vector<std::string>{"faults", "0", "2", "0"}));
  EXPECT_FALSE(table.rows[0].good);
  EXPECT_TRUE(table.rows[1].good);
}

TEST(ReportTable, AFaultThatIsNotKnownIsNoGoodRow) {
  const Json rows = Json::parse("[{\"axis\": \"x\"}]");
  EXPECT_FALSE(tableOf(rows, {{"faults", "/faults", Rule::kZero}}).rows[0].good);
  EXPECT_FALSE(tableOf(rows, {{"supported", "/supported", Rule::kTrue}}).rows[0].good);
}

TEST(ReportText, IsGreenOnlyWhereTheVerdictIsGood) {
  Report report;
  report.title = "<Title>";
  report.verdict = "Doubtful";
  report.reasons = {"a & b"};
  report.sections = {{"Numbers", {"A sentence."}, {}, tableOf(kAxes, {{"axis", "/axis"}})}};
  const std::string page = toHtml(report);
  EXPECT_EQ(page.find("verdict good"), std::string::npos);
  EXPECT_NE(page.find("&lt;Title&gt;"), std::string::npos);
  EXPECT_NE(page.find("<li>a &amp; b</li>"), std::string::npos);
  const std::string text = toText(report);
  EXPECT_LT(text.find("A sentence."), text.find("Doubtful\n  - a & b"));
  report.good = true;
  EXPECT_NE(toHtml(report).find("verdict good"), std::string::npos);
}

TEST(Yaml, ReadsBackAsTheSameNumbers) {
  const Json json = {
      {"text", "a: \"b\" # c"},
      {"nothing", nullptr},
      {"windows", {{1.5, 2.0}, {3.0, 4.25}}},
      {"sentences", {"one", "two: three"}},
      {"none", Json::array()},
      {"unknown", std::numeric_limits<double>::quiet_NaN()},
      {"axes", {{"roll", {{"gain", 1.0332}, {"supported", true}}}}},
      {"flights", {{{"file", "a.bag"}, {"left_out", {{{"from", 1}, {"to", 2}}}}}, {{"file", "b.bag"}}}}};
  const std::string text = yamlText(json);
  const YAML::Node yaml = YAML::Load(text);
  EXPECT_EQ(yaml["text"].as<std::string>(), "a: \"b\" # c") << text;
  EXPECT_TRUE(yaml["nothing"].IsNull());
  EXPECT_EQ(yaml["windows"][1][1].as<double>(), 4.25);
  EXPECT_EQ(yaml["sentences"][1].as<std::string>(), "two: three");
  EXPECT_EQ(yaml["none"].size(), 0u);
  EXPECT_TRUE(std::isnan(yaml["unknown"].as<double>()));
  EXPECT_EQ(yaml["axes"]["roll"]["gain"].as<double>(), 1.0332);
  EXPECT_TRUE(yaml["axes"]["roll"]["supported"].as<bool>());
  EXPECT_EQ(yaml["flights"][0]["left_out"][0]["to"].as<int>(), 2);
  EXPECT_EQ(yaml["flights"][1]["file"].as<std::string>(), "b.bag");
  EXPECT_NE(text.find("windows: [[1.5, 2], [3, 4.25]]\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace polyfly
