#include "identification/fit_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "identification/identify_axis.hpp"
#include "made_flight.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kReach = 0.6;  // [s]

LoopFit fitMade(const test::MadeLoop& made, std::uint32_t seed) {
  FitOptions options;
  options.order = made.order;
  return fitLoop(cutSegments(test::makeFlight(made, seed), {{0.0, made.duration}}, kReach), options);
}

/// How often the truth lay in the stated interval, and how far the values were from it.
struct Score {
  int inside = 0;
  std::vector<double> errors;  // relative

  void add(const FittedParameter& found, double truth) {
    inside += found.least() <= truth && truth <= found.greatest() ? 1 : 0;
    errors.push_back(std::abs(found.value - truth) / truth);
  }
  double medianError() {
    std::sort(errors.begin(), errors.end());
    return errors[errors.size() / 2];
  }
};

TEST(FitLoop, FindsKnownParametersWithinStatedIntervals) {
  constexpr int kFlights = 100;
  std::map<std::string, Score> scores;
  for (std::uint32_t seed = 1; seed <= kFlights; ++seed) {
    std::mt19937 random(seed);
    const auto draw = [&random](double least, double greatest) {
      return std::uniform_real_distribution<double>(least, greatest)(random);
    };
    test::MadeLoop made;
    made.gain = draw(0.8, 1.2);
    made.tau = draw(0.08, 0.4);
    made.delay = draw(0.02, 0.2);
    made.noise = draw(0.002, 0.01);
    made.coloured_noise = draw(0.0, 0.01);
    made.command_rate = draw(20.0, 50.0);
    const LoopFit fit = fitMade(made, seed);
    scores["gain"].add(*fit.find("gain"), made.gain);
    scores["tau"].add(*fit.find("tau"), made.tau);
    scores["delay"].add(*fit.find("delay"), made.delay);
  }
  for (auto& [name, score] : scores) {
    EXPECT_GE(score.inside, 90) << name;
    EXPECT_LT(score.medianError(), 0.03) << name;
  }
}

TEST(FitLoop, FindsSecondOrderParameters) {
  constexpr int kFlights = 20;
  std::map<std::string, Score> scores;
  for (std::uint32_t seed = 1; seed <= kFlights; ++seed) {
    std::mt19937 random(seed);
    const auto draw = [&random](double least, double greatest) {
      return std::uniform_real_distribution<double>(least, greatest)(random);
    };
    test::MadeLoop made;
    made.order = LoopOrder::kSecond;
    made.a0 = draw(8.0, 60.0);
    made.a1 = 2.0 * draw(0.5, 1.1) * std::sqrt(made.a0);
    made.delay = draw(0.02, 0.2);
    made.coloured_noise = 0.003;
    made.response_rate = 30.0;
    const LoopFit fit = fitMade(made, seed);
    scores["a0"].add(*fit.find("a0"), made.a0);
    scores["a1"].add(*fit.find("a1"), made.a1);
    scores["b0"].add(*fit.find("b0"), made.gain * made.a0);
    scores["delay"].add(*fit.find("delay"), made.delay);
  }
  for (auto& [name, score] : scores) {
    EXPECT_GE(score.inside, 18) << name;
    EXPECT_LT(score.medianError(), 0.03) << name;
  }
}

TEST(FitLoop, ShrugsOffOutliers) {
  test::MadeLoop made;
  LoopRecord record = test::makeFlight(made, 3);
  for (std::size_t i = 0; i < record.response.value.size(); i += 20) record.response.value[i] = 3.0;
  const LoopFit fit = fitLoop(cutSegments(record, {{0.0, 30.0}}, kReach), {});
  EXPECT_NEAR(fit.gain, made.gain, 0.03);
  EXPECT_NEAR(fit.shape.tau, made.tau, 0.01);
  EXPECT_NEAR(fit.shape.delay, made.delay, 0.01);
}

TEST(FitLoop, WithoutItsDelayTheLagComesOutTooLong) {
  test::MadeLoop made;
  made.delay = 0.12;
  FitOptions options;
  options.with_delay = false;
  const auto segments = cutSegments(test::makeFlight(made, 4), {{0.0, 30.0}}, kReach);
  const LoopFit without = fitLoop(segments, options);
  const LoopFit with = fitLoop(segments, {});
  EXPECT_GT(without.shape.tau, 1.3 * made.tau);
  EXPECT_LT(without.fit_percent, with.fit_percent - 3.0);
  EXPECT_EQ(without.find("delay"), nullptr);
}

TEST(FitLoop, SmoothedResponseGivesTheSameModel) {
  test::MadeLoop made;
  LoopRecord record = test::makeFlight(made, 5);
  record.smoothing = 0.1;
  record.response.value = smoothedMean(record.response.time,
                                       cumulativeIntegral(record.response.time, record.response.value), 0.1);
  const LoopFit fit = fitLoop(cutSegments(record, {{0.0, 30.0}}, kReach), {});
  EXPECT_NEAR(fit.gain, made.gain, 0.02);
  EXPECT_NEAR(fit.shape.tau, made.tau, 0.015);
  EXPECT_NEAR(fit.shape.delay, made.delay, 0.01);
}

TEST(FitLoop, PredictsAnotherFlight) {
  test::MadeLoop made;
  const LoopFit fit = fitMade(made, 6);
  const auto other = cutSegments(test::makeFlight(made, 7), {{0.0, 30.0}}, kReach);
  EXPECT_NEAR(predictLoop(fit, other).fit_percent, fit.fit_percent, 1.0);
}

TEST(FitLoop, RefusesWhatCannotBeFitted) {
  EXPECT_THROW(fitLoop({}, {}), Error);
  test::MadeLoop made;
  LoopRecord record = test::makeFlight(made, 8);
  for (double& value : record.command.value) value = 0.1;
  EXPECT_THROW(fitLoop(cutSegments(record, {{0.0, 30.0}}, kReach), {}), Error);
  record = test::makeFlight(made, 8);
  for (double& value : record.response.value) value = 0.1;
  EXPECT_THROW(fitLoop(cutSegments(record, {{0.0, 30.0}}, kReach), {}), Error);
}

TEST(CutSegments, SplitsAtPausesAndKeepsTheCommandBefore) {
  test::MadeLoop made;
  LoopRecord record = test::makeFlight(made, 9);
  auto& response = record.response;
  const auto from =
      std::lower_bound(response.time.begin(), response.time.end(), 10.0) - response.time.begin();
  const auto to = std::lower_bound(response.time.begin(), response.time.end(), 14.0) - response.time.begin();
  response.time.erase(response.time.begin() + from, response.time.begin() + to);
  response.value.erase(response.value.begin() + from, response.value.begin() + to);
  const auto segments = cutSegments(record, {{5.0, 25.0}}, kReach);
  ASSERT_EQ(segments.size(), 2u);
  EXPECT_LT(segments[0].time.back(), 10.0);
  EXPECT_GE(segments[1].time.front(), 14.0);
  EXPECT_LE(segments[1].command.time.front(), segments[1].time.front() - kReach);
}

TEST(Cleaned, LeavesFiniteSamplesOfIncreasingTime) {
  const TimeSeries clean =
      cleaned({{0.0, 1.0, 0.5, std::nan(""), 2.0, 3.0}, {1.0, 2.0, 3.0, 4.0, std::nan(""), 6.0}});
  EXPECT_EQ(clean.time, (std::vector<double>{0.0, 1.0, 3.0}));
  EXPECT_THROW(cleaned({{0.0}, {}}), Error);
}

TEST(ChooseExcitation, TakesWhatMovesAndAnswers) {
  test::MadeLoop made;
  made.duration = 60.0;
  LoopRecord record = test::makeFlight(made, 10);
  // At rest from 20 s on; from 40 s on the command moves, but nothing answers.
  for (std::size_t i = 0; i < record.command.time.size(); ++i) {
    if (record.command.time[i] > 20.0 && record.command.time[i] < 40.0) record.command.value[i] = 0.0;
  }
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (std::size_t i = 0; i < record.response.time.size(); ++i) {
    if (record.response.time[i] > 21.0) record.response.value[i] = noise(random);
  }
  const std::vector<TimeWindow> moves = chooseExcitation(record).windows;
  ASSERT_EQ(moves.size(), 2u);
  EXPECT_LT(moves[0].from, 1.0);
  EXPECT_NEAR(moves[0].to, 21.0, 1.5);
  EXPECT_GT(moves[1].from, 38.0);
  AxisRecords records;
  records.axis = "roll";
  records.training = record;
  const ExcitationChoice choice = identifyAxis(records, {}).choice;
  ASSERT_EQ(choice.windows.size(), 1u);
  EXPECT_LT(choice.windows[0].from, 1.0);
  EXPECT_LT(choice.windows[0].to, 21.5);
  ASSERT_FALSE(choice.rejected.empty());
  EXPECT_EQ(choice.rejected.back().window.to, moves[1].to);
}

}  // namespace
}  // namespace polyfly
