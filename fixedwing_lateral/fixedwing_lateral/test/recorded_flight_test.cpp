// Logs of real aircraft: the guidance asked open loop, at each recorded state, to fly the path that was
// flown. What needs the logs says that it skips where they are absent.
#include "fixedwing_plant/recorded_flight.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "polyfly_base/error.hpp"
#include "reference_data.hpp"

namespace {

using namespace polyfly;

std::filesystem::path logs() { return referenceData("flight_logs"); }

struct Log {
  const char* file;
  double begin, end;  // [s]
  double airspeed;    // [m/s]
};

class RecordedFlight : public testing::TestWithParam<Log> {
 protected:
  void SetUp() override {
    if (logs().empty()) GTEST_SKIP() << "The flight logs are not here: set POLYFLY_DATA to their folder.";
    samples_ = readRecording((logs() / GetParam().file).string(), GetParam().begin, GetParam().end);
    ASSERT_GT(samples_.size(), 5000U);
  }

  std::vector<RecordedSample> samples_;
};

TEST_P(RecordedFlight, IsAnsweredBySaneReferences) {
  const GuidanceOptions options = replayOptions(GetParam().airspeed);
  LateralGuidance guidance(options, "test");
  const Mission mission = missionAlong(samples_, 2.0);
  guidance.setMission(mission);
  const std::vector<FlightSample> replayed = replayOpenLoop(guidance, samples_);
  ASSERT_GT(replayed.size(), 3500U);
  std::vector<double> flown, asked;
  int last = 0;
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < replayed.size(); ++i) {
    const GuidanceOutput& output = replayed[i].output;
    ASSERT_EQ(output.mode, GuidanceMode::kTracking) << replayed[i].time << ": " << toString(output.reason);
    ASSERT_TRUE(std::isfinite(output.roll_reference));
    ASSERT_LE(std::abs(output.roll_reference), options.limits.roll_reference);
    EXPECT_GE(output.segment, last);
    EXPECT_LE(output.segment, last + 1);
    last = output.segment;
    wind += replayed[i].wind;
    constexpr std::size_t kLater = 10;  // half a second: what is asked for is flown a little later
    if (output.loitering || i + kLater >= replayed.size()) continue;
    EXPECT_LT(std::abs(output.error.track), 8.0) << replayed[i].time;
    asked.push_back(output.roll_reference);
    flown.push_back(replayed[i + kLater].truth.roll);
  }
  EXPECT_EQ(last + 1, static_cast<int>(mission.segments.size()));

  // It asks for the turns that were flown.
  const auto count = static_cast<Eigen::Index>(asked.size());
  Eigen::ArrayXd a = Eigen::Map<Eigen::ArrayXd>(asked.data(), count);
  Eigen::ArrayXd f = Eigen::Map<Eigen::ArrayXd>(flown.data(), count);
  a -= a.mean();
  f -= f.mean();
  EXPECT_GT((a * f).sum() / std::sqrt(a.square().sum() * f.square().sum()), 0.65);

  // The wind is that of an estimate that uses no heading.
  wind /= static_cast<double>(replayed.size());
  EXPECT_LT((wind - windBySpeeds(samples_)).norm(), 0.6);
}

INSTANTIATE_TEST_SUITE_P(Logs, RecordedFlight,
                         testing::Values(Log{"fw_px4_proto_flt09.csv", 306.0, 500.0, 16.5},
                                         Log{"fw_umn_thor75.csv", 240.0, 530.0, 16.0}),
                         [](const auto& tested) { return std::string(tested.param.file).substr(3, 3); });

TEST(RecordedFlightFit, FindsTheWindByTheSpeeds) {
  std::vector<RecordedSample> samples;
  for (int i = 0; i < 400; ++i) {
    RecordedSample sample;
    const double heading = 0.05 * i;
    sample.state.ground_velocity =
        14.0 * Eigen::Vector2d(std::cos(heading), std::sin(heading)) + Eigen::Vector2d(3.0, -4.0);
    sample.airspeed = 14.7;  // 5 % too much
    samples.push_back(sample);
  }
  EXPECT_LT((windBySpeeds(samples) - Eigen::Vector2d(3.0, -4.0)).norm(), 1e-9);
}

TEST(RecordedFlightFile, SaysWhatIsWrongAndWhere) {
  const std::string path = testing::TempDir() + "recorded_flight_test.csv";
  const std::string header = "t_s,roll_rad,rollrate_radps,heading_rad,north_m,east_m,vn_mps,ve_mps,tas_mps\n";
  const auto complaint = [&](const std::string& text) -> std::string {
    std::ofstream(path) << text;
    try {
      readRecording(path, -1e9, 1e9);
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(complaint(header + "0,0,0,0,0,0,14,0,14\n"), "none");
  EXPECT_NE(complaint("t_s,roll_rad\n0,0\n").find(":2: north_m: no such column"), std::string::npos);
  EXPECT_NE(complaint(header + "0,0,0,0,0,0,14,0\n").find(":2: tas_mps: missing"), std::string::npos);
  EXPECT_NE(
      complaint(header + "0,0,0,0,0,0,14,0,14\n1,0,x,0,0,0,14,0,14\n").find(":3: rollrate_radps: must be"),
      std::string::npos);
  EXPECT_NE(complaint("").find("cannot be read"), std::string::npos);
  std::filesystem::remove(path);
}

}  // namespace
