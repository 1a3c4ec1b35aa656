// Heading, mass and disturbance of made motions, and what is said of bad ones.
#include "identification/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "identification/motion_output.hpp"
#include "made_motion.hpp"
#include "polyfly_base/error.hpp"
#include "report/yaml.hpp"

namespace polyfly {
namespace {

using test::kGravity;
using test::kMass;
using test::MadeMotion;
using test::makeMotion;

TEST(Motion, FindsMassAndHoverThrust) {
  MadeMotion made;
  MotionOptions options;
  options.drag = made.drag;
  const auto found = fitMass({motionOf(makeMotion(made, 3), options)}, options).parameters;
  EXPECT_NEAR(found[0].value, kMass, 0.01 * kMass);
  EXPECT_LE(found[0].least(), kMass);
  EXPECT_GE(found[0].greatest(), kMass);
  EXPECT_NEAR(found[1].value, kMass * kGravity, 0.15);
}

TEST(Motion, BoundsTheDisturbance) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    MadeMotion made;
    made.duration = 200.0;
    std::vector<double> gusts;
    const FlightSignals signals = makeMotion(made, seed, &gusts);
    MotionOptions options;
    options.mass = kMass;
    options.drag = made.drag;
    BoundOptions limits;
    limits.share = 0.9;
    const auto bounds = boundDisturbance({motionOf(signals, options)}, options, limits);
    ASSERT_EQ(bounds.size(), 3u);
    // The truth: normal with this deviation. 1.645 of it on each side hold for 90 % of the time.
    EXPECT_GT(bounds[0].greatest, 1.645 * made.gust * 0.9);
    EXPECT_LT(bounds[0].greatest, 4.5 * made.gust);
    EXPECT_LT(bounds[0].least, -1.645 * made.gust * 0.9);
    EXPECT_GE(bounds[0].confidence, 0.95);
    EXPECT_NEAR(bounds[0].deviation, made.gust, 0.35 * made.gust);
    const auto outside = std::count_if(gusts.begin(), gusts.end(), [&](double gust) {
      return gust < bounds[0].least || gust > bounds[0].greatest;
    });
    EXPECT_LT(static_cast<double>(outside) / static_cast<double>(gusts.size()), 0.1);
  }
}

TEST(Motion, SaysThatARecordIsShortOrUnsteady) {
  MadeMotion made;
  made.duration = 10.0;
  MotionOptions options;
  options.mass = kMass;
  options.drag = made.drag;
  const auto brief = boundDisturbance({motionOf(makeMotion(made, 4), options)}, options, {});
  ASSERT_FALSE(brief[0].warnings.empty());
  EXPECT_NE(brief[0].warnings[0].find("Fly longer"), std::string::npos);
  EXPECT_LT(brief[0].confidence, 0.95);
  made.duration = 200.0;
  made.gust = 0.1;
  made.step = 1.0;
  const auto changed = boundDisturbance({motionOf(makeMotion(made, 5), options)}, options, {});
  bool wanders = false;
  for (const std::string& sentence : changed[0].warnings)
    wanders |= sentence.find("wanders") != std::string::npos;
  EXPECT_TRUE(wanders);
}

TEST(Motion, SaysThatTheFrameIsWrong) {
  MadeMotion made;
  MotionOptions options;
  options.mass = kMass;
  options.drag = made.drag;
  FlightSignals signals = makeMotion(made, 6);
  EXPECT_TRUE(checkMotion(motionOf(signals, options)).empty());
  // Roll and pitch counted the other way round, as with y right and z down.
  for (double& value : signals.series["pitch"].value) value = -value;
  const auto wrong = checkMotion(motionOf(signals, options));
  ASSERT_FALSE(wrong.empty());
  EXPECT_NE(wrong[0].find("frame"), std::string::npos);
}

TEST(Motion, SaysThatTheVehicleStands) {
  FlightSignals signals = makeMotion({20.0, {0, 0, 0}, 0.1, 0.0, 0.0}, 6);
  for (auto& [name, series] : signals.series) {
    const bool angle = name == "roll" || name == "pitch" || name == "yaw";
    for (double& value : series.value) value = angle ? 0.05 : 0.001;
  }
  const auto warnings = checkMotion(motionOf(signals, {}));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("hardly moves"), std::string::npos);
  const MotionFit drag = fitDrag({motionOf(signals, {})});
  EXPECT_GE(drag.warnings.size(), 1u);
}

TEST(Motion, TellsNoMassFromAShareOfFullThrust) {
  MadeMotion made;
  FlightSignals signals = makeMotion(made, 3);
  const double full = 2.0 * kMass * kGravity;
  for (double& value : signals.series["thrust_cmd"].value) value /= full;
  MotionOptions options;
  options.drag = made.drag;
  const MotionFit found = fitMass({motionOf(signals, options)}, options);
  ASSERT_EQ(found.parameters.size(), 1u);
  EXPECT_EQ(found.parameters[0].name, "hover_command");
  EXPECT_NEAR(found.parameters[0].value, 0.5, 0.01);
  EXPECT_EQ(found.warnings.size(), 1u);
  options.mass = kMass;
  EXPECT_THROW(motionOf(signals, options), Error);
  options.newtons = true;  // a vehicle of less than 100 g
  EXPECT_NO_THROW(motionOf(signals, options));
}

TEST(Motion, TracesShowWhatTheModelLeaves) {
  MadeMotion made;
  MotionOptions options;
  options.mass = kMass;
  const Motion motion = motionOf(makeMotion(made, 7), options);
  const std::vector<MotionTrace> traces = traceDisturbance({motion}, options).traces;
  ASSERT_EQ(traces.size(), 3u);
  const MotionFit drag = fitDrag({motion});
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < motion.time.size(); ++i) {
    before += std::pow(traces[0].measured[i] - traces[0].modelled[i], 2);
    after += std::pow(drag.traces[0].measured[i] - drag.traces[0].modelled[i], 2);
  }
  EXPECT_LT(after, before);
}

TEST(Motion, NamesWhatIsMissing) {
  FlightSignals signals = makeMotion({10.0, {0, 0, 0}, 0.1, 0.0, 0.0}, 6);
  signals.series.erase("vx");
  EXPECT_THROW(motionOf(signals, {}), Error);
  signals = makeMotion({10.0, {0, 0, 0}, 0.1, 0.0, 0.0}, 6);
  MotionOptions options;
  options.windows = {{100.0, 200.0}};
  EXPECT_THROW(motionOf(signals, options), Error);
}

TEST(MotionOutput, HasTheFormOfProblemFiles) {
  MotionCalibration calibration;
  calibration.kind = "disturbance";
  DisturbanceBound bound;
  bound.axis = "y";
  bound.least = -0.3;
  bound.greatest = 0.25;
  calibration.bounds = {bound};
  EXPECT_NE(
      yamlText(jsonOf(calibration)).find("  - name: \"d_y\"\n    unit: \"m/s^2\"\n    range: [-0.3, 0.25]\n"),
      std::string::npos);
}

TEST(Motion, ABoundBeyondGravityIsNotSupported) {
  MadeMotion made;
  made.gust = 8.0;
  const auto bounds = boundDisturbance({motionOf(makeMotion(made, 1), {})}, {}, {});
  EXPECT_GT(bounds[0].greatest, kGravity);
  EXPECT_FALSE(bounds[0].supported);
  const auto& warnings = bounds[0].warnings;
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& sentence) {
    return sentence.find("beyond gravity") != std::string::npos;
  }));
}

// Three flights of one vehicle whose drag along x is not the same, each with a clock of its own.
std::vector<Motion> threeFlights(const MotionOptions& options) {
  std::vector<Motion> flights;
  for (const std::uint32_t flight : {1u, 2u, 3u}) {
    MadeMotion made;
    made.duration = 60.0;
    made.gust = 0.03;
    made.drag.x() *= 0.7 + 0.15 * flight;
    FlightSignals signals = makeMotion(made, flight);
    signals.source = "flight" + std::to_string(flight) + ".csv";
    for (auto& [name, series] : signals.series) {
      for (double& time : series.time) time += 1e5 * flight;
    }
    flights.push_back(motionOf(signals, options));
  }
  return flights;
}

TEST(SeveralMotions, GiveTheMeanOfTheirNumbers) {
  MotionOptions options;
  options.mass = kMass;
  const std::vector<Motion> flights = threeFlights(options);
  const MotionFit drag = fitDrag(flights);
  ASSERT_EQ(drag.flights.size(), 3u);
  const double truth = MadeMotion().drag.x();
  ASSERT_EQ(drag.parameters[0].name, "drag_x");
  EXPECT_NEAR(drag.parameters[0].value, truth, 0.02);
  EXPECT_GE(drag.parameters[0].half_width, 0.5 * (drag.flights[2][0].value - drag.flights[0][0].value));
  EXPECT_EQ(drag.traces.size(), 9u);
  EXPECT_EQ(drag.traces.front().name.find("flight1.csv: "), 0u);
  const MotionFit mass = fitMass(threeFlights({}), {});
  EXPECT_NEAR(mass.parameters[0].value, kMass, 0.01);
  EXPECT_NEAR(mass.parameters[1].value, kMass * kGravity, 0.1);
}

TEST(SeveralMotions, AreBoundedTogether) {
  const std::vector<Motion> flights = threeFlights({});
  EXPECT_GT(boundDisturbance(flights, {}, {})[0].independent_samples,
            1.5 * boundDisturbance({flights[0]}, {}, {})[0].independent_samples);
  EXPECT_EQ(traceDisturbance(flights, {}).traces.size(), 6u);
}

TEST(SeveralMotions, MustBeAlikeInTheirThrust) {
  std::vector<Motion> flights = threeFlights({});
  flights[1].lift_is_share = true;
  EXPECT_THROW(traceDisturbance(flights, {}), Error);
  EXPECT_THROW(fitMass(flights, {}), Error);
}

}  // namespace
}  // namespace polyfly
