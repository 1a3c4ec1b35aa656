// The laws over a dead time between odometry and command, in flight.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "allocations.hpp"
#include "helix.hpp"
#include "online_controller/flight/flight_supervisor.hpp"
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "polyfly_test/multirotor_plant.hpp"
#include "shipped_problems.hpp"
#include "solved_maps.hpp"
#include "solved_robust_maps.hpp"

namespace polyfly {
namespace {

using Eigen::Vector3d;

constexpr double kPeriod = 0.01;  // [s]

Path step() {
  return [](double time) {
    Reference reference;
    // Beyond the horizon at first; between two samples, whatever rounding does.
    if (time >= 4.0035) reference.position = {1.0, 0.6, 0.5};
    return reference;
  };
}

const std::vector<RegionMap>& maps() {
  static const std::vector<RegionMap> kOnce = solvedMaps(shippedProblems("look_ahead/"), "dead_time_test_");
  return kOnce;
}

std::unique_ptr<ControlLaw> lawOf(const std::string& name, const MultirotorOptions& options) {
  if (name == "nonlinear") return std::make_unique<NonlinearController>(options, NonlinearMpcOptions{});
  if (name == "linear") return std::make_unique<MultirotorController>(shippedProblems(), options);
  return std::make_unique<MultirotorController>(
      std::array<const RegionMap*, 3>{&maps()[0], &maps()[1], &maps()[2]}, options);
}

const std::array<std::string, 3> kNames{"linear", "explicit_linear", "nonlinear"};

std::unique_ptr<LawSwitch> switchOf(const std::string& name, double delay) {
  MultirotorOptions options;
  options.delay = delay;
  return std::make_unique<LawSwitch>(lawOf(name, options), options);
}

struct Flown {
  double rms = 0.0;       ///< distance from the path [m]
  double greatest = 0.0;  ///< the same [m]
  std::vector<Vector3d> way;
};

/// What happens to the law before a sample; false: the sample is lost.
using OnSample = std::function<bool(int, std::unique_ptr<LawSwitch>&)>;

Flown fly(std::unique_ptr<LawSwitch> law, const Path& path, PlantOptions options, double delay,
          const OnSample& on_sample = {}, double from = 0.0) {
  constexpr double kSeconds = 16.0;
  options.command_delay = delay;
  PlantState start;
  start.position = path(0.0).position;
  start.thrust = options.gravity;
  MultirotorPlant plant(options, start);
  std::vector<Reference> preview(64);
  Flown flown;
  AttitudeCommand sent{0.0, 0.0, 0.0, options.mass * options.gravity};
  int counted = 0;
  for (int sample = 0; plant.time() < kSeconds - 0.5 * kPeriod; ++sample) {
    const VehicleState state = plant.measure();
    if (!on_sample || on_sample(sample, law)) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(law->previewLength()); ++k)
        preview[k] = path(state.stamp + law->lead() + static_cast<double>(k) * law->previewPeriod());
      sent = law->step(state, preview.data()).command;
      law->prepare();
    }
    plant.advance(sent);
    flown.way.push_back(plant.state().position);
    if (plant.time() < from) continue;
    const double error = (plant.state().position - path(plant.time()).position).norm();
    flown.rms += error * error;
    flown.greatest = std::max(flown.greatest, error);
    ++counted;
  }
  flown.rms = std::sqrt(flown.rms / counted);
  return flown;
}

Flown fly(const std::string& law, const Path& path, const PlantOptions& plant, double delay, double told) {
  return fly(switchOf(law, told), path, plant, delay);
}

double between(const Flown& a, const Flown& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.way.size(); ++i) sum += (a.way[i] - b.way[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.way.size()));
}

// 47 ms are no whole number of periods.
TEST(DeadTimeFlights, CostAtMostAThirdOfWhatTheyCostUncompensated) {
  const std::pair<const char*, Path> paths[] = {{"circle", helix(8.0, 5.0, 0.0)},
                                                {"helix", helix(1.5, 1.5, 0.3)}};
  for (const auto& [name, path] : paths) {
    for (const std::string& law : kNames) {
      const double none = fly(law, path, {}, 0.0, 0.0).rms;
      for (const double delay : {0.03, 0.047, 0.06, 0.1}) {
        const double without = fly(law, path, {}, delay, 0.0).rms,
                     with = fly(law, path, {}, delay, delay).rms;
        RecordProperty(law + "_" + name + "_" + std::to_string(std::lround(1000.0 * delay)),
                       std::to_string(none) + " " + std::to_string(without) + " " + std::to_string(with));
        EXPECT_GT(without, 1.03 * none) << law << ", " << name << ", " << delay;
        EXPECT_LT(with - none, (without - none) / 3.0) << law << ", " << name << ", " << delay;
      }
    }
  }
}

// A delay brings the foresight of a step nearer to its best, so the measure is the flight without one. Whole periods: else
// the decisions fall to other times after the step.
TEST(DeadTimeFlights, AStepIsFlownAsWithoutIt) {
  for (const std::string& law : kNames) {
    const Flown none = fly(law, step(), {}, 0.0, 0.0);
    for (const double delay : {0.03, 0.06, 0.1}) {
      const Flown without = fly(law, step(), {}, delay, 0.0), with = fly(law, step(), {}, delay, delay);
      EXPECT_LT(between(with, none), between(without, none) / 3.0) << law << ", " << delay;
    }
  }
}

TEST(DeadTimeFlights, NoiseDoesNotChangeThat) {
  PlantOptions noisy;
  noisy.position_noise = 0.005;
  noisy.velocity_noise = 0.02;
  noisy.attitude_noise = 0.005;
  const Path path = helix(8.0, 5.0, 0.0);
  for (const std::string& law : kNames) {
    const double none = fly(law, path, noisy, 0.0, 0.0).rms, unknown = fly(law, path, noisy, 0.06, 0.0).rms;
    const double told = fly(law, path, noisy, 0.06, 0.06).rms;
    RecordProperty(law + "_circle_noise",
                   std::to_string(none) + " " + std::to_string(unknown) + " " + std::to_string(told));
    EXPECT_LT(told - none, (unknown - none) / 3.0) << law;
  }
}

TEST(DeadTimeFlights, AHoverStaysQuietWhereTheDelayIsNotAsTold) {
  PlantOptions noisy;
  noisy.position_noise = 0.005;
  noisy.velocity_noise = 0.02;
  noisy.attitude_noise = 0.005;
  const Path hover = [](double) { return Reference{}; };
  for (const std::string& law : kNames) {
    const double none = fly(law, hover, noisy, 0.0, 0.0).rms;
    for (const double told : {0.06, 0.1}) {
      for (const double share : {0.7, 1.3}) {
        const double rms = fly(law, hover, noisy, share * told, told).rms;
        RecordProperty("hover_" + law + "_" + std::to_string(std::lround(1000.0 * told)) +
                           (share < 1.0 ? "_less" : "_more"),
                       std::to_string(none) + " " + std::to_string(rms));
        EXPECT_LT(rms, 1.4 * none) << law << ", " << told << ", " << share;
      }
    }
  }
}

// A constant wind, a gain that is wrong and a loop that is not level: what is left is the trim's, which settles for long.
TEST(DeadTimeFlights, LeaveNoOffset) {
  PlantOptions plant;
  plant.wind = {1.0, -0.7, 0.5};
  plant.roll_gain = 1.0;
  plant.roll_offset = 0.03;
  const Path hover = [](double) { return Reference{}; };
  for (const std::string& law : kNames)
    EXPECT_LT(fly(switchOf(law, 0.06), hover, plant, 0.06, {}, 14.0).greatest, 4e-3) << law;
}

TEST(DeadTimeFlights, LostSamplesDoNotChangeWhatItBrings) {
  const Path path = helix(8.0, 5.0, 0.0);
  // Every third sample, and a quarter of a second twice. The vehicle keeps the last command.
  const OnSample lossy = [](int sample, std::unique_ptr<LawSwitch>&) {
    return sample % 3 != 1 && sample % 600 >= 25;
  };
  for (const std::string& law : kNames) {
    const double none = fly(switchOf(law, 0.0), path, {}, 0.0, lossy).rms;
    const double without = fly(switchOf(law, 0.0), path, {}, 0.06, lossy).rms;
    const double with = fly(switchOf(law, 0.06), path, {}, 0.06, lossy).rms;
    EXPECT_LT(with - none, (without - none) / 3.0) << law << " " << none << " " << without << " " << with;
  }
}

// In silence level commands are sent; they act after the delay as the others do.
TEST(DeadTimeFlights, GoesOnAfterSilence) {
  const Path path = helix(8.0, 5.0, 0.0);
  for (const std::string& law : kNames) {
    const auto silent = [](int sample) { return sample >= 800 && sample < 830; };
    const OnSample on_sample = [&](int sample, std::unique_ptr<LawSwitch>& laws) {
      if (silent(sample)) laws->onSilence(kPeriod * sample);
      return !silent(sample);
    };
    const Flown flown = fly(switchOf(law, 0.06), path, {}, 0.06, on_sample, 12.0);
    const Flown calm = fly(switchOf(law, 0.06), path, {}, 0.06, {}, 12.0);
    EXPECT_LT(flown.greatest, calm.greatest + 0.02) << law;
  }
}

TEST(DeadTimeFlights, MayBeToldInFlight) {
  const Path path = helix(8.0, 5.0, 0.0);
  for (const std::string& law : kNames) {
    const OnSample tell = [&](int sample, std::unique_ptr<LawSwitch>& laws) {
      if (sample != 800 && sample != 1400) return true;
      std::unique_ptr<LawSwitch> next = switchOf(law, sample == 800 ? 0.06 : 0.0);
      next->transferState(*laws);
      laws = std::move(next);
      return true;
    };
    const Flown told = fly(switchOf(law, 0.0), path, {}, 0.06, tell);
    const Flown never = fly(law, path, {}, 0.06, 0.0), always = fly(law, path, {}, 0.06, 0.06);
    EXPECT_LT(told.greatest, 1.2 * std::max(never.greatest, always.greatest)) << law;
    // Between the changes the flight comes to be that with the delay known.
    const auto apart = [&](const Flown& other, std::size_t sample) {
      return (told.way[sample] - other.way[sample]).norm();
    };
    EXPECT_LT(apart(always, 1399), 0.25 * apart(never, 1399)) << law;
  }
}

const std::vector<RegionMap>& robustMaps() {
  static const std::vector<RegionMap> kOnce = aslquadMaps("dead_time_test_robust_");
  return kOnce;
}

// Within what its maps are made for. Its inputs are held for 0.08 s, which a delay of 0.06 s does not divide.
TEST(DeadTimeFlights, TheRobustLawIsHelpedAlike) {
  const std::vector<RegionMap>& opened = robustMaps();
  PlantOptions plant;
  plant.mass = 0.65;
  plant.roll_time = plant.pitch_time = 0.2;
  const auto flight = [&](double delay, double told, const Path& path) {
    MultirotorOptions options;
    options.mass = plant.mass;
    options.delay = told;
    auto law = std::make_unique<MultirotorController>(
        std::array<const RegionMap*, 3>{&opened[0], &opened[1], &opened[2]}, options);
    return fly(std::make_unique<LawSwitch>(std::move(law), options), path, plant, delay);
  };
  const Path helical = helix(1.5, 0.8, 0.05);
  const double none = flight(0.0, 0.0, helical).rms, without = flight(0.06, 0.0, helical).rms;
  const double with = flight(0.06, 0.06, helical).rms;
  RecordProperty("robust", std::to_string(none) + " " + std::to_string(without) + " " + std::to_string(with));
  EXPECT_LT(with - none, (without - none) / 3.0) << none << " " << without << " " << with;
}

TEST(DeadTimeFlights, InactiveLawsTrackWithoutABump) {
  MultirotorOptions options;
  options.delay = 0.06;
  std::vector<std::unique_ptr<ControlLaw>> laws(lawTypes().size());
  const Law linear = lawOfName("linear"), nonlinear = lawOfName("nonlinear");
  laws[static_cast<std::size_t>(linear)] = lawOf("linear", options);
  laws[static_cast<std::size_t>(nonlinear)] = lawOf("nonlinear", options);
  const OnSample change = [&](int sample, std::unique_ptr<LawSwitch>& flown) {
    if (sample % 200 == 199) flown->select(sample % 400 < 200 ? nonlinear : linear);
    return true;
  };
  const Path path = helix(8.0, 5.0, 0.0);
  const Flown both =
      fly(std::make_unique<LawSwitch>(std::move(laws), linear, options), path, {}, 0.06, change);
  EXPECT_LT(both.greatest, 1.1 * fly("linear", path, {}, 0.06, 0.06).greatest);
}

TEST(DeadTimeFlights, TheStepDoesNotAllocate) {
  for (const std::string& law : kNames) {
    const Path path = helix(8.0, 5.0, 0.0);
    const std::unique_ptr<LawSwitch> laws = switchOf(law, 0.06);
    std::vector<Reference> preview(64);
    VehicleState state;
    state.position = path(0.0).position;
    long allocations = 0;
    for (int sample = 0; sample < 200; ++sample) {
      state.stamp = kPeriod * sample;
      for (std::size_t k = 0; k < preview.size(); ++k)
        preview[k] = path(state.stamp + laws->lead() + static_cast<double>(k) * laws->previewPeriod());
      const long before = polyfly_test::allocationCount();
      laws->step(state, preview.data());
      laws->prepare();
      if (sample % 50 == 49) laws->onSilence(state.stamp + 0.001);
      allocations += polyfly_test::allocationCount() - before;
    }
    EXPECT_EQ(allocations, 0) << law;
  }
}

TEST(DeadTimeOption, ComesFromTheProblemsUnlessItIsStated) {
  std::array<MpcProblem, 3> stated = shippedProblems();
  const auto lead = [&](double option) {
    MultirotorOptions options;
    options.delay = option;
    return LawSwitch(std::make_unique<MultirotorController>(stated, options), options).lead();
  };
  EXPECT_EQ(lead(0.0), 0.0);
  EXPECT_EQ(lead(0.06), 0.06);
  stated[0].delay = 0.05;
  EXPECT_EQ(lead(0.0), 0.05);
  stated[1].delay = 0.07;
  EXPECT_DOUBLE_EQ(lead(0.0), 0.06);
  EXPECT_EQ(lead(0.1), 0.1);
  // The nonlinear law has no problems.
  const Law linear = lawOfName("linear"), nonlinear = lawOfName("nonlinear");
  std::vector<std::unique_ptr<ControlLaw>> laws(lawTypes().size());
  laws[static_cast<std::size_t>(nonlinear)] = lawOf("nonlinear", {});
  laws[static_cast<std::size_t>(linear)] =
      std::make_unique<MultirotorController>(stated, MultirotorOptions{});
  EXPECT_DOUBLE_EQ(LawSwitch(std::move(laws), nonlinear, {}).lead(), 0.06);
}

// Node and replay take their references from here.
TEST(DeadTimeOption, ReferencesAreThoseOfTheTimeOfTheCommand) {
  MultirotorOptions options;
  options.delay = 0.06;
  LawSwitch laws(lawOf("linear", options), options);
  FlightSupervisor flight(laws, options, FlightOptions{}, PilotRule::kNotRequired);
  std::vector<TrajectorySample> samples(2);
  samples[1].time = 10.0;
  for (TrajectorySample& sample : samples) {
    sample.position = {0.5 * sample.time, 0.0, 0.0};
    sample.velocity = {0.5, 0.0, 0.0};
    sample.has_velocity = true;
  }
  VehicleState state;
  state.stamp = 1.5;
  state.position.x() = 0.25;
  state.velocity.x() = 0.5;
  flight.onOdometry(state, true);
  flight.onReference(ReferenceTrajectory(samples), 1.0);
  state.stamp = 2.0;
  state.position.x() = 0.5;
  flight.onOdometry(state, true);
  EXPECT_NEAR(flight.preview().front().position.x(), 0.53, 1e-9);
  EXPECT_NEAR(flight.wholePreview()[1].position.x(), 0.58, 1e-9);
}

}  // namespace
}  // namespace polyfly
