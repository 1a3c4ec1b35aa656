// What a bag tells of the parameters in force, against the maps and options of the validation.
#include "validation/parameters_told.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "polyfly_base/error.hpp"
#include "polyfly_base/options_text.hpp"
#include "polyfly_base/provenance.hpp"
#include "polyfly_base/version.hpp"
#include "region_maps/region_map.hpp"
#include "synthetic_flight.hpp"
#include "validation/report.hpp"
#include "validation/validation.hpp"

namespace polyfly {
namespace {

class ParametersToldTest : public testing::Test {
 protected:
  // The text of a node with these options; `problem` is the checksum of the lateral axis' problem, if it is another.
  std::string text(const MultirotorOptions& options, const std::string& change,
                   const std::string& problem = "", const std::string& law = "explicit_linear",
                   const std::string& version = kVersion) const {
    constexpr const char* kNames[] = {"longitudinal", "lateral", "vertical"};
    OptionsText out;
    out.text("in_force/node", "/firefly/controller");
    out.text("in_force/version", version);
    out.text("in_force/vehicle", "multirotor");
    out.text("in_force/change", change);
    out.text("in_force/law", law);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string space = std::string("in_force/maps/") + kNames[axis];
      out.text(space + "/name", "made");
      out.text(space + "/checksum", "0123456789abcdef");
      const std::string own = checksumOf(std::string(maps_.axes()[axis]->problemText()));
      out.text(space + "/problem", axis == 1 && !problem.empty() ? problem : own);
      if (axis == 1)
        out.text(space + "/calibration", "attitude from roll.yaml (xxh64:7) of may.bag (2026-05-01)");
    }
    out.text("law", law);
    out.text("provenance", "vehicle/mass from mass.yaml (xxh64:1) of hover.bag (xxh64:2, 2026-01-02)");
    visitOptions(options, out);
    return out.yaml();
  }

  // A flight in which these texts were told, at times from the first odometry on.
  FlightLog flight(const std::vector<std::pair<double, std::string>>& told) const {
    FlightLog log = syntheticFlight(maps_.axes(), flown_);
    log.clocks = {{"odometry", {}, SyntheticFlight::kStart},
                  {"command", {}, SyntheticFlight::kStart + 0.002}};
    for (const auto& [time, one] : told) log.parameters.push_back({SyntheticFlight::kStart + time, one});
    return log;
  }

  ValidationReport judged(const FlightLog& log, const MultirotorOptions& options) const {
    return validate(log, replay(log, maps_.axes(), options), maps_.axes(), options);
  }

  static std::string joined(const std::vector<std::string>& sentences) {
    std::string all;
    for (const std::string& one : sentences) all += one + "\n";
    return all;
  }

  ScratchFolder folder_;
  HandMadeMaps maps_{folder_};
  MultirotorOptions flown_;
};

TEST_F(ParametersToldTest, AFlightWithoutThemIsJudgedAsBefore) {
  EXPECT_FALSE(parametersTold(syntheticFlight(maps_.axes())).has_value());
}

TEST_F(ParametersToldTest, TheOptionsInForceReplayTheFlight) {
  flown_.mass = 1.7;
  flown_.yaw_gain = 2.345678901234;
  const FlightLog log = flight({{-1.0, text(flown_, "start")}});
  const auto told = parametersTold(log);
  ASSERT_TRUE(told.has_value());
  EXPECT_EQ(told->node, "/firefly/controller");
  EXPECT_EQ(told->law, "explicit_linear");
  EXPECT_EQ(told->axes[1].calibration, "attitude from roll.yaml (xxh64:7) of may.bag (2026-05-01)");
  EXPECT_TRUE(told->changes.empty());
  const MultirotorOptions options = optionsInForce(*told);
  EXPECT_EQ(options.mass, flown_.mass);
  EXPECT_EQ(options.yaw_gain, flown_.yaw_gain);
  const ValidationReport report = judged(log, options);
  EXPECT_EQ(report.commands.max_difference, 0.0);
  EXPECT_TRUE(report.warnings.empty()) << joined(report.warnings);
}

TEST_F(ParametersToldTest, OptionsThatAreRemovedByNowAreReadOver) {
  const std::string old = "controller:\n  coupling_drift: 0.005\n  descend_thrust: 0.95\n  yaw_gain: 2.0\n";
  const auto told = parametersTold(flight({{-1.0, old}}));
  ASSERT_TRUE(told.has_value());
  EXPECT_EQ(optionsInForce(*told).yaw_gain, 2.0);
}

TEST_F(ParametersToldTest, OtherOptionsAreNamed) {
  flown_.mass = 1.7;
  const std::string sentences = joined(judged(flight({{-1.0, text(flown_, "start")}}), {}).warnings);
  EXPECT_NE(sentences.find("The options are not those that were in force: vehicle/mass 1.52 (in force 1.7)."),
            std::string::npos)
      << sentences;
}

TEST_F(ParametersToldTest, AnotherProblemIsNamedWithItsCalibration) {
  const FlightLog log = flight({{-1.0, text(flown_, "start", "xxh64:00000000000000ff")}});
  const std::string sentences = joined(judged(log, flown_).warnings);
  EXPECT_NE(sentences.find("The lateral axis flew another problem than that of " + maps_.path(1)),
            std::string::npos)
      << sentences;
  EXPECT_NE(sentences.find("problem xxh64:00000000000000ff, calibrated: attitude from roll.yaml"),
            std::string::npos)
      << sentences;
  EXPECT_NE(sentences.find(", not calibrated."), std::string::npos) << sentences;
  EXPECT_EQ(sentences.find("longitudinal"), std::string::npos) << sentences;
}

TEST_F(ParametersToldTest, ALawWithoutMapsIsNamed) {
  const FlightLog log = flight({{-1.0, text(flown_, "start", "", "nonlinear")}});
  EXPECT_NE(joined(judged(log, flown_).warnings).find("the law nonlinear, which looks nothing up"),
            std::string::npos);
}

TEST_F(ParametersToldTest, ChangesHaveTheirTimeAndDecideOnlyWhereTheReplayDependsOnThem) {
  MultirotorOptions heavy = flown_;
  heavy.mass = 1.6;
  // What changed before the first command is the start.
  FlightLog log = flight(
      {{-9.0, text(heavy, "start")}, {-1.0, text(flown_, "reconfigure")}, {4.5, text(heavy, "reconfigure")}});
  ValidationReport report = judged(log, flown_);
  ASSERT_EQ(report.parameters->changes.size(), 1u);
  const ParametersTold::Change& change = report.parameters->changes[0];
  EXPECT_NEAR(change.time, 4.5, 1e-9);
  EXPECT_EQ(change.parameters, std::vector<std::string>{"vehicle/mass: 1.52 -> 1.6"});
  EXPECT_NE(
      joined(report.warnings).find("changed in flight at 4.5 s (reconfigure): vehicle/mass: 1.52 -> 1.6"),
      std::string::npos)
      << joined(report.warnings);
  EXPECT_NE(toText(reportOn(report)).find("reconfigure  vehicle/mass: 1.52 -> 1.6"), std::string::npos);
  const Json json = jsonOf(report)["parameters"];
  EXPECT_EQ(json["changes"][0]["cause"], "reconfigure");
  EXPECT_EQ(json["axes"][1]["map_checksum"], "0123456789abcdef");
  // The gain of another law bears on no replay.
  log = flight({{-1.0, text(flown_, "start") + "nonlinear:\n  roll_gain: 0.8\n"},
                {4.5, text(flown_, "reconfigure") + "nonlinear:\n  roll_gain: 0.9\n"}});
  report = judged(log, flown_);
  ASSERT_EQ(report.parameters->changes.size(), 1u);
  EXPECT_FALSE(report.parameters->changes[0].bears_on_replay);
  EXPECT_TRUE(report.warnings.empty()) << joined(report.warnings);
}

TEST_F(ParametersToldTest, ThePageShowsThem) {
  const FlightLog log = flight({{-1.0, text(flown_, "start")}});
  const auto samples = replay(log, maps_.axes(), flown_);
  const ValidationReport report = validate(log, samples, maps_.axes(), flown_);
  const std::string page = toHtml(reportOn({log, samples, maps_.axes(), flown_, report}));
  for (const char* words : {"Parameters in force", "mass.yaml (xxh64:1) of hover.bag", "0123456789abcdef",
                            "attitude from roll.yaml (xxh64:7) of may.bag (2026-05-01)", "Nothing changed"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
}

// What the estimators of another version made of the odometry is not at hand; its parameters are looked up again.
TEST_F(ParametersToldTest, OfAnotherVersionTheRecordedParametersAreLookedUpAgain) {
  FlightLog log = flight({{-1.0, text(flown_, "start", "", "explicit_linear", "0.1.0")}});
  // Commands that this version would not give, and parameters that it would not assemble.
  for (FlightLog::Command& command : log.commands) command.command.roll += 0.01;
  std::vector<double>& theta = log.statuses[500].theta[1];
  theta[1] += 1e-3;
  std::vector<double> input(1);
  maps_.axes()[1]->evaluate(theta.data(), input.data());
  log.statuses[500].input[1] = input[0];
  const ValidationReport report = judged(log, flown_);
  EXPECT_TRUE(brokenThresholds(report, {}).empty()) << joined(brokenThresholds(report, {}));
  EXPECT_EQ(report.verdict(), Verdict::kDoubtful);
  EXPECT_NE(joined(report.warnings).find("Another version flew"), std::string::npos);
  EXPECT_EQ(report.tracked_samples, SyntheticFlight::kSamples);
  EXPECT_EQ(report.coverage, 1.0);
  EXPECT_EQ(report.commands.compared, 0u);
  EXPECT_EQ(jsonOf(report)["incomparable"][0]["cause"], "other_version");
  log.statuses[500].input[1] += 2e-9;
  const auto broken = brokenThresholds(judged(log, flown_), {});
  ASSERT_EQ(broken.size(), 1u);
  EXPECT_EQ(broken[0].find("difference of the recorded inputs to the maps' laws"), 0u);
}

TEST_F(ParametersToldTest, RefusesATextThatIsNone) {
  EXPECT_THROW(parametersTold(flight({{-1.0, "a: [\n"}})), Error);
  EXPECT_THROW(parametersTold(flight({{-1.0, "7\n"}})), Error);
  const auto told = parametersTold(flight({{-1.0, "vehicle: {mass: -1}\nin_force: {node: /a}\n"}}));
  EXPECT_THROW(optionsInForce(*told), Error);
}

}  // namespace
}  // namespace polyfly
