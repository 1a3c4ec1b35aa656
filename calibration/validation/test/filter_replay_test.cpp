// The replay of a safety filter, on records that are made here with the filter in the loop and without.
#include "validation/filter_replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "made_fence.hpp"
#include "polyfly_base/error.hpp"
#include "synthetic_flight.hpp"
#include "validation/filter_validation.hpp"

namespace polyfly {
namespace {

constexpr double kPeriod = 0.1;
constexpr std::size_t kPeriods = 120;

class FilterReplayTest : public ::testing::Test {
 protected:
  CommandFilter fence(double delay = 0.0) {
    const std::string file = scratch_ / "fence.map";
    MadeFence{kPeriod, delay}.writeMap(file);
    std::vector<RegionMap> maps;
    maps.push_back(RegionMap::open(file));
    return {std::move(maps), options_};
  }

  // A controller that pitches forward, then back, each for half of the flight. The vehicle does as the map's model
  // says, flown through the filter or past it.
  FilterLog fly(bool filtered, double delay = 0.0) {
    CommandFilter filter = fence(delay);
    FilterLog log;
    log.source = "folder/made.bag";
    VehicleState state;
    double before = 0.0;
    for (std::size_t k = 0; k < kPeriods; ++k) {
      const double time = 100.0 + kPeriod * static_cast<double>(k);
      AttitudeCommand wish;
      wish.pitch = k < kPeriods / 2 ? 0.12 : -0.12;
      wish.thrust = options_.mass * options_.gravity;
      state.stamp = time;
      log.odometry.push_back({time, state});
      log.wishes.push_back({time, time, wish});
      double a = options_.gravity * std::sin(wish.pitch);
      if (filtered) {
        const FilterReport& report = filter.step(state, wish);
        a = report.axes[0].input;
        log.statuses.push_back(
            {time, report.status, {report.axes[0].input, report.axes[1].input, report.axes[2].input}});
      }
      for (const auto& [input, length] : {std::pair(before, delay), std::pair(a, kPeriod - delay)}) {
        state.position.x() += length * state.velocity.x() + 0.5 * length * length * input;
        state.velocity.x() += length * input;
      }
      before = a;
    }
    return log;
  }

  Json judge(const FilterLog& log, double delay = 0.0) {
    CommandFilter filter = fence(delay);
    replay_ = replayFilter(log, {}, filter);
    return judgeFilter(log, replay_, filter);
  }

  MultirotorOptions options_;
  ScratchFolder scratch_;
  FilterReplay replay_;
};

bool mentions(const Json& judgement, const std::string& part) {
  return judgement["findings"].dump().find(part) != std::string::npos;
}

TEST_F(FilterReplayTest, RepeatsWhatTheFilterDidInFlight) {
  for (const double delay : {0.0, 0.04}) {
    const Json result = judge(fly(true, delay), delay);
    EXPECT_EQ(result["verdict"], "passed") << toText(reportOnFilter(result));
    EXPECT_EQ(result["in_flight"]["compared"], kPeriods);
    EXPECT_EQ(result["in_flight"]["differing"], 0);
    EXPECT_EQ(result["in_flight"]["greatest_difference_m_s2"], 0.0);
    EXPECT_EQ(result["in_flight"]["recorded"], result["replayed"]);
    EXPECT_NEAR(result["duration_s"].get<double>(), kPeriod * static_cast<double>(kPeriods), 1e-9);
    ASSERT_EQ(result["axes"].size(), 1u);
    // Once before each end of the fence at least, where it comes near the edge and stays inside.
    ASSERT_GE(result["actions"].size(), 2u);
    EXPECT_LT(result["actions"].front()["change_m_s2"], -0.1);
    EXPECT_GT(result["actions"].back()["change_m_s2"], 0.1);
    EXPECT_GE(result["axes"][0]["least_distance"], 0.0);
    EXPECT_LT(result["axes"][0]["least_distance"], 0.05);
    EXPECT_LE(result["axes"][0]["position_m"][1], 2.0);
    EXPECT_GT(result["axes"][0]["changed"], 10);
    EXPECT_NEAR(result["axes"][0]["changed_s"].get<double>(),
                kPeriod * result["axes"][0]["changed"].get<double>(), 1e-9);
  }
}

TEST_F(FilterReplayTest, TellsHowLongAFlightWithoutItWasOutside) {
  const FilterLog log = fly(false);
  const Json result = judge(log);
  EXPECT_TRUE(result["in_flight"].is_null());
  EXPECT_TRUE(mentions(result, "x: the state was outside of the safe set for"));
  // At least where the fence itself is left.
  std::size_t left = 0;
  for (const FilterLog::Odometry& odometry : log.odometry) {
    const VehicleState& state = odometry.state;
    if (std::abs(state.position.x()) > 2.0 || std::abs(state.velocity.x()) > 1.5) ++left;
  }
  EXPECT_GT(left, 20u);
  EXPECT_GE(result["axes"][0]["outside_s"], kPeriod * static_cast<double>(left) - 1e-9);
  EXPECT_GT(result["replayed"]["outside"], 0);
  EXPECT_LT(result["axes"][0]["least_distance"], 0.0);
}

// Against rays from the state, in states that are scaled by halves of their ranges.
TEST_F(FilterReplayTest, DistanceIsThatToTheNearestPointOfTheEdge) {
  const CommandFilter filter = fence();
  const SafetyFilterProblem& problem = *filter.problem(0);
  const auto isInside = [&](double p, double v) {
    const Eigen::Vector2d x(p, v);
    return (problem.safe_set->H * x - problem.safe_set->k).maxCoeff() <= 0.0;
  };
  for (const auto& [p, v] : {std::pair(0.0, 0.0), std::pair(1.2, 0.4), std::pair(-1.0, -0.9)}) {
    ASSERT_TRUE(isInside(p, v));
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3600; ++k) {
      const double angle = k * M_PI / 1800.0;
      double inside = 0.0, outside = 4.0;
      for (int halving = 0; halving < 50; ++halving) {
        const double middle = 0.5 * (inside + outside);
        (isInside(p + 2.0 * middle * std::cos(angle), v + 1.5 * middle * std::sin(angle)) ? inside
                                                                                          : outside) = middle;
      }
      nearest = std::min(nearest, inside);
    }
    const double xi[] = {p, v};
    EXPECT_NEAR(edgeDistance(problem, xi), nearest, 1e-5 * (1.0 + nearest));
  }
  const double far[] = {3.0, 0.0};
  EXPECT_LE(edgeDistance(problem, far), -0.5);
}

TEST_F(FilterReplayTest, FollowsTheNodeInSilence) {
  FilterLog log = fly(true);
  log.statuses.clear();
  // Without commands for a second, without odometry for another, and one command that comes too soon.
  const auto between = [](double from, double to) {
    return [from, to](const auto& message) { return message.received > from && message.received < to; };
  };
  log.wishes.erase(std::remove_if(log.wishes.begin(), log.wishes.end(), between(102.05, 103.05)),
                   log.wishes.end());
  log.odometry.erase(std::remove_if(log.odometry.begin(), log.odometry.end(), between(105.05, 106.05)),
                     log.odometry.end());
  FilterLog::Wish early = log.wishes[5];
  early.received += 0.03;
  early.stamp += 0.03;
  log.wishes.insert(log.wishes.begin() + 6, early);
  const Json result = judge(log);
  EXPECT_EQ(result["early"], 1);
  // The last command is of 102.0 and lasts for 3 periods: the silence is answered at 102.3 .. 103.0.
  EXPECT_EQ(result["replayed"]["no_wish"], 8);
  EXPECT_NEAR(result["without_command_s"].get<double>(), 0.8, 1e-6);
  // The last odometry is of 105.0 and counts for 3 periods.
  EXPECT_NEAR(result["replayed"]["no_state"].get<double>(), 7.0, 1.0);
  EXPECT_TRUE(mentions(result, "without a command for 0.8 s"));
  EXPECT_TRUE(mentions(result, "without odometry for"));
}

TEST_F(FilterReplayTest, FollowsNoSilenceOfYears) {
  FilterLog log = fly(true);
  for (std::size_t k = 60; k < kPeriods; ++k) {
    log.odometry[k].received += 1e9;
    log.wishes[k].received += 1e9;
  }
  const Json result = judge(log);
  // Odometry pauses as well, which counts first.
  EXPECT_NEAR(result["without_command_s"].get<double>() + result["without_odometry_s"].get<double>(), 60.0,
              1.0);
  EXPECT_LT(replay_.samples.size(), 1000u);
}

TEST_F(FilterReplayTest, FindsRecordsThatAreNotThoseOfTheReplay) {
  FilterLog log = fly(true);
  log.statuses[7].input[0] += 1e-6;
  log.statuses[9].status = FilterStatus::kOutside;
  const Json result = judge(log);
  EXPECT_EQ(result["in_flight"]["differing"], 2);
  EXPECT_TRUE(mentions(result, "2 of 120 recorded answers are not those of the replay"));
  log = fly(true);
  log.statuses.erase(log.statuses.begin() + 20, log.statuses.begin() + 40);
  EXPECT_TRUE(mentions(judge(log), "20 commands have no recorded filter_status"));
  log.wishes.clear();
  EXPECT_THROW(judge(log), Error);
}

TEST_F(FilterReplayTest, FindsAControllerOfAnotherPeriod) {
  FilterLog log = fly(true);
  log.statuses.clear();
  // Each other command is left out, with its odometry.
  FilterLog slow = log;
  slow.wishes.clear();
  slow.odometry.clear();
  for (std::size_t k = 0; k < kPeriods; k += 2) {
    slow.wishes.push_back(log.wishes[k]);
    slow.odometry.push_back(log.odometry[k]);
  }
  EXPECT_FALSE(mentions(judge(log), "apart in the median"));
  EXPECT_TRUE(
      mentions(judge(slow), "answers are 0.2 s apart in the median, but the maps are made for 0.1 s"));
}

TEST_F(FilterReplayTest, WritesPageAndSummary) {
  const Json result = judge(fly(true));
  writeFilterReport(result, replay_, fence(), scratch_ / "report");
  std::ifstream page(scratch_ / "report/index.html"), summary(scratch_ / "report/summary.json");
  std::stringstream text;
  text << page.rdbuf();
  for (const char* part : {"verdict good", "Where the filter acted", "Axis x: fence_x", "<svg", "made.bag"})
    EXPECT_NE(text.str().find(part), std::string::npos) << part;
  EXPECT_EQ(text.str().find("folder/made.bag"), std::string::npos);
  EXPECT_EQ(Json::parse(summary), result);
  EXPECT_EQ(result["answers"], kPeriods);
}

}  // namespace
}  // namespace polyfly
