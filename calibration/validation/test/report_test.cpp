#include "validation/report.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "nonlinear_mpc/nonlinear_mpc.hpp"
#include "polyfly_base/error.hpp"
#include "report/yaml.hpp"
#include "synthetic_flight.hpp"
#include "validation/controller_options.hpp"

namespace polyfly {
namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t place = text.find(part); place != std::string::npos; place = text.find(part, place + 1))
    ++count;
  return count;
}

class Report : public testing::Test {
 protected:
  // Writes the report of a log into the scratch folder and returns the page.
  std::string page(const FlightLog& log) {
    const auto samples = replay(log, maps_.axes(), options_);
    ValidationReport validation = validate(log, samples, maps_.axes(), options_);
    validation.broken = brokenThresholds(validation, {});
    writeReport({log, samples, maps_.axes(), options_, validation}, folder_ / "a/report");
    return contents(folder_ / "a/report/index.html");
  }

  ScratchFolder folder_;
  HandMadeMaps maps_{folder_};
  MultirotorOptions options_;
};

TEST_F(Report, isOnePageWithAllPicturesInside) {
  const std::string text = page(syntheticFlight(maps_.axes()));
  EXPECT_EQ(countOf(text, "<svg"), countOf(text, "</svg>"));
  EXPECT_GE(countOf(text, "<svg"), 7u);
  for (const char* heading :
       {"The flight from above", "Tracking error", "Commands and their bounds", "Active region over time",
        "Distance to the map's edge", "Disturbance estimate", "Coverage", "Passed"}) {
    EXPECT_NE(text.find(heading), std::string::npos) << heading;
  }
  for (const char* foreign : {"src=", "<script", "<link", "@import", "url(http"}) {
    EXPECT_EQ(text.find(foreign), std::string::npos) << foreign;
  }
  const auto json = nlohmann::json::parse(contents(folder_ / "a/report/summary.json"));
  EXPECT_EQ(json["regions"], 6);
}

TEST_F(Report, saysWhatFailed) {
  FlightLog log = syntheticFlight(maps_.axes());
  log.commands[3].command.roll = 1.0;
  log.source = "a/folder/<b>flight.bag";
  const std::string text = page(log);
  EXPECT_NE(text.find("Failed"), std::string::npos);
  EXPECT_NE(text.find("number of commands out of bounds is 1"), std::string::npos);
  EXPECT_NE(text.find("&lt;b&gt;flight.bag"), std::string::npos);
  EXPECT_EQ(text.find("<b>flight"), std::string::npos);
  EXPECT_EQ(text.find("a/folder"), std::string::npos);
}

TEST_F(Report, isDoubtfulWhereTheRecordIsNotWhole) {
  FlightLog log = syntheticFlight(maps_.axes());
  log.share = RecordingShare{{645.0, 3001.0}, {22.0, 100.0}, {6.45, 30.0}};
  const std::string text = page(log);
  EXPECT_EQ(text.find("Passed"), std::string::npos);
  EXPECT_EQ(text.find("verdict good"), std::string::npos);
  EXPECT_NE(text.find("Read: 21.4 % of the messages (645 of 3001)"), std::string::npos);
  EXPECT_NE(text.find("Parts of the recording are lost"), std::string::npos);
  const auto json = nlohmann::json::parse(contents(folder_ / "a/report/summary.json"));
  EXPECT_EQ(json["verdict"], "doubtful");
  EXPECT_EQ(json["recording"]["whole"], false);
  EXPECT_EQ(json["recording"]["messages"]["recorded"], 3001.0);
}

TEST_F(Report, isUtf8WhateverTheFileIsCalled) {
  FlightLog log = syntheticFlight(maps_.axes());
  log.source =
      "fl\xfc"
      "ge/fl\xfcg \xc3\xbc.bag";
  const std::string text = page(log);
  EXPECT_EQ(text.find("fl\xfc"), std::string::npos);
  EXPECT_NE(text.find("fl\\xfcg \xc3\xbc.bag"), std::string::npos);
  ValidationReport report;
  report.warnings = {log.source};
  EXPECT_TRUE(nlohmann::json::accept(dumped(jsonOf(report))));
}

TEST(ReportNumbers, areWrittenAsPeopleReadThem) {
  EXPECT_EQ(number(100.4, 2), "100");
  EXPECT_EQ(number(1.034), "1.03");
  EXPECT_EQ(number(99.96), "100");
  EXPECT_EQ(number(12345.6), "12346");
  EXPECT_EQ(number(-0.000123456), "-0.000123");
  EXPECT_EQ(number(1.5e-7, 2), "1.5e-07");
  EXPECT_EQ(number(0.0), "0");
  EXPECT_EQ(number(10.0), "10");
  EXPECT_EQ(number(-1.0 / 0.0), "–");
}

TEST_F(Report, copesWithFlightsThatLackSomething) {
  EXPECT_NE(page(FlightLog{}).find("Failed"), std::string::npos);

  FlightRecorder without_reference(maps_.axes(), options_);
  for (std::size_t sample = 0; sample < 20; ++sample) without_reference.fly(SyntheticFlight::state(sample));
  EXPECT_NE(page(without_reference.log()).find("Failed"), std::string::npos);

  FlightRecorder outside(maps_.axes(), options_);
  outside.hold(SyntheticFlight::home());
  for (std::size_t sample = 0; sample < 20; ++sample)
    outside.fly(SyntheticFlight::state(sample, {9.0, 9.0, 9.0}));
  EXPECT_NE(page(outside.log()).find("coverage is 0"), std::string::npos);

  FlightRecorder single(maps_.axes(), options_);
  single.hold(SyntheticFlight::home());
  single.fly(SyntheticFlight::state(0));
  EXPECT_NE(page(single.log()).find("Passed"), std::string::npos);
}

TEST_F(Report, namesTheFolderThatCannotBeMade) {
  std::ofstream(folder_ / "file") << "in the way";
  const FlightLog log;
  const std::vector<ReplaySample> samples;
  const ValidationReport validation;
  try {
    writeReport({log, samples, maps_.axes(), options_, validation}, folder_ / "file/report");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("file/report: cannot be made"), std::string::npos)
        << error.what();
  }
}

std::string optionsError(const ScratchFolder& folder, const std::string& text) {
  std::ofstream(folder / "options.yaml") << text;
  try {
    loadControllerOptions(folder / "options.yaml");
  } catch (const Error& error) {
    return std::string(error.what()).substr((folder / "").size());
  }
  return "no error";
}

TEST(ControllerOptions, areReadFromTheNodesFile) {
  const ScratchFolder folder;
  std::ofstream(folder / "options.yaml")
      << "vehicle: {mass: 2.5}\ncontroller: {hold_periods: 3, offset_free: false, "
         "stale_periods: 4}\nmaps: {lateral: a.map}\n";
  const MultirotorOptions options = loadControllerOptions(folder / "options.yaml");
  EXPECT_EQ(options.mass, 2.5);
  EXPECT_EQ(options.hold_periods, 3);
  EXPECT_FALSE(options.offset_free);
  EXPECT_EQ(options.yaw_gain, MultirotorOptions{}.yaw_gain);
  EXPECT_EQ(parsePreviewPeriod("nonlinear: {period: 0.05, horizon: 30}\nlaw: linear\n", "text"), 0.05);
  EXPECT_EQ(parsePreviewPeriod("law: linear\n", "text"), NonlinearMpcOptions{}.period);
}

TEST(ControllerOptions, refusesBadFilesByLineAndKey) {
  const ScratchFolder folder;
  EXPECT_EQ(optionsError(folder, "vehicle:\n  mas: 2\n"), "options.yaml:2: vehicle/mas: unknown key");
  EXPECT_EQ(optionsError(folder, "controller:\n  descend_thrust: 0.9\n"),
            "options.yaml:2: controller/descend_thrust: is removed: a descent has 0.95 of the hover thrust");
  EXPECT_EQ(optionsError(folder, "controller: {hold_periods: 3}\nplant: {mass: 2.5}\n"),
            "options.yaml:2: plant: unknown group");
  EXPECT_EQ(optionsError(folder, "law: linear\nKF_observer: {P0_force: 0.1}\nreference_limits: {speed: 5}\n"),
            "no error");
  EXPECT_NE(optionsError(folder, "vehicle: {mass: -1}\n").find("vehicle/mass"), std::string::npos);
}

}  // namespace
}  // namespace polyfly
