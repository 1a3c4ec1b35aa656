// One model of the motions of several flights.
#include "identification/several_motions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "made_motion.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

using test::kGravity;
using test::kMass;
using test::MadeMotion;
using test::makeMotion;

// Flights whose drag along x differs by a tenth (standard deviation).
std::vector<FlightSignals> makeFlightsOfOneVehicle(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<FlightSignals> flights;
  for (int i = 0; i < 3; ++i) {
    MadeMotion made;
    made.duration = 60.0;
    made.gust = 0.03;
    made.drag.x() *= 1.0 + 0.1 * normal(random);
    flights.push_back(makeMotion(made, random()));
    for (auto& [name, series] : flights.back().series) {
      for (double& time : series.time) time += 1e5 * i;
    }
  }
  return flights;
}

std::vector<Motion> motionsOf(const std::vector<FlightSignals>& flights, const MotionOptions& options) {
  std::vector<Motion> motions;
  for (const FlightSignals& flight : flights) motions.push_back(motionOf(flight, options));
  return motions;
}

TEST(SeveralMotions, IntervalsHoldTheMeanOfTheVehicle) {
  int inside = 0;
  MotionOptions options;
  options.mass = kMass;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto flights = makeFlightsOfOneVehicle(seed);
    const Motion joint = motionOf(joinFlights(flights).signals, options);
    const SeveralFit found = fitDragOf(joint, motionsOf(flights, options));
    ASSERT_EQ(found.flights.size(), 3u);
    const FittedParameter& drag = found.parameters[0];
    ASSERT_EQ(drag.name, "drag_x");
    const double truth = MadeMotion().drag.x();
    inside += drag.least() <= truth && truth <= drag.greatest() ? 1 : 0;
    EXPECT_LT(drag.half_width, truth);
    // The picture is that of the values that are told.
    const MotionTrace& trace = found.traces.front();
    EXPECT_DOUBLE_EQ(trace.modelled[7], found.parameters[1].value - drag.value * trace.depends[7]);
  }
  EXPECT_GE(inside, 18);
}

TEST(SeveralMotions, AreOneRecordOnOneClock) {
  const auto flights = makeFlightsOfOneVehicle(1);
  const JoinedFlights joined = joinFlights(flights);
  EXPECT_EQ(joined.signals.at("vx").time.front(), 0.0);
  EXPECT_LT(joined.signals.at("vx").time.back(), 400.0);
  const Motion joint = motionOf(joined.signals, {});
  EXPECT_EQ(joint.starts.size(), 4u);
  ASSERT_EQ(joined.spans.size(), 3u);
  EXPECT_GT(joined.spans[1].from, joined.spans[0].to);
  const auto bounds = boundDisturbance(joint, {}, {});
  EXPECT_GT(bounds[0].independent_samples,
            1.5 * boundDisturbance(motionOf(flights[0], {}), {}, {})[0].independent_samples);
}

TEST(SeveralMotions, LeaveOutOfEachWhatIsNoFlight) {
  auto flights = makeFlightsOfOneVehicle(1);
  flights[0].places = {"a", "b"};
  flights[1].places = {"b", "c"};
  flights[2].places = {"b"};
  const double start = flights[1].at("vx").time.front();
  flights[1].not_flight = {{{start + 5.0, start + 8.0}, "upset"}};
  const JoinedFlights joined = joinFlights(flights);
  EXPECT_EQ(joined.signals.places, std::vector<std::string>{"b"});
  const Motion motion = motionOf(joined.signals, {});
  const double from = joined.spans[1].from;
  EXPECT_TRUE(std::none_of(motion.time.begin(), motion.time.end(),
                           [from](double time) { return time > from + 5.01 && time < from + 7.99; }));
  EXPECT_TRUE(std::any_of(motion.time.begin(), motion.time.end(),
                          [from](double time) { return time > from + 9.0 && time < from + 10.0; }));
}

TEST(SeveralMotions, FindMassOrSayWhyNot) {
  auto flights = makeFlightsOfOneVehicle(2);
  const MotionOptions options;
  const SeveralFit found =
      fitMassOf(motionOf(joinFlights(flights).signals, options), motionsOf(flights, options), options);
  EXPECT_NEAR(found.parameters[0].value, kMass, 0.01);
  EXPECT_NEAR(found.parameters[1].value, kMass * kGravity, 0.1);
  EXPECT_EQ(found.parameters[0].name, "mass");
  flights[1].series.erase("thrust_cmd");
  EXPECT_THROW(
      fitMassOf(motionOf(joinFlights(flights).signals, options), motionsOf(flights, options), options),
      Error);
  flights = makeFlightsOfOneVehicle(2);
  flights[1].thrust_is_share = true;
  EXPECT_THROW(joinFlights(flights), Error);
}

}  // namespace
}  // namespace polyfly
