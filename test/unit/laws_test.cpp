// The laws in flight on the plant: equal where they solve the same problem, better where they should be, and
// switched without a bump.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_test/law_flight.hpp"
#include "region_maps/region_map.hpp"
#include "shipped_problems.hpp"
#include "solved_maps.hpp"

namespace polyfly {
namespace {

// Mass of plant and controllers [kg].
constexpr double kMass = 1.52;

/// Solved once for all tests.
const std::array<const RegionMap*, 3>& maps() {
  static const std::vector<RegionMap> kOpened = solvedMaps(shippedProblems(), "laws_test_");
  static const std::array<const RegionMap*, 3> kPointers{&kOpened[0], &kOpened[1], &kOpened[2]};
  return kPointers;
}

std::unique_ptr<ControlLaw> explicitLaw(const MultirotorOptions& options = {}) {
  return std::make_unique<MultirotorController>(maps(), options);
}
/// As the maps answer: with one reference for all stages.
std::unique_ptr<ControlLaw> linearLaw() {
  MultirotorOptions options;
  options.look_ahead = false;
  return std::make_unique<MultirotorController>(shippedProblems(), options);
}
std::unique_ptr<ControlLaw> lookingAhead() {
  return std::make_unique<MultirotorController>(shippedProblems(), MultirotorOptions());
}
std::unique_ptr<ControlLaw> nonlinearLaw() {
  return std::make_unique<NonlinearController>(MultirotorOptions(), NonlinearMpcOptions());
}

struct Flight {
  double rms = 0.0;       ///< position error [m]
  double greatest = 0.0;  ///< position error [m]
  int not_optimal = 0;    ///< samples
  std::vector<AttitudeCommand> commands;
};

struct Course {
  FigureOptions figure;
  PlantOptions plant;
  /// Offset of the start from the figure's start [m].
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  /// Time from which on errors count [s].
  double from = 0.0;
  double until = 1e9;
};

using OnSample = std::function<void(int sample, const VehicleState&, const Reference*, const ControlReport&)>;

template <class AnyLaw>
Flight fly(AnyLaw& law, const Course& course, const OnSample& on_sample = {}) {
  const FlightFigure figure(course.figure);
  LawFlight flown(figure, course.plant, law, course.offset);
  Flight flight;
  double sum = 0.0;
  int counted = 0;
  for (int sample = 0; !flown.over() && flown.time() < course.until - 1e-9; ++sample) {
    flown.measure();
    const ControlReport& report = law.step(flown.state(), flown.preview());
    flight.commands.push_back(report.command);
    flight.not_optimal += report.status == ControlStatus::kOptimal ? 0 : 1;
    if (on_sample) on_sample(sample, flown.state(), flown.preview(), report);
    law.prepare();
    flown.advance(flight.commands.back());
    const double error = flown.error();
    if (flown.time() < course.from) continue;
    sum += error * error;
    ++counted;
    flight.greatest = std::max(flight.greatest, error);
  }
  flight.rms = std::sqrt(sum / counted);
  return flight;
}

double difference(const AttitudeCommand& a, const AttitudeCommand& b) {
  return std::max({std::abs(a.roll - b.roll), std::abs(a.pitch - b.pitch), std::abs(a.yaw_rate - b.yaw_rate),
                   std::abs(a.thrust - b.thrust)});
}

PlantOptions noisy() {
  PlantOptions plant;
  plant.wind = {0.4, -0.3, 0.2};
  plant.gust_sigma = {0.2, 0.2, 0.1};
  plant.position_noise = 0.003;
  plant.velocity_noise = 0.01;
  plant.attitude_noise = 0.003;
  return plant;
}

TEST(Laws, LinearGivesTheCommandsOfTheMaps) {
  int at_limit = 0;
  for (const Eigen::Vector3d& offset : {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(2.5, -2.5, -2.0)}) {
    Course course;
    course.plant = noisy();
    course.offset = offset;  // bounds are active on the way back
    const std::unique_ptr<ControlLaw> in_flight = linearLaw();
    const std::unique_ptr<ControlLaw> beside = explicitLaw();
    double greatest = 0.0;
    int outside = 0;
    const Flight flight =
        fly(*in_flight, course,
            [&](int, const VehicleState& state, const Reference* preview, const ControlReport& report) {
              const ControlReport& other = beside->step(state, preview);
              outside += other.status == ControlStatus::kOptimal ? 0 : 1;
              greatest = std::max(greatest, difference(report.command, other.command));
              at_limit += std::abs(report.axis[0].input) > 0.4363 || report.axis[2].input > 10.19 ? 1 : 0;
            });
    EXPECT_GT(flight.commands.size(), 3000U);
    EXPECT_EQ(flight.not_optimal, 0);
    EXPECT_EQ(outside, 0);
    EXPECT_LT(greatest, 1e-6);
  }
  EXPECT_GT(at_limit, 20);
}

// Also where the trajectory asks for more than the maps' box holds, and from far away.
TEST(Laws, ExplicitFliesAsLinearDoesBeyondItsMaps) {
  int outside = 0;
  for (const double rate : {0.53, 0.9}) {
    for (const double offset : {0.0, 8.0}) {
      Course course;
      course.figure.rate = rate;
      course.plant = noisy();
      course.offset.x() = offset;
      const Flight online = fly(*linearLaw(), course);
      const Flight mapped =
          fly(*explicitLaw(), course, [&](int, const auto&, const auto*, const auto& report) {
            outside += report.reason == ControlReason::kOutsideBox ? 1 : 0;
          });
      ASSERT_EQ(online.commands.size(), mapped.commands.size());
      double greatest = 0.0;
      for (std::size_t i = 0; i < online.commands.size(); ++i)
        greatest = std::max(greatest, difference(online.commands[i], mapped.commands[i]));
      EXPECT_LT(greatest, 1e-6) << rate << ' ' << offset;
      EXPECT_EQ(mapped.not_optimal, 0);
    }
  }
  EXPECT_GT(outside, 500);
}

TEST(Laws, BeyondTheBoxOfTheMapsTheReportSaysWhatWasDone) {
  VehicleState state;
  Reference reference;
  reference.position.x() = 8.0;
  const ControlReport linear = linearLaw()->step(state, &reference);
  EXPECT_EQ(linear.status, ControlStatus::kOptimal);
  EXPECT_EQ(linear.reason, ControlReason::kNone);
  EXPECT_GT(linear.command.pitch, 0.3);

  const ControlReport solved = explicitLaw()->step(state, &reference);
  EXPECT_EQ(solved.status, ControlStatus::kOptimal);
  EXPECT_EQ(solved.reason, ControlReason::kOutsideBox);
  EXPECT_EQ(solved.axis[0].lookup, LookupStatus::kOutsideBox);
  EXPECT_EQ(solved.axis[0].outside_parameter, 0);
  EXPECT_EQ(solved.axis[0].region, -1);
  EXPECT_GT(solved.axis[0].iterations, 0);
  EXPECT_EQ(solved.axis[1].iterations, 0);
  EXPECT_GE(solved.axis[1].region, 0);

  MultirotorOptions options;
  options.solve_outside = false;
  const ControlReport clipped = explicitLaw(options)->step(state, &reference);
  EXPECT_EQ(clipped.status, ControlStatus::kClipped);
  EXPECT_EQ(clipped.axis[0].iterations, 0);
}

TEST(Laws, NonlinearTracksAtLeastAsWellAsLinearAndMuchBetterWhenPushed) {
  MultirotorOptions options;
  options.look_ahead = false;
  for (const double rate : {0.4, 0.53, 0.7, 0.9}) {
    Course course;
    course.figure.rate = rate;
    MultirotorController linear_law(shippedProblems(), options);
    NonlinearController nonlinear_law(options, {});
    const Flight linear = fly(linear_law, course);
    const Flight nonlinear = fly(nonlinear_law, course);
    EXPECT_EQ(nonlinear.not_optimal, 0);
    // In a slow figure both laws leave half a millimetre; what remains between them is less than a tenth.
    EXPECT_LE(nonlinear.rms, linear.rms + 1e-4) << "rate " << rate;
    EXPECT_LT(nonlinear.greatest, 0.05) << "rate " << rate;
    if (rate < 0.6) {
      EXPECT_LT(nonlinear.rms, 7e-4) << "rate " << rate;
    } else {
      EXPECT_LT(nonlinear.rms, (rate == 0.9 ? 0.3 : 0.6) * linear.rms) << "rate " << rate;
    }
  }
}

TEST(Laws, TheRateOfTheDisturbanceHelpsLinearAndLeavesNonlinearAsItIs) {
  const MultirotorOptions constant;
  MultirotorOptions following;
  following.disturbance_rate_drift = 0.03;
  for (const double rate : {0.53, 0.9}) {
    Course course;
    course.figure.rate = rate;
    MultirotorController linear(shippedProblems(), constant), linear_with(shippedProblems(), following);
    NonlinearController nonlinear(constant, {}), nonlinear_with(following, {});
    EXPECT_LT(fly(linear_with, course).rms, 0.85 * fly(linear, course).rms) << "rate " << rate;
    EXPECT_LT(fly(nonlinear_with, course).rms, fly(nonlinear, course).rms + 1e-4) << "rate " << rate;
  }
}

TEST(Laws, NonlinearTracksNoWorseInGustsAndNoise) {
  Course course;
  course.plant = noisy();
  for (const int seed : {1, 2, 3}) {
    course.plant.seed = seed;
    EXPECT_LT(fly(*nonlinearLaw(), course).rms, fly(*linearLaw(), course).rms) << "seed " << seed;
  }
}

// A figure that the model can follow is tracked alike. Its measured corners are in online_controller/README.md.
TEST(Laws, LookAheadTracksTheFigureAsWell) {
  for (const double rate : {0.53, 0.9}) {
    Course course;
    course.figure.rate = rate;
    const Flight ahead = fly(*lookingAhead(), course);
    EXPECT_EQ(ahead.not_optimal, 0);
    const double one = fly(*linearLaw(), course).rms;
    RecordProperty("linear_" + std::to_string(rate),
                   std::to_string(1e3 * one) + " mm, ahead " + std::to_string(1e3 * ahead.rms));
    EXPECT_LT(ahead.rms, one) << rate;
  }
  Course gusts;
  gusts.plant = noisy();
  EXPECT_LT(fly(*lookingAhead(), gusts).rms, 1.01 * fly(*linearLaw(), gusts).rms);
}

TEST(Laws, ConstantWindLeavesNoOffset) {
  Course course;
  course.figure.settle_time = 30.0;
  course.from = 15.0;
  course.until = 20.0;
  // 3 N from every side.
  for (const Eigen::Vector3d& side :
       {Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(0.0, -1.0, 0.0), Eigen::Vector3d(0.0, 0.0, 1.0),
        Eigen::Vector3d(0.0, 0.0, -1.0), Eigen::Vector3d(1.0, 1.0, 1.0), Eigen::Vector3d(-1.0, 1.0, -1.0)}) {
    course.plant.wind = 3.0 * side.normalized() / kMass;
    EXPECT_LT(fly(*explicitLaw(), course).greatest, 0.002) << side.transpose();
    EXPECT_LT(fly(*linearLaw(), course).greatest, 0.002) << side.transpose();
    EXPECT_LT(fly(*nonlinearLaw(), course).greatest, 0.002) << side.transpose();
  }
  for (const Eigen::Vector3d& force : {Eigen::Vector3d(3.0, 0.0, 0.0), Eigen::Vector3d(-2.0, 2.0, 1.0)}) {
    course.plant.wind = force / kMass;
    NonlinearController nonlinear(MultirotorOptions{}, NonlinearMpcOptions{});
    EXPECT_LT(fly(nonlinear, course).greatest, 0.001);
    EXPECT_LT((kMass * nonlinear.observer().disturbance() - force).norm(), 0.02);
  }
}

// An inner loop of another gain than the model's, and a frame that is not aligned: no force explains them.
TEST(Laws, AnotherAttitudeLoopLeavesNoOffset) {
  Course course;
  course.figure.settle_time = 45.0;
  course.from = 30.0;
  course.until = 35.0;
  course.plant.wind = Eigen::Vector3d(2.0, -2.0, 1.0) / kMass;
  course.plant.roll_gain = 0.8;
  course.plant.pitch_gain = 1.0;
  course.plant.roll_offset = 0.03;
  course.plant.pitch_offset = -0.02;
  EXPECT_LT(fly(*explicitLaw(), course).greatest, 0.005);
  EXPECT_LT(fly(*linearLaw(), course).greatest, 0.005);
  EXPECT_LT(fly(*nonlinearLaw(), course).greatest, 0.005);
  MultirotorOptions without;
  without.trim_drift = 0.0;
  EXPECT_GT(fly(*explicitLaw(without), course).greatest, 0.02);
}

std::unique_ptr<LawSwitch> allLaws(Law first) {
  std::vector<std::unique_ptr<ControlLaw>> laws(lawTypes().size());
  laws[static_cast<std::size_t>(lawOfName("explicit_linear"))] = explicitLaw();
  laws[static_cast<std::size_t>(lawOfName("linear"))] = linearLaw();
  laws[static_cast<std::size_t>(lawOfName("nonlinear"))] = nonlinearLaw();
  return std::make_unique<LawSwitch>(std::move(laws), first, MultirotorOptions());
}

TEST(Laws, SwitchingInAHoverInWindDoesNotShow) {
  Course course;
  course.figure.settle_time = 40.0;
  course.from = 8.0;
  course.until = 20.0;
  course.plant.wind = Eigen::Vector3d(1.0, -1.5, 0.5) / kMass;
  const std::unique_ptr<LawSwitch> laws = allLaws(lawOfName("linear"));
  const Law order[] = {lawOfName("nonlinear"), lawOfName("explicit_linear"), lawOfName("nonlinear"),
                       lawOfName("linear")};
  const Flight flight = fly(*laws, course, [&](int sample, const auto&...) {
    if (sample >= 1000 && sample % 200 == 0) laws->select(order[(sample - 1000) / 200 % 4]);
  });
  double greatest = 0.0;
  for (std::size_t i = 1000; i < flight.commands.size(); ++i) {
    greatest = std::max(greatest, difference(flight.commands[i], flight.commands[i - 1]));
  }
  EXPECT_EQ(flight.not_optimal, 0);
  EXPECT_LT(greatest, 0.01);  // rad, rad/s, N
  EXPECT_LT(flight.greatest, 0.01);
}

TEST(Laws, SwitchingOnTheWayKeepsTheTrack) {
  const Course course;
  const std::unique_ptr<LawSwitch> laws = allLaws(lawOfName("explicit_linear"));
  const Flight steady = fly(*explicitLaw(), course);
  const Flight switched = fly(*laws, course, [&](int sample, const auto&...) {
    if (sample % 150 == 149)
      laws->select(static_cast<Law>(sample / 150 % static_cast<int>(lawTypes().size())));
  });
  EXPECT_EQ(switched.not_optimal, 0);
  EXPECT_LT(switched.greatest, 1.5 * steady.greatest);
}

TEST(Laws, TheirNamesAreKnown) {
  for (const char* name : {"explicit_linear", "linear", "nonlinear", "robust_explicit"})
    EXPECT_EQ(std::string(lawName(lawOfName(name))), name);
  EXPECT_THROW(lawOfName("robust"), Error);
  std::vector<std::unique_ptr<ControlLaw>> only(2);
  only[1] = linearLaw();
  LawSwitch laws(std::move(only), lawOfName("linear"), MultirotorOptions());
  EXPECT_FALSE(laws.select(lawOfName("nonlinear")));
  EXPECT_EQ(laws.active(), lawOfName("linear"));
  EXPECT_THROW(LawSwitch(nullptr, MultirotorOptions()), Error);
}

TEST(Laws, NonlinearHoldsLevelsAndRecovers) {
  Course course;
  const auto law = std::make_unique<LawSwitch>(nonlinearLaw(), MultirotorOptions());
  const FlightFigure figure(course.figure);
  LawFlight flown(figure, course.plant, *law);
  double worst = 0.0;
  for (int sample = 0; sample < 2500; ++sample) {
    flown.measure();
    const bool broken = sample % 500 >= 400 && sample % 500 < 415;
    if (broken) flown.state().velocity.x() = sample % 2 == 0 ? std::nan("") : 1e9;
    const AttitudeCommand before = law->report().command;
    const ControlReport& report = law->step(flown.state(), flown.preview());
    const int fault = sample % 500 - 400;
    const ControlStatus expected = !broken      ? ControlStatus::kOptimal
                                   : fault < 10 ? ControlStatus::kHoldLast
                                                : ControlStatus::kLevel;
    ASSERT_EQ(report.status, expected) << "sample " << sample;
    if (broken) {
      EXPECT_EQ(report.reason, ControlReason::kNotFinite);
      if (expected == ControlStatus::kHoldLast) {
        EXPECT_EQ(difference(before, report.command), 0.0);
      }
    }
    EXPECT_LE(std::abs(report.command.roll), 0.4363323);
    EXPECT_LE(std::abs(report.command.pitch), 0.4363323);
    EXPECT_GE(report.command.thrust, 5.0 * kMass);
    EXPECT_LE(report.command.thrust, 20.0 * kMass);
    law->prepare();
    flown.advance(report.command);
    worst = std::max(worst, flown.error());
  }
  EXPECT_LT(worst, 0.1);
  EXPECT_EQ(law->onSilence(30.0).status, ControlStatus::kLevel);
  EXPECT_EQ(law->stepWithoutReference(31.0).status, ControlStatus::kNoReference);
}

// Whatever the bound, the figure is tracked as without it: where the search is ended early its point is
// flown, and hardly ever is there none.
TEST(Laws, NonlinearFliesWhatItHasWhenItsSearchIsEndedEarly) {
  Course course;
  course.figure.rate = 0.9;
  course.plant = noisy();
  course.offset = {2.5, -2.5, -2.0};  // bounds are active on the way back
  const Flight unhurried = fly(*nonlinearLaw(), course);
  for (const int working_sets : {1, 2}) {
    NonlinearMpcOptions mpc;
    mpc.working_sets_max = working_sets;
    NonlinearController law(MultirotorOptions{}, mpc);
    int early = 0, without = 0;
    const Flight flight = fly(law, course, [&](int, const auto&, const auto*, const ControlReport& report) {
      without += isAnswer(report.status) ? 0 : 1;
      early += report.status == ControlStatus::kSuboptimal ? 1 : 0;
      // The working set that was begun counts too.
      EXPECT_LE(report.iterations, working_sets + 1);
      EXPECT_LE(std::abs(report.command.roll), 0.4363323);
      EXPECT_LE(std::abs(report.command.pitch), 0.4363323);
      EXPECT_GE(report.command.thrust, 5.0 * kMass);
      EXPECT_LE(report.command.thrust, 20.0 * kMass);
    });
    EXPECT_EQ(flight.not_optimal, early + without);
    EXPECT_LE(without, 10) << working_sets;
    EXPECT_GT(early, 10) << working_sets;
    EXPECT_LT(flight.rms, 1.02 * unhurried.rms) << working_sets;
  }
}

TEST(Laws, NonlinearTakesJumpsAndGapsAndAnotherFlight) {
  const std::unique_ptr<ControlLaw> law = nonlinearLaw();
  std::vector<Reference> preview(static_cast<std::size_t>(law->previewLength()));
  VehicleState state;
  const auto step = [&](double stamp, double x) {
    state.stamp = stamp;
    state.position.x() = x;
    const ControlReport& report = law->step(state, preview.data());
    law->prepare();
    return report;
  };
  for (int i = 0; i < 50; ++i) EXPECT_EQ(step(0.01 * i, 0.0).status, ControlStatus::kOptimal);
  EXPECT_LT(step(0.5, 20.0).command.pitch, -0.4);  // far away: back as fast as allowed
  EXPECT_EQ(step(0.51, 0.0).status, ControlStatus::kOptimal);
  EXPECT_EQ(step(0.58, 0.0).status, ControlStatus::kOptimal);  // samples lost
  EXPECT_EQ(step(90.0, 0.0).status, ControlStatus::kOptimal);  // a minute lost
  const ControlReport report = step(1.0, 0.0);                 // time went back
  EXPECT_EQ(report.status, ControlStatus::kOptimal);
  EXPECT_LT(std::abs(report.command.pitch), 0.01);
}

TEST(Laws, SameFlightSameBits) {
  Course course;
  course.until = 8.0;
  course.plant = noisy();
  for (const auto& make : {linearLaw, nonlinearLaw}) {
    const std::unique_ptr<ControlLaw> law = make();
    const Flight first = fly(*law, course);
    law->forget(LawMemory::kAll);
    const Flight second = fly(*law, course);
    ASSERT_EQ(first.commands.size(), second.commands.size());
    for (std::size_t i = 0; i < first.commands.size(); ++i) {
      ASSERT_EQ(difference(first.commands[i], second.commands[i]), 0.0) << "sample " << i;
    }
  }
}

}  // namespace
}  // namespace polyfly
