#include "validation/replay.hpp"

#include <gtest/gtest.h>

#include <string>

#include "error_of.hpp"
#include "region_maps/write_map.hpp"
#include "synthetic_flight.hpp"
#include "validation/validation.hpp"

namespace polyfly {
namespace {

class Replay : public testing::Test {
 protected:
  // Every command and every status of the log comes out of the replay again, bit for bit.
  void expectSame(const FlightLog& log) {
    const std::vector<ReplaySample> samples = replay(log, maps_.axes(), options_);
    const ValidationReport report = validate(log, samples, maps_.axes(), options_);
    EXPECT_EQ(report.commands.max_difference, 0.0);
    EXPECT_EQ(report.commands.compared, samples.size());
    EXPECT_EQ(report.statuses.compared, samples.size());
    EXPECT_EQ(report.statuses.differing, 0u);
    EXPECT_EQ(report.statuses.max_theta_difference, 0.0);
  }

  ValidationReport validated(const FlightLog& log) const {
    return validate(log, replay(log, maps_.axes(), options_), maps_.axes(), options_);
  }

  static void flySome(FlightRecorder& recorder, std::size_t from, std::size_t to) {
    for (std::size_t sample = from; sample < to; ++sample) recorder.fly(SyntheticFlight::state(sample));
  }

  ScratchFolder folder_;
  HandMadeMaps maps_{folder_};
  MultirotorOptions options_;
};

TEST_F(Replay, repeatsAFlightBitForBit) {
  const FlightLog log = syntheticFlight(maps_.axes());
  EXPECT_EQ(replay(log, maps_.axes(), options_).size(), SyntheticFlight::kSamples);
  expectSame(log);
}

TEST_F(Replay, PredictsOverTheDelayAsTheFlightDid) {
  options_.delay = 0.047;
  FlightRecorder recorder(maps_.axes(), options_);
  recorder.hold(SyntheticFlight::home());
  flySome(recorder, 0, 100);
  recorder.beSilent(SyntheticFlight::state(111).stamp);
  flySome(recorder, 130, 300);
  const auto samples = replay(recorder.log(), maps_.axes(), options_);
  EXPECT_EQ(samples.back().reference.position, SyntheticFlight::home());
  expectSame(recorder.log());
  options_.delay = 0.0;
  const auto without = replay(recorder.log(), maps_.axes(), options_);
  EXPECT_GT(validate(recorder.log(), without, maps_.axes(), options_).commands.difference[0].max, 1e-3);
}

TEST_F(Replay, withOtherOptionsGivesOtherCommands) {
  const FlightLog log = syntheticFlight(maps_.axes());
  options_.mass = 2.0;
  const auto samples = replay(log, maps_.axes(), options_);
  EXPECT_GT(validate(log, samples, maps_.axes(), options_).commands.difference[3].max, 1.0);
}

TEST_F(Replay, samplesBeforeTheFirstReferenceHaveNone) {
  FlightRecorder recorder(maps_.axes(), options_);
  flySome(recorder, 0, 10);
  recorder.hold(SyntheticFlight::home());
  flySome(recorder, 10, 30);
  const auto samples = replay(recorder.log(), maps_.axes(), options_);
  ASSERT_EQ(samples.size(), 30u);
  EXPECT_FALSE(samples[9].has_reference);
  EXPECT_EQ(samples[9].report.status, ControlStatus::kNoReference);
  EXPECT_TRUE(samples[10].has_reference);
  expectSame(recorder.log());
}

TEST_F(Replay, followsSilenceAndANewReference) {
  FlightRecorder recorder(maps_.axes(), options_);
  recorder.hold(SyntheticFlight::home());
  flySome(recorder, 0, 100);
  recorder.beSilent(SyntheticFlight::state(111).stamp);
  recorder.beSilent(SyntheticFlight::state(112).stamp);
  flySome(recorder, 130, 200);
  recorder.hold(SyntheticFlight::home() + Eigen::Vector3d(0.1, 0.0, -0.1));
  flySome(recorder, 200, 300);
  expectSame(recorder.log());
}

TEST_F(Replay, leavesOutWhatTheNodeNeverSaw) {
  FlightRecorder recorder(maps_.axes(), options_);
  recorder.hold(SyntheticFlight::home());
  flySome(recorder, 0, 100);
  recorder.miss(SyntheticFlight::state(100, {0.3, 0.3, 0.3}));
  flySome(recorder, 101, 200);
  EXPECT_EQ(replay(recorder.log(), maps_.axes(), options_).size(), 199u);
  expectSame(recorder.log());
  const auto samples = replay(recorder.log(), maps_.axes(), options_);
  EXPECT_EQ(validate(recorder.log(), samples, maps_.axes(), options_).commands.unanswered, 1u);
}

// A sample is altered, or lost with its answer; or the record begins in flight. Of a law that estimates nothing.
TEST_F(Replay, comparesAgainWhereTheCommandsAgree) {
  options_.offset_free = false;
  FlightRecorder recorder(maps_.axes(), options_);
  recorder.hold(SyntheticFlight::home());
  flySome(recorder, 0, 3000);
  const FlightLog whole = recorder.log();
  for (const Ignorance why : {Ignorance::kAltered, Ignorance::kMissing, Ignorance::kBegun}) {
    FlightLog log;
    log.add(whole.references[0].trajectory, std::nullopt);
    const std::size_t first = why == Ignorance::kBegun ? 100 : 0;
    for (std::size_t sample = first; sample < whole.odometry.size(); ++sample) {
      if (why == Ignorance::kMissing && sample == 100) continue;
      log.add(whole.odometry[sample]);
      if (why == Ignorance::kAltered && sample == 100) log.odometry.back().position.x() += 0.03;
      log.commands.push_back(whole.commands[sample]);
      log.statuses.push_back(whole.statuses[sample]);
    }
    const auto count = [&](const FlightLog& flown) {
      const auto samples = replay(flown, maps_.axes(), options_);
      EXPECT_EQ(samples[why == Ignorance::kBegun ? 0 : 100].ignorance, why);
      return validate(flown, samples, maps_.axes(), options_);
    };
    const ValidationReport report = count(log);
    EXPECT_EQ(report.incomparable.size(), 1u);
    EXPECT_GT(report.commands.compared, 2800u);
    EXPECT_EQ(report.commands.compared + report.incomparable[0].samples, log.commands.size());
    EXPECT_TRUE(brokenThresholds(report, {}).empty());
    log.commands[2800].command.roll += 2e-6;
    EXPECT_EQ(brokenThresholds(count(log), {}).size(), 1u);
  }
}

// A part is lost that held nothing but the second of three references. Its times are known or not.
TEST_F(Replay, doesNotJudgeByAReferenceThatIsLost) {
  options_.offset_free = false;
  FlightRecorder recorder(maps_.axes(), options_);
  for (const std::size_t part : {0u, 1u, 2u}) {
    recorder.hold(SyntheticFlight::home() + Eigen::Vector3d(0.02 * static_cast<double>(part % 2), 0.0, 0.0));
    flySome(recorder, 300 * part, 300 * part + 300);
  }
  const FlightLog whole = recorder.log();
  for (const bool told : {true, false}) {
    for (const bool timed : {true, false}) {
      FlightLog log = whole;
      log.events.erase(log.events.begin() + 301);
      if (!told) log.statuses.clear();
      EXPECT_FALSE(brokenThresholds(validated(log), {}).empty());
      log.share = RecordingShare{{999.0, 1000.0}, {99.0, 100.0}, {10.0, 10.0}};
      if (timed) log.lost = {{whole.odometry[299].stamp, whole.odometry[300].stamp}};
      const ValidationReport report = validated(log);
      EXPECT_TRUE(brokenThresholds(report, {}).empty());
      EXPECT_EQ(report.verdict(), Verdict::kDoubtful);
      ASSERT_EQ(report.incomparable.size(), 1u);
      EXPECT_EQ(report.incomparable[0].cause, Ignorance::kMissing);
      EXPECT_EQ(report.incomparable[0].from, whole.odometry[299].stamp);
      EXPECT_LT(report.incomparable[0].to, whole.odometry[700].stamp);
      // What is wrong before the loss, or from the begin on, fails all the same.
      log.commands[20].command.roll += 0.01;
      EXPECT_EQ(brokenThresholds(validated(log), {}).size(), 1u);
    }
  }
}

TEST_F(Replay, usesAllOdometryWhereNoCommandBearsItsStamp) {
  FlightLog log = syntheticFlight(maps_.axes());
  for (FlightLog::Command& command : log.commands) command.stamp = 0.0;
  const auto samples = replay(log, maps_.axes(), options_);
  EXPECT_EQ(samples.size(), SyntheticFlight::kSamples);
  const ValidationReport report = validate(log, samples, maps_.axes(), options_);
  EXPECT_EQ(report.commands.compared, 0u);
  EXPECT_EQ(report.commands.unmatched, SyntheticFlight::kSamples);
  EXPECT_FALSE(brokenThresholds(report, {}).empty());
}

TEST_F(Replay, assignsMapsByTheirSignalsInAnyOrder) {
  const AxisMaps axes = maps_.axes();
  EXPECT_EQ(assignAxes({axes[2], axes[0], axes[1]}), axes);
  EXPECT_EQ(assignAxes({axes[1], axes[2], axes[0]}), axes);
}

TEST_F(Replay, refusesMapsThatDoNotMakeThreeAxes) {
  const AxisMaps axes = maps_.axes();
  EXPECT_EQ(errorOf([&] {
              assignAxes({axes[0], axes[2]});
            }),
            "maps: none for the lateral axis (parameter e_p_y)");
  EXPECT_NE(errorOf([&] {
              assignAxes({axes[0], axes[0], axes[1], axes[2]});
            }).find("already has the map"),
            std::string::npos);
  MapContent content = handMadeMap(0);
  content.parameters[0].name = "something";
  writeMap(content, folder_ / "foreign.map");
  const RegionMap foreign = RegionMap::open(folder_ / "foreign.map");
  EXPECT_NE(errorOf([&] {
              assignAxes({&foreign, axes[1], axes[2]});
            }).find("foreign.map: parameters: none is e_p_x"),
            std::string::npos);
}

}  // namespace
}  // namespace polyfly
