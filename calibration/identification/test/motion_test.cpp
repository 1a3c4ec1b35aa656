#include "identification/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "identification/motion_output.hpp"
#include "identification/several_motions.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kMass = 1.52;       // [kg]
constexpr double kGravity = 9.8066;  // [m/s^2]

struct MadeMotion {
  double duration = 120.0;               // [s]
  Eigen::Vector3d drag{0.3, 0.2, 0.15};  // [1/s]
  // Standard deviation of the disturbance, correlated over 0.5 s [m/s^2].
  double gust = 0.2;
  // Standard deviation of the velocity noise [m/s].
  double noise = 0.005;
  // Step of the disturbance along x in the second half [m/s^2].
  double step = 0.0;
  // True: the drag acts along heading, left and up of the body.
  bool drag_turns = false;
};

// A multirotor that tilts and turns, by Euler's method in small steps; yaw wraps. `gusts` are the
// disturbances along x.
FlightSignals makeMotion(const MadeMotion& made, std::uint32_t seed, std::vector<double>* gusts = nullptr) {
  constexpr double kStep = 1e-3;
  constexpr int kEach = 10;
  constexpr double kMemory = 0.5;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  FlightSignals signals;
  signals.source = "made motion";
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d disturbance = Eigen::Vector3d::Zero();
  const auto put = [&signals](const char* name, double time, double value) {
    signals.series[name].time.push_back(time);
    signals.series[name].value.push_back(value);
  };
  for (int i = 0; i < static_cast<int>(made.duration / kStep); ++i) {
    const double t = i * kStep;
    const double roll = 0.15 * std::sin(0.9 * t) + 0.05 * std::sin(2.3 * t);
    const double pitch = 0.12 * std::sin(1.1 * t + 1.0);
    const double yaw = std::remainder(0.3 * t, 2.0 * 3.14159265358979);
    const double thrust = kMass * kGravity * (1.0 + 0.1 * std::sin(0.7 * t));
    // Third column of Rz(yaw) Ry(pitch) Rx(roll), written out.
    const Eigen::Vector3d up(
        std::cos(yaw) * std::sin(pitch) * std::cos(roll) + std::sin(yaw) * std::sin(roll),
        std::sin(yaw) * std::sin(pitch) * std::cos(roll) - std::cos(yaw) * std::sin(roll),
        std::cos(pitch) * std::cos(roll));
    const Eigen::Vector3d more(t > 0.5 * made.duration ? made.step : 0.0, 0.0, 0.0);
    if (i % kEach == 0) {
      put("roll", t, roll);
      put("pitch", t, pitch);
      put("yaw", t, yaw);
      put("thrust_cmd", t, thrust);
      put("vx", t, velocity.x() + made.noise * normal(random));
      put("vy", t, velocity.y() + made.noise * normal(random));
      put("vz", t, velocity.z() + made.noise * normal(random));
      if (gusts != nullptr) gusts->push_back(disturbance.x() + more.x());
    }
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    if (made.drag_turns) turn << std::cos(yaw), -std::sin(yaw), 0, std::sin(yaw), std::cos(yaw), 0, 0, 0, 1;
    velocity += kStep * (thrust / kMass * up - Eigen::Vector3d(0.0, 0.0, kGravity) -
                         turn * made.drag.asDiagonal() * turn.transpose() * velocity + disturbance + more);
    for (double& one : disturbance) {
      one += -one * kStep / kMemory + made.gust * std::sqrt(2.0 * kStep / kMemory) * normal(random);
    }
  }
  return signals;
}

TEST(Motion, FindsTheDragOfTheRotorsAlongTheBody) {
  int inside = 0;
  constexpr int kFlights = 20;
  for (std::uint32_t seed = 1; seed <= kFlights; ++seed) {
    MadeMotion made;
    made.gust = 0.03;
    made.drag_turns = true;
    const auto found = fitDrag(motionOf(makeMotion(made, seed), {})).parameters;
    ASSERT_EQ(found.size(), 6u);
    for (const std::size_t axis : {0u, 1u}) {
      const FittedParameter& drag = found[4 + axis];
      EXPECT_EQ(drag.name, axis == 0 ? "drag_forward" : "drag_left");
      const double truth = made.drag[static_cast<Eigen::Index>(axis)];
      inside += drag.least() <= truth && truth <= drag.greatest() ? 1 : 0;
      EXPECT_NEAR(drag.value, truth, 0.02);
      EXPECT_TRUE(drag.supported);
    }
  }
  EXPECT_GE(inside, 2 * kFlights * 9 / 10);
}

TEST(Motion, FindsTheHeadingMisalignmentWithinItsInterval) {
  int inside = 0;
  constexpr int kFlights = 20;
  for (std::uint32_t seed = 1; seed <= kFlights; ++seed) {
    // The attitude tells a yaw that is less by `truth` than that of the motion.
    const double truth = 0.02 * static_cast<double>(seed) - 0.2;
    FlightSignals signals = makeMotion({}, seed);
    for (double& yaw : signals.series["yaw"].value) yaw -= truth;
    const MotionFit fit = fitHeading(motionOf(signals, {}));
    const FittedParameter& angle = fit.parameters.front();
    EXPECT_EQ(angle.name, "heading_misalignment");
    EXPECT_TRUE(angle.supported);
    EXPECT_NEAR(angle.value, truth, 0.04);
    inside += angle.least() <= truth && truth <= angle.greatest() ? 1 : 0;
    const bool warned = !fit.warnings.empty();
    EXPECT_TRUE(warned || std::abs(truth) < 0.07) << truth;
    EXPECT_TRUE(!warned || std::abs(truth) > 0.001) << truth;
  }
  EXPECT_GE(inside, kFlights * 9 / 10 - 1);
}

TEST(Motion, TooLittleTiltTellsNoHeading) {
  FlightSignals signals = makeMotion({}, 1);
  for (const char* name : {"roll", "pitch"}) {
    for (double& value : signals.series[name].value) value *= 0.001;
  }
  const MotionFit fit = fitHeading(motionOf(signals, {}));
  EXPECT_FALSE(fit.parameters.front().supported);
  EXPECT_FALSE(fit.warnings.empty());
}

TEST(Motion, AHeadingThatDriftsOrAScaleThatIsOffIsNotSupported) {
  FlightSignals signals = makeMotion({}, 1);
  TimeSeries& yaw = signals.series["yaw"];
  for (std::size_t i = 0; i < yaw.time.size(); ++i) yaw.value[i] -= 0.003 * yaw.time[i];
  MotionFit fit = fitHeading(motionOf(signals, {}));
  EXPECT_FALSE(fit.parameters.front().supported);
  EXPECT_NE(fit.warnings.at(0).find("a heading drifts"), std::string::npos);
  signals = makeMotion({}, 1);
  for (const char* name : {"vx", "vy"}) {
    for (double& value : signals.series[name].value) value *= 3.28;
  }
  fit = fitHeading(motionOf(signals, {}));
  EXPECT_FALSE(fit.parameters.front().supported);
  EXPECT_NE(fit.warnings.at(0).find("of another unit"), std::string::npos);
}

// Without drag, about half of the estimates are negative, and none may be handed out.
TEST(Motion, ADragThatIsNotAboveZeroIsNotSupported) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    MadeMotion made;
    made.gust = 0.05;
    made.drag.setZero();
    const MotionFit fit = fitDrag(motionOf(makeMotion(made, seed), {}));
    for (const FittedParameter& one : fit.parameters) {
      const bool drag = one.name.rfind("drag", 0) == 0;
      EXPECT_TRUE(!drag || one.least() > 0.0 || !one.supported) << one.name;
    }
    EXPECT_FALSE(fit.warnings.empty());
  }
}

TEST(Motion, FindsDragWithinItsInterval) {
  int inside = 0;
  constexpr int kFlights = 20;
  for (std::uint32_t seed = 1; seed <= kFlights; ++seed) {
    MadeMotion made;
    made.gust = 0.03;  // calm air
    MotionOptions options;
    options.mass = kMass;
    const auto found = fitDrag(motionOf(makeMotion(made, seed), options)).parameters;
    ASSERT_EQ(found.size(), 8u);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const FittedParameter& drag = found[2 * axis];
      const double truth = made.drag[static_cast<Eigen::Index>(axis)];
      inside += drag.least() <= truth && truth <= drag.greatest() ? 1 : 0;
      EXPECT_NEAR(drag.value, truth, 0.02);
    }
  }
  // At least 54 of 60 intervals hold the true value.
  EXPECT_GE(inside, 54);
}

TEST(Motion, FindsDragWithoutAKnownThrust) {
  MadeMotion made;
  made.drag.z() = 0.0;
  made.gust = 0.02;
  FlightSignals signals = makeMotion(made, 2);
  signals.series.erase("thrust_cmd");
  const auto found = fitDrag(motionOf(signals, {})).parameters;
  ASSERT_EQ(found.size(), 6u);
  EXPECT_NEAR(found[0].value, made.drag.x(), 0.02);
  EXPECT_NEAR(found[2].value, made.drag.y(), 0.02);
  EXPECT_THROW(fitMass(motionOf(signals, {}), {}), Error);
}

TEST(Motion, FindsMassAndHoverThrust) {
  MadeMotion made;
  MotionOptions options;
  options.drag = made.drag;
  const auto found = fitMass(motionOf(makeMotion(made, 3), options), options).parameters;
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
    const auto bounds = boundDisturbance(motionOf(signals, options), options, limits);
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
  const auto brief = boundDisturbance(motionOf(makeMotion(made, 4), options), options, {});
  ASSERT_FALSE(brief[0].warnings.empty());
  EXPECT_NE(brief[0].warnings[0].find("Fly longer"), std::string::npos);
  EXPECT_LT(brief[0].confidence, 0.95);
  made.duration = 200.0;
  made.gust = 0.1;
  made.step = 1.0;
  const auto changed = boundDisturbance(motionOf(makeMotion(made, 5), options), options, {});
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
  const MotionFit drag = fitDrag(motionOf(signals, {}));
  EXPECT_GE(drag.warnings.size(), 1u);
}

TEST(Motion, TellsNoMassFromAShareOfFullThrust) {
  MadeMotion made;
  FlightSignals signals = makeMotion(made, 3);
  const double full = 2.0 * kMass * kGravity;
  for (double& value : signals.series["thrust_cmd"].value) value /= full;
  MotionOptions options;
  options.drag = made.drag;
  const MotionFit found = fitMass(motionOf(signals, options), options);
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
  const std::vector<MotionTrace> traces = disturbanceTraces(motion, options);
  ASSERT_EQ(traces.size(), 3u);
  const MotionFit drag = fitDrag(motion);
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < motion.time.size(); ++i) {
    before += std::pow(traces[0].measured[i] - traces[0].modelled[i], 2);
    after += std::pow(drag.traces[0].measured[i] - drag.traces[0].modelled[i], 2);
    EXPECT_EQ(drag.traces[0].depends[i], motion.velocity(static_cast<Eigen::Index>(i), 0));
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

// Circles through the air at 15 m/s that the airspeed sensor shows as 15 / scale.
FlightSignals makeCircles(double north, double east, double scale, double turns) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.2);
  FlightSignals signals;
  signals.source = "made circles";
  constexpr int kSamples = 1500;
  for (int i = 0; i < kSamples; ++i) {
    const double time = 0.1 * i;
    const double course = turns * 6.283185307 * i / kSamples;
    const double speed = 15.0 + std::sin(0.4 * time);
    const auto put = [&](const char* name, double value) {
      signals.series[name].time.push_back(time);
      signals.series[name].value.push_back(value + noise(random));
    };
    put("vn", speed * std::cos(course) + north);
    put("ve", speed * std::sin(course) + east);
    put("airspeed", speed / scale);
  }
  return signals;
}

TEST(Wind, FindsWindAndScaleOfTheAirspeed) {
  const WindFit found = fitWind(makeCircles(3.0, -5.0, 1.08, 3.0), {});
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_NEAR(found.parameters[0].value, 3.0, 0.1);
  EXPECT_NEAR(found.parameters[1].value, -5.0, 0.1);
  EXPECT_NEAR(found.parameters[2].value, 1.08, 0.01);
  for (const FittedParameter& parameter : found.parameters) EXPECT_GT(parameter.standard_error, 0.0);
  ASSERT_EQ(found.traces.size(), 1u);
  EXPECT_EQ(found.traces[0].measured.size(), found.north.size());
}

TEST(Wind, SaysWhereItTellsNothing) {
  const auto straight = fitWind(makeCircles(3.0, -5.0, 1.0, 0.2), {}).warnings;
  ASSERT_EQ(straight.size(), 1u);
  EXPECT_NE(straight[0].find("Fly circles"), std::string::npos);
  EXPECT_THROW(fitWind(makeCircles(0.0, 0.0, 1.0, 1.0), {{900.0, 901.0}}), Error);
  const auto knots = fitWind(makeCircles(3.0, -5.0, 0.514, 3.0), {}).warnings;
  ASSERT_EQ(knots.size(), 1u);
  EXPECT_NE(knots[0].find("another unit"), std::string::npos);
}

TEST(MotionOutput, HasTheFormOfProblemFiles) {
  MotionCalibration calibration;
  calibration.kind = "disturbance";
  DisturbanceBound bound;
  bound.axis = "y";
  bound.least = -0.3;
  bound.greatest = 0.25;
  calibration.bounds = {bound};
  EXPECT_NE(toYaml(calibration).find("  - {name: d_y, unit: m/s^2, range: [-0.3, 0.25]}\n"),
            std::string::npos);
}

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

TEST(Motion, ABoundBeyondGravityIsNotSupported) {
  MadeMotion made;
  made.gust = 8.0;
  const auto bounds = boundDisturbance(motionOf(makeMotion(made, 1), {}), {}, {});
  EXPECT_GT(bounds[0].greatest, kGravity);
  EXPECT_FALSE(bounds[0].supported);
  const auto& warnings = bounds[0].warnings;
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& sentence) {
    return sentence.find("beyond gravity") != std::string::npos;
  }));
}

}  // namespace
}  // namespace polyfly
