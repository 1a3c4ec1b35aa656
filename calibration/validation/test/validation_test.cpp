#include "validation/validation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "region_maps/write_map.hpp"
#include "synthetic_flight.hpp"

namespace polyfly {
namespace {

constexpr double kSolverAgreement = 1e-9;  // between the law made by hand and the online QP [rad or m/s^2]
constexpr double kRounding = 1e-12;
const double kNaN = std::numeric_limits<double>::quiet_NaN();

class Validation : public testing::Test {
 protected:
  ValidationReport validated(const FlightLog& log) {
    return validate(log, replay(log, maps_.axes(), options_), maps_.axes(), options_);
  }

  ScratchFolder folder_;
  HandMadeMaps maps_{folder_};
  MultirotorOptions options_;
};

TEST_F(Validation, findsWhatTheFlightWasMadeOf) {
  const ValidationReport report = validated(syntheticFlight(maps_.axes()));
  EXPECT_EQ(report.samples, SyntheticFlight::kSamples);
  EXPECT_EQ(report.tracked_samples, SyntheticFlight::kSamples);
  EXPECT_EQ(report.coverage, 1.0);
  EXPECT_EQ(report.outside_map_samples, 0u);
  EXPECT_EQ(report.violationCount(), 0u);
  EXPECT_EQ(report.regionCount(), 6u);
  EXPECT_EQ(report.visitedCount(), 6u);  // each axis swings to both sides of 0
  EXPECT_NEAR(report.duration, 9.99, 1e-9);
  double squares = 0.0;
  double greatest = 0.0;
  for (std::size_t sample = 0; sample < SyntheticFlight::kSamples; ++sample) {
    const double error = SyntheticFlight::error(sample).norm();
    squares += error * error;
    greatest = std::max(greatest, error);
  }
  EXPECT_NEAR(report.tracking.rms, std::sqrt(squares / SyntheticFlight::kSamples), kRounding);
  EXPECT_NEAR(report.tracking.max, greatest, kRounding);
  for (const AxisValidation& axis : report.axes) {
    EXPECT_EQ(axis.qp_compared, SyntheticFlight::kSamples);
    EXPECT_EQ(axis.qp_failures, 0u);
    EXPECT_LT(axis.qp.max, kSolverAgreement);
    EXPECT_GT(axis.lookup_ns.p50, 0.0);
  }
  ASSERT_TRUE(report.hold.has_value());
  EXPECT_LT((report.hold->offset - SyntheticFlight::restingError()).norm(), kRounding);
  EXPECT_TRUE(brokenThresholds(report, {}).empty());
}

TEST_F(Validation, countsSamplesOutsideByTheirParameter) {
  options_.jump_distance = 0.0;  // it is far away from one sample to the next
  options_.solve_outside = false;
  FlightRecorder recorder(maps_.axes(), options_);
  recorder.hold(SyntheticFlight::home());
  constexpr std::size_t kAway = 7;
  for (std::size_t sample = 0; sample < 100; ++sample) {
    const bool away = sample >= 40 && sample < 40 + kAway;
    recorder.fly(SyntheticFlight::state(sample, {away ? 2.0 : 0.0, 0.0, 0.0}));
  }
  const ValidationReport report = validated(recorder.log());
  EXPECT_EQ(report.outside_map_samples, kAway);
  EXPECT_NEAR(report.outside_map_time, 0.01 * static_cast<double>(kAway), 1e-6);
  EXPECT_NEAR(report.coverage, 0.93, kRounding);
  EXPECT_EQ(report.axes[0].outside_box, kAway);
  EXPECT_EQ(report.axes[0].inside, 100 - kAway);
  EXPECT_EQ(report.axes[0].qp_compared, 100 - kAway);
  EXPECT_EQ(report.axes[1].inside, 100u);
  ASSERT_EQ(report.axes[0].parameters[0].name, "e_p_x");
  EXPECT_EQ(report.axes[0].parameters[0].outside, kAway);
  EXPECT_GT(report.axes[0].parameters[0].greatest, 1.9);
  const ParameterUse& away = report.axes[0].parameters[0];
  EXPECT_LT(away.margin(), 0.0);
  EXPECT_GT(away.proposedRange().second, away.greatest);
  EXPECT_EQ(away.proposedRange().first, away.lower);
  for (const AxisValidation& axis : report.axes) {
    EXPECT_EQ(axis.neverVisited().size() + axis.visited(), axis.regions());
    for (const ParameterUse& use : axis.parameters) {
      EXPECT_LE(use.proposedRange().first, use.lower);
      EXPECT_GE(use.proposedRange().second, use.upper);
    }
  }
  EXPECT_EQ(report.statuses.replayed[static_cast<std::size_t>(ControlStatus::kClipped)], kAway);
  const auto broken = brokenThresholds(report, {});
  ASSERT_EQ(broken.size(), 1u);
  EXPECT_EQ(broken[0], "coverage is 0.93, must be at least 0.99");
  EXPECT_NE(toText(reportOn(report)).find("outside_box  e_p_x"), std::string::npos)
      << toText(reportOn(report));
}

// Solved online the status is OPTIMAL: the map is left all the same.
TEST_F(Validation, countsWhatWasSolvedBesideTheMapAsOutside) {
  options_.jump_distance = 0.0;
  FlightRecorder recorder(maps_.axes(), options_);
  recorder.hold(SyntheticFlight::home());
  constexpr std::size_t kAway = 7;
  for (std::size_t sample = 0; sample < 100; ++sample) {
    const bool away = sample >= 40 && sample < 40 + kAway;
    recorder.fly(SyntheticFlight::state(sample, {away ? 2.0 : 0.0, 0.0, 0.0}));
  }
  const ValidationReport report = validated(recorder.log());
  EXPECT_EQ(report.statuses.replayed[static_cast<std::size_t>(ControlStatus::kOptimal)], 100u);
  EXPECT_EQ(report.outside_map_samples, kAway);
  EXPECT_NEAR(report.outside_map_time, 0.01 * static_cast<double>(kAway), 1e-6);
  EXPECT_EQ(report.axes[0].outside_box, kAway);
  ASSERT_EQ(report.axes[0].excursions.size(), 1u);
  EXPECT_EQ(report.axes[0].excursions[0].samples, kAway);
  EXPECT_EQ(brokenThresholds(report, {}).size(), 1u);
}

TEST_F(Validation, countsNaNOdometryAsOutside) {
  FlightRecorder recorder(maps_.axes(), options_);
  recorder.hold(SyntheticFlight::home());
  for (std::size_t sample = 0; sample < 50; ++sample) {
    recorder.fly(SyntheticFlight::state(sample, {sample == 20 ? kNaN : 0.0, 0.0, 0.0}));
  }
  const ValidationReport report = validated(recorder.log());
  EXPECT_EQ(report.axes[0].not_finite, 1u);
  EXPECT_EQ(report.outside_map_samples, 1u);
  EXPECT_EQ(report.statuses.replayed[static_cast<std::size_t>(ControlStatus::kHoldLast)], 1u);
}

TEST_F(Validation, seesACommandThatWasAltered) {
  FlightLog log = syntheticFlight(maps_.axes());
  log.commands[123].command.pitch += 0.01;
  const ValidationReport report = validated(log);
  EXPECT_NEAR(report.commands.difference[1].max, 0.01, kRounding);
  EXPECT_EQ(report.commands.difference[1].stamp, log.commands[123].stamp);
  EXPECT_NEAR(report.commands.difference[1].rms, 0.01 / std::sqrt(1000.0), kRounding);
  EXPECT_EQ(report.commands.difference[0].max, 0.0);
  EXPECT_EQ(brokenThresholds(report, {}).size(), 1u);
}

// The controller's status tells that it answered another odometry than the record holds.
TEST_F(Validation, doesNotJudgeByOdometryThatWasAltered) {
  for (const bool finite : {true, false}) {
    FlightLog log = syntheticFlight(maps_.axes());
    log.odometry[123].position.x() += finite ? 0.3 : kNaN;
    const ValidationReport report = validated(log);
    ASSERT_EQ(report.incomparable.size(), 1u);
    EXPECT_EQ(report.incomparable[0].from, log.odometry[123].stamp);
    EXPECT_EQ(report.commands.compared + report.incomparable[0].samples, SyntheticFlight::kSamples);
    EXPECT_EQ(report.tracked_samples, SyntheticFlight::kSamples - 1);
    EXPECT_LT(report.tracking.max, 0.2);
    EXPECT_TRUE(brokenThresholds(report, {}).empty());
    EXPECT_EQ(report.verdict(), Verdict::kDoubtful);
    EXPECT_FALSE(report.isWhole());
    // The command itself is judged all the same.
    log.commands[123].command.roll = 2.0;
    EXPECT_EQ(brokenThresholds(validated(log), {}).size(), 1u);
    log = syntheticFlight(maps_.axes());
    log.odometry[123].position.x() += finite ? 0.3 : kNaN;
    log.statuses.clear();
    EXPECT_FALSE(brokenThresholds(validated(log), {}).empty());
  }
}

// Both topics lack a second, or the odometry alone, and the replay does not know how the flight went on.
TEST_F(Validation, doesNotCompareBehindAHole) {
  const FlightLog whole = syntheticFlight(maps_.axes());
  for (const bool told : {true, false}) {
    for (const bool all : {true, false}) {
      FlightLog log;
      log.add(whole.references[0].trajectory, std::nullopt);
      for (std::size_t sample = 0; sample < SyntheticFlight::kSamples; ++sample) {
        const bool lost = sample >= 200 && sample < 300;
        if (!lost) log.add(whole.odometry[sample]);
        if (lost && all) continue;
        log.commands.push_back(whole.commands[sample]);
        if (told) log.statuses.push_back(whole.statuses[sample]);
      }
      const ValidationReport report = validated(log);
      EXPECT_TRUE(brokenThresholds(report, {}).empty());
      EXPECT_EQ(report.verdict(), Verdict::kDoubtful);
      ASSERT_EQ(report.incomparable.size(), 1u);
      EXPECT_EQ(report.incomparable[0].from, whole.odometry[199].stamp);
      EXPECT_GE(report.commands.compared, 200u);
      EXPECT_EQ(report.commands.unmatched, all ? 0u : 100u);
      const std::string text = toText(reportOn(report));
      EXPECT_EQ(text.find("Nothing is recorded from 1.99 to 3 s") != std::string::npos, all) << text;
      EXPECT_NE(text.find("are not compared, from 1.99 to "), std::string::npos) << text;
      // What was wrong before the hole stays wrong.
      log.commands[100].command.roll += 0.01;
      EXPECT_EQ(brokenThresholds(validated(log), {}).size(), 1u);
    }
  }
}

TEST_F(Validation, doesNotCompareWhereTheRecordingBeginsInFlight) {
  const FlightLog whole = syntheticFlight(maps_.axes());
  FlightLog log;
  log.add(whole.references[0].trajectory, std::nullopt);
  for (std::size_t sample = 300; sample < SyntheticFlight::kSamples; ++sample) {
    log.add(whole.odometry[sample]);
    log.commands.push_back(whole.commands[sample]);
    log.statuses.push_back(whole.statuses[sample]);
  }
  const ValidationReport report = validated(log);
  EXPECT_EQ(report.verdict(), Verdict::kDoubtful);
  EXPECT_TRUE(brokenThresholds(report, {}).empty());
  EXPECT_NE(toText(reportOn(report)).find("The recording begins in flight"), std::string::npos);
  // The same of a controller that had sent nothing before is a flight of another one.
  for (FlightLog::Status& status : log.statuses) status.sequence = 0;
  EXPECT_FALSE(brokenThresholds(validated(log), {}).empty());
}

TEST_F(Validation, countsCommandsOutOfBounds) {
  FlightLog log = syntheticFlight(maps_.axes());
  log.commands[1].command.roll = options_.angle_max + 1e-6;
  log.commands[2].command.pitch = -options_.angle_max - 1e-6;
  log.commands[3].command.thrust = options_.mass * options_.thrust_max + 1e-6;
  log.commands[4].command.thrust = options_.mass * options_.thrust_min - 1e-6;
  log.commands[5].command.yaw_rate = 2.0;
  log.commands[6].command.roll = options_.angle_max;  // on the bound is within
  const ValidationReport report = validated(log);
  EXPECT_EQ(report.commands.angle_violations, 2u);
  EXPECT_EQ(report.commands.thrust_violations, 2u);
  EXPECT_EQ(report.commands.yaw_rate_violations, 1u);
  EXPECT_EQ(report.violationCount(), 5u);
}

TEST_F(Validation, neverHidesANaNCommand) {
  FlightLog log = syntheticFlight(maps_.axes());
  log.commands[3].command.roll = kNaN;
  const ValidationReport report = validated(log);
  EXPECT_EQ(report.commands.not_finite, 1u);
  EXPECT_TRUE(std::isnan(report.commands.max_difference));
  EXPECT_EQ(brokenThresholds(report, {}).size(), 2u);
}

TEST_F(Validation, seesALawThatIsWrong) {
  MapContent content = handMadeMap(1);
  content.laws.back() += 1e-3;
  writeMap(content, folder_ / "wrong.map");
  const RegionMap wrong = RegionMap::open(folder_ / "wrong.map");
  AxisMaps axes = maps_.axes();
  axes[1] = &wrong;
  const FlightLog log = syntheticFlight(axes);
  const ValidationReport report = validate(log, replay(log, axes, options_), axes, options_);
  EXPECT_NEAR(report.maxQpDifference(), 1e-3, kSolverAgreement);
  EXPECT_LT(report.axes[0].qp.max, kSolverAgreement);
  EXPECT_EQ(brokenThresholds(report, {}).size(), 1u);
}

TEST_F(Validation, seesAStatusThatDiffers) {
  FlightLog log = syntheticFlight(maps_.axes());
  log.statuses[5].region[2] = 1 - log.statuses[5].region[2];
  log.statuses[9].theta[0][1] += 0.25;
  const ValidationReport report = validated(log);
  EXPECT_EQ(report.statuses.differing, 1u);
  EXPECT_NEAR(report.statuses.max_theta_difference, 0.25, kRounding);
}

TEST_F(Validation, saysWhenTheReferenceNeverRests) {
  FlightLog log;
  std::vector<TrajectorySample> points;
  for (int index = 0; index < 20; ++index) {
    TrajectorySample point;
    point.time = index;
    point.position.x() = index;
    points.push_back(point);
  }
  log.add(ReferenceTrajectory(points), SyntheticFlight::kStart);
  for (std::size_t sample = 0; sample < 500; ++sample) log.add(SyntheticFlight::state(sample));
  EXPECT_FALSE(validated(log).hold.has_value());
}

TEST_F(Validation, judgesAnEmptyLogAsBroken) {
  const ValidationReport report = validated(FlightLog{});
  EXPECT_EQ(report.coverage, 0.0);
  EXPECT_GE(brokenThresholds(report, {}).size(), 3u);
  EXPECT_NO_THROW(toText(reportOn(report)));
  EXPECT_TRUE(Json::accept(dumped(jsonOf(report))));
}

TEST_F(Validation, jsonHoldsTheNumbersOfTheSummary) {
  const ValidationReport report = validated(syntheticFlight(maps_.axes()));
  const Json json = jsonOf(report);
  for (const char* key :
       {"regions", "tracking_rms_m", "constraint_violations", "coverage", "max_qp_difference",
        "lookup_ns_p50", "lookup_ns_p99", "outside_map_samples", "max_command_difference"}) {
    ASSERT_TRUE(json.contains(key)) << key;
    EXPECT_TRUE(json[key].is_number()) << key;
  }
  EXPECT_EQ(json["regions"], 6);
  EXPECT_EQ(json["coverage"], 1.0);
  EXPECT_DOUBLE_EQ(json["tracking_rms_m"].get<double>(), report.tracking.rms);
  EXPECT_EQ(json["axes"].size(), 3u);
  EXPECT_EQ(json["axes"][1]["axis"], "lateral");
  EXPECT_EQ(json["status"]["recorded"]["optimal"], 1000);
}

TEST_F(Validation, eachThresholdBreaksByItself) {
  const ValidationReport good = validated(syntheticFlight(maps_.axes()));
  ASSERT_TRUE(brokenThresholds(good, {}).empty());
  ValidationReport report = good;
  report.coverage = 0.5;
  EXPECT_EQ(brokenThresholds(report, {}).size(), 1u);
  EXPECT_TRUE(brokenThresholds(report, {0.5, 1e-6, 1e-6, 0}).empty());
  report = good;
  report.axes[2].qp.max = kNaN;
  EXPECT_EQ(brokenThresholds(report, {}).size(), 1u);
  report = good;
  report.axes[0].qp_failures = 1;
  EXPECT_EQ(brokenThresholds(report, {}).size(), 1u);
  report = good;
  report.commands.thrust_violations = 2;
  EXPECT_EQ(brokenThresholds(report, {}).size(), 1u);
  EXPECT_TRUE(brokenThresholds(report, {0.99, 1e-6, 1e-6, 2}).empty());
}

TEST(Percentiles, areNearestRanks) {
  std::vector<double> values;
  for (int value = 1; value <= 1000; ++value) values.push_back(value);
  std::shuffle(values.begin(), values.end(), std::mt19937(7));
  const Percentiles result = percentiles(values);
  EXPECT_EQ(result.p50, 500.0);
  EXPECT_EQ(result.p90, 900.0);
  EXPECT_EQ(result.p99, 990.0);
  EXPECT_EQ(result.p999, 999.0);
  EXPECT_EQ(result.max, 1000.0);
  EXPECT_EQ(percentiles({}).max, 0.0);
  EXPECT_EQ(percentiles({3.0}).p50, 3.0);
}

TEST_F(Validation, lookUpsAreTimedAsOftenAsAsked) {
  const std::vector<double> thetas(5 * 100, 0.0);
  EXPECT_EQ(measureLookups(*maps_.axes()[0], thetas, 4, 50).size(), 50u);
  EXPECT_EQ(measureLookups(*maps_.axes()[0], thetas, 4, 1).size(), 26u);  // each parameter at least once
  EXPECT_TRUE(measureLookups(*maps_.axes()[0], {}, 4, 50).empty());
}

}  // namespace
}  // namespace polyfly
