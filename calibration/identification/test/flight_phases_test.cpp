#include "identification/flight_phases.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "identification/identify_axis.hpp"
#include "identification/motion.hpp"
#include "made_stretches.hpp"

namespace polyfly {
namespace {

using test::MadeStretches;
using test::MadeStretchesFlight;
using test::makeStretches;

// Greatest loss of fit against windows chosen by hand [%].
constexpr double kAllowedLoss = 5.0;

MadeStretchesFlight flightOf(const MadeStretches& made, std::uint32_t seed) {
  MadeStretchesFlight flight = makeStretches(made, seed);
  flight.signals.not_flight = findNonFlight(flight.signals);
  return flight;
}

double overlap(const TimeWindow& one, const TimeWindow& other) {
  return std::max(0.0, std::min(one.to, other.to) - std::max(one.from, other.from));
}

double leftOut(const MadeStretchesFlight& flight, const TimeWindow& window, const char* reason) {
  double sum = 0.0;
  for (const RejectedWindow& one : flight.signals.not_flight) {
    if (one.reason.find(reason) != std::string::npos) sum += overlap(one.window, window);
  }
  return sum;
}

// Roll and pitch without windows fit about as well as with those chosen by hand, and find the same model.
void expectAsByHand(const MadeStretches& made, std::uint32_t seed) {
  const MadeStretchesFlight flight = flightOf(made, seed);
  for (const std::string axis : {"roll", "pitch"}) {
    IdentifyOptions options;
    options.fit.global_evaluations = options.fit.local_evaluations = 80;
    const AxisModel model = identifyAxis(axisRecords(flight.signals, axis), options);
    options.windows = flight.by_hand;
    const AxisModel by_hand = identifyAxis(axisRecords(flight.signals, axis), options);
    EXPECT_GT(by_hand.with_delay.fit_percent, 70.0) << axis << " " << seed;
    EXPECT_NEAR(model.with_delay.fit_percent, by_hand.with_delay.fit_percent, kAllowedLoss)
        << axis << " " << seed;
    EXPECT_NEAR(model.with_delay.gain, by_hand.with_delay.gain, 0.03) << axis << " " << seed;
    EXPECT_NEAR(model.with_delay.shape.tau, by_hand.with_delay.shape.tau, 0.02) << axis << " " << seed;
    double used = 0.0;
    for (const TimeWindow& one : model.choice.windows) {
      for (const TimeWindow& other : flight.by_hand) used += overlap(one, other);
    }
    EXPECT_GT(used, 0.8 * made.manoeuvres) << axis << " " << seed;
  }
}

class Stretches : public testing::TestWithParam<MadeStretches> {};

TEST_P(Stretches, FitsAsWellAsByHand) {
  for (std::uint32_t seed = 5; seed <= 6; ++seed) expectAsByHand(GetParam(), seed);
}

MadeStretches with(double MadeStretches::*member, double seconds, bool many_signs = true) {
  MadeStretches made;
  made.*member = seconds;
  made.many_signs = many_signs;
  return made;
}

MadeStretches everything() {
  MadeStretches made;
  made.tumbles = 4.0;
  made.stands = 20.0;
  made.other_mode = 20.0;
  made.stuck = 10.0;
  made.hovers = 60.0;
  return made;
}

INSTANTIATE_TEST_SUITE_P(
    All, Stretches,
    testing::Values(with(&MadeStretches::tumbles, 4.0), with(&MadeStretches::tumbles, 4.0, false),
                    with(&MadeStretches::stands, 40.0), with(&MadeStretches::stands, 40.0, false),
                    with(&MadeStretches::other_mode, 25.0), with(&MadeStretches::stuck, 15.0),
                    with(&MadeStretches::hovers, 200.0), everything()));

TEST(FlightPhases, NamesATumbleAtTheEnd) {
  for (const bool many_signs : {true, false}) {
    const MadeStretchesFlight flight = flightOf(with(&MadeStretches::tumbles, 3.0, many_signs), 1);
    ASSERT_EQ(flight.signals.not_flight.size(), 1u);
    const RejectedWindow& found = flight.signals.not_flight.front();
    EXPECT_NE(found.reason.find("upset"), std::string::npos) << found.reason;
    EXPECT_NEAR(found.window.from, flight.by_hand.back().to, 1.0);
    EXPECT_GE(found.window.to, flight.signals.at("roll").time.back());
  }
}

TEST(FlightPhases, NamesStanding) {
  const MadeStretchesFlight flight = flightOf(with(&MadeStretches::stands, 30.0), 2);
  EXPECT_GT(leftOut(flight, {0.0, 30.0}, "on the ground"), 29.0);
  EXPECT_LT(leftOut(flight, flight.in_air, "ground"), 1.0);
  EXPECT_TRUE(findNonFlight(flight.signals, true).empty()) << "--on-ground uses them";
}

TEST(FlightPhases, LeavesNothingOfAFlightOut) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const MadeStretchesFlight flight = flightOf(with(&MadeStretches::hovers, 60.0), seed);
    EXPECT_TRUE(flight.signals.not_flight.empty())
        << seed << ": " << flight.signals.not_flight.front().reason;
  }
}

TEST(FlightPhases, HoldWhereTheClockWasSet) {
  MadeStretchesFlight flight = makeStretches(with(&MadeStretches::stands, 20.0), 3);
  for (auto& [name, series] : flight.signals.series) {
    for (double& time : series.time) time += time > 50.0 ? 3e8 : 0.0;
  }
  const std::vector<RejectedWindow> found = findNonFlight(flight.signals);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_LT(found.front().window.to, 25.0);
  EXPECT_GT(found.back().window.from, 3e8);
}

TEST(FlightPhases, ATumbleDoesNotWidenTheDisturbance) {
  const auto greatest = [](const MadeStretches& made) {
    const MadeStretchesFlight flight = flightOf(made, 4);
    double size = 0.0;
    MotionOptions options;
    for (const DisturbanceBound& bound : boundDisturbance({motionOf(flight.signals, options)}, options, {}))
      size = std::max({size, -bound.least, bound.greatest});
    return size;
  };
  const double calm = greatest({});
  EXPECT_LT(greatest(with(&MadeStretches::tumbles, 4.0)), 1.2 * calm);
  EXPECT_LT(greatest(with(&MadeStretches::tumbles, 4.0, false)), 1.2 * calm);
}

TEST(FlightPhases, ClausesGroupTimesByReason) {
  const std::vector<std::string> clauses =
      clausesOn({{{0.0, 2.0}, "ground"}, {{3.0, 4.5}, "upset"}, {{7.0, 9.0}, "ground"}});
  ASSERT_EQ(clauses.size(), 2u);
  EXPECT_EQ(clauses[0], "0.0 .. 2.0, 7.0 .. 9.0 s: ground");
  EXPECT_EQ(clauses[1], "3.0 .. 4.5 s: upset");
}

TEST(WindowsWithout, CutAndSplit) {
  const std::vector<TimeWindow> left = windowsWithout({{0.0, 10.0}}, {{{2.0, 3.0}, ""}, {{9.0, 12.0}, ""}});
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left[0].to, 2.0);
  EXPECT_EQ(left[1].from, 3.0);
  EXPECT_EQ(left[1].to, 9.0);
}

}  // namespace
}  // namespace polyfly
