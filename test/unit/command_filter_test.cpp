// The filter between a controller and the attitude controller, with maps that are solved here.
#include "online_controller/flight/command_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "allocations.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "online_controller/types/attitude.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/write_map.hpp"
#include "safety_filter/safe_set.hpp"
#include "scratch_folder.hpp"

namespace polyfly {
namespace {

constexpr double kPeriod = 0.1;
constexpr double kWind = 0.3;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Fence {
  std::string axis = "x";
  double delay = 0.0;
  double period = kPeriod;
  std::string unit = "m/s^2";
  double strength = 2.0;
  /// Of the attitude behind its command [s]. 0: none.
  double lag = 0.0;

  std::string text() const {
    std::ostringstream out;
    out << "polyfly_problem: 1\nname: fence_" << axis << "\ntype: safety_filter\nsampling_time: " << period
        << "\ndelay: " << delay << "\nmodel:\n  states:\n    - {name: p_" << axis
        << ", unit: m, range: [-2, 2]}\n    - {name: v_" << axis
        << ", unit: m/s, range: [-1.5, 1.5]}\n  inputs:\n    - {name: a_" << axis << ", unit: " << unit
        << ", range: [" << -strength << ", " << strength << "]}\n  disturbances:\n    - {name: w_" << axis
        << ", unit: m/s^2, range: [" << -kWind << ", " << kWind
        << "]}\n  A: [[0, 1], [0, 0]]\n  B: [[0], [1]]\n  B_d: [[0], [1]]\n";
    return out.str();
  }

  // The acceleration is the third state.
  std::string laggingText() const {
    std::ostringstream out;
    out << "polyfly_problem: 1\nname: fence_" << axis << "\ntype: safety_filter\nsampling_time: " << period
        << "\nmargin: 0.01\nmodel:\n  states:\n    - {name: p_" << axis
        << ", unit: m, range: [-2, 2]}\n    - {name: v_" << axis
        << ", unit: m/s, range: [-1.5, 1.5]}\n    - {name: a_" << axis << ", unit: m/s^2, range: ["
        << -strength - 0.5 << ", " << strength + 0.5 << "]}\n  inputs:\n    - {name: a_" << axis
        << "_cmd, unit: m/s^2, range: [" << -strength << ", " << strength
        << "]}\n  disturbances:\n    - {name: w_" << axis << ", unit: m/s^2, range: [" << -kWind << ", "
        << kWind << "]}\n  A: [[0, 1, 0], [0, 0, 1], [0, 0, " << -1.0 / lag << "]]\n  B: [[0], [0], ["
        << 1.0 / lag << "]]\n  B_d: [[0], [1], [0]]\n";
    return out.str();
  }
};

class CommandFilterTest : public ::testing::Test {
 protected:
  RegionMap map(const Fence& fence) {
    const std::string file = scratch_.file("fence_" + std::to_string(++count_));
    const SafetyFilterProblem given =
        parseSafetyFilter(fence.lag > 0.0 ? fence.laggingText() : fence.text(), "fence.yaml");
    const ParametricProgram program =
        filterProgram(parseSafetyFilter(withSafeSet(given, computeSafeSet(given)), "fence.yaml"));
    writeMap(encode(program, explore(program)), file);
    return RegionMap::open(file);
  }
  std::vector<RegionMap> fences(double delay = 0.0) {
    std::vector<RegionMap> maps;
    for (const char* axis : {"x", "y", "z"}) maps.push_back(map({axis, delay}));
    return maps;
  }

  MultirotorOptions options_;
  ScratchFolder scratch_;
  int count_ = 0;
};

AttitudeCommand hover(const MultirotorOptions& options) {
  AttitudeCommand command;
  command.thrust = options.mass * options.gravity;
  return command;
}

// The vehicle as its maps see it: the command is the acceleration that it makes at this yaw.
Eigen::Vector3d acceleration(const AttitudeCommand& command, double yaw, const MultirotorOptions& options) {
  const double f = command.thrust / options.mass;
  const double forward = f * std::sin(command.pitch) * std::cos(command.roll);
  const double left = -f * std::sin(command.roll);
  return {std::cos(yaw) * forward - std::sin(yaw) * left, std::sin(yaw) * forward + std::cos(yaw) * left,
          f * std::cos(command.pitch) * std::cos(command.roll) - options.gravity};
}

TEST_F(CommandFilterTest, PassesSafeCommandsBitForBit) {
  CommandFilter filter(fences(), options_);
  AttitudeCommand wish = hover(options_);
  wish.roll = 0.01;
  wish.pitch = -0.02;
  wish.yaw_rate = 0.7;
  VehicleState state;
  state.attitude = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ());
  const FilterReport& report = filter.step(state, wish);
  EXPECT_EQ(report.status, FilterStatus::kPassed);
  EXPECT_EQ(report.command.roll, wish.roll);
  EXPECT_EQ(report.command.pitch, wish.pitch);
  EXPECT_EQ(report.command.thrust, wish.thrust);
  EXPECT_EQ(report.command.yaw_rate, wish.yaw_rate);
  EXPECT_EQ(filter.period(), kPeriod);
}

// Wishes of a controller gone wild, at any yaw, in the worst wind. Without the filter they leave at once.
TEST_F(CommandFilterTest, KeepsTheFenceAgainstAWildController) {
  for (const double delay : {0.0, 0.04}) {
    CommandFilter filter(fences(delay), options_);
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    VehicleState state;
    Eigen::Vector3d before = Eigen::Vector3d::Zero();
    int changed = 0;
    double farthest = 0.0;
    AttitudeCommand wish;
    for (int k = 0; k < 3000; ++k) {
      const double yaw = 0.01 * k;
      state.attitude = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                       Eigen::AngleAxisd(0.2 * unit(random), Eigen::Vector3d::UnitX());
      if (k % 20 == 0) wish = {unit(random), unit(random), unit(random), 15.0 + 14.0 * unit(random)};
      const FilterReport& report = filter.step(state, wish);
      ASSERT_LE(report.status, FilterStatus::kChanged) << "step " << k;
      if (report.status == FilterStatus::kChanged) ++changed;
      const double measured = eulerAngles(state.attitude).yaw;
      const Eigen::Vector3d a = acceleration(report.command, measured, options_);
      const Eigen::Vector3d wind =
          kWind * Eigen::Vector3d(unit(random) < 0 ? -1 : 1, unit(random) < 0 ? -1 : 1,
                                  state.position.z() < 0 ? -1 : 1);
      for (const auto& [input, time] : {std::pair(before, delay), std::pair(a, kPeriod - delay)}) {
        state.position += time * state.velocity + 0.5 * time * time * (input + wind);
        state.velocity += time * (input + wind);
        ASSERT_LE(state.position.cwiseAbs().maxCoeff(), 2.0) << "step " << k;
        ASSERT_LE(state.velocity.cwiseAbs().maxCoeff(), 1.5) << "step " << k;
      }
      before = a;
      farthest = std::max(farthest, state.position.cwiseAbs().maxCoeff());
    }
    EXPECT_GT(changed, 500);
    EXPECT_GT(farthest, 1.8);
  }
}

// A wild controller on a vehicle whose attitude follows its command with a lag, in the worst wind.
struct LaggingFlight {
  int changed = 0;
  int outside = 0;
  /// Of position and velocity, in parts of their ranges.
  double farthest = 0.0;
  /// Between the acceleration and what the filter took for it.
  double error = 0.0;  // [m/s^2]
};

constexpr double kLag = 0.2;

LaggingFlight flyWithLag(CommandFilter& filter, const MultirotorOptions& options) {
  LaggingFlight flight;
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double decay = std::exp(-kPeriod / kLag);
  double thrust = options.mass * options.gravity;
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), v = p, a = p;
  AttitudeCommand wish = hover(options);
  for (int k = 0; k < 3000; ++k) {
    const double x = a.x() * options.mass / thrust, y = a.y() * options.mass / thrust;
    const Eigen::Vector3d lift(x, y, std::sqrt(1.0 - x * x - y * y));
    VehicleState state;
    state.position = p;
    state.velocity = v;
    state.attitude = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), lift);
    if (k % 20 == 0) {
      wish.roll = 0.5 * unit(random);
      wish.pitch = 0.5 * unit(random);
    }
    const FilterReport& report = filter.step(state, wish);
    if (report.status == FilterStatus::kChanged) ++flight.changed;
    if (report.status == FilterStatus::kOutside) ++flight.outside;
    flight.error = std::max(
        {flight.error, std::abs(report.axes[0].xi[2] - a.x()), std::abs(report.axes[1].xi[2] - a.y())});
    thrust = report.command.thrust;
    const Eigen::Vector3d u = acceleration(report.command, eulerAngles(state.attitude).yaw, options);
    const Eigen::Vector3d wind =
        kWind * Eigen::Vector3d(unit(random) < 0 ? -1 : 1, unit(random) < 0 ? -1 : 1, 0.0);
    // The exact solution for a held command; z is not filtered, and stays.
    const Eigen::Vector3d left = a - u;
    p += kPeriod * v + 0.5 * kPeriod * kPeriod * (u + wind) + kLag * (kPeriod - kLag * (1.0 - decay)) * left;
    v += kPeriod * (u + wind) + kLag * (1.0 - decay) * left;
    a = u + decay * left;
    p.z() = v.z() = a.z() = 0.0;
    flight.farthest =
        std::max({flight.farthest, p.cwiseAbs().maxCoeff() / 2.0, v.cwiseAbs().maxCoeff() / 1.5});
  }
  return flight;
}

TEST_F(CommandFilterTest, KeepsTheFenceWhereTheAttitudeLags) {
  const auto made = [this](double lag) {
    std::vector<RegionMap> maps;
    for (const char* axis : {"x", "y"}) {
      Fence fence;
      fence.axis = axis;
      fence.lag = lag;
      maps.push_back(map(fence));
    }
    return CommandFilter(std::move(maps), options_);
  };
  CommandFilter knowing = made(kLag);
  const LaggingFlight kept = flyWithLag(knowing, options_);
  EXPECT_EQ(kept.outside, 0);
  EXPECT_GT(kept.changed, 500);
  EXPECT_LE(kept.farthest, 1.0);
  EXPECT_GT(kept.farthest, 0.8);
  EXPECT_LT(kept.error, 1e-9);
  // Maps of position and velocity alone do not know of the lag, and that is too little here.
  CommandFilter ignorant = made(0.0);
  const LaggingFlight left = flyWithLag(ignorant, options_);
  EXPECT_GT(left.outside, 0);
  EXPECT_GT(left.farthest, 1.0);
}

TEST_F(CommandFilterTest, OutsideTheLeastViolationIsSentAndLeadsBack) {
  std::vector<RegionMap> maps;
  maps.push_back(map({"y"}));
  const SafetyFilterProblem problem = parseSafetyFilter(std::string(maps[0].problemText()), "map");
  CommandFilter filter(std::move(maps), options_);
  VehicleState state;
  state.position.y() = 1.7;
  state.velocity.y() = 1.45;
  int outside = 0, k = 0;
  for (; k < 100; ++k) {
    AttitudeCommand wish = hover(options_);
    wish.roll = -0.15;  // outwards
    const FilterReport& report = filter.step(state, wish);
    if (report.status == FilterStatus::kOutside) {
      ++outside;
      EXPECT_NEAR(report.axes[1].input, -2.0, 1e-9);  // brakes
    }
    EXPECT_EQ(report.axes[0].status, FilterStatus::kPassed);
    const double a = acceleration(report.command, 0.0, options_).y();
    state.position.y() += kPeriod * state.velocity.y() + 0.5 * kPeriod * kPeriod * a;
    state.velocity.y() += kPeriod * a;
  }
  EXPECT_GT(outside, 2);
  EXPECT_LT(outside, 30);
  EXPECT_LE(std::abs(state.position.y()), 2.0);

  // Against all inputs of a fine grid.
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const SafeSet& set = *problem.safe_set;
  for (int i = 0; i < 200; ++i) {
    const double xi[] = {4.0 * unit(random), 3.0 * unit(random)};
    const auto worst = [&](double u) {
      double greatest = -1e9;
      for (Eigen::Index row = 0; row < set.G.rows(); ++row) {
        const double excess = set.G(row, 0) * u - set.b[row] - set.M(row, 0) * xi[0] - set.M(row, 1) * xi[1];
        greatest = std::max(greatest, excess / set.H.row(row).norm());
      }
      return greatest;
    };
    const double chosen = worst(leastViolation(problem, xi));
    for (int step = 0; step <= 400; ++step) EXPECT_LE(chosen, worst(-2.0 + 0.01 * step) + 1e-9);
  }
}

TEST_F(CommandFilterTest, WithoutAWishTheVehicleLevels) {
  CommandFilter filter(fences(), options_);
  AttitudeCommand wish = hover(options_);
  wish.roll = kNan;
  VehicleState state;
  const FilterReport& report = filter.step(state, wish);
  EXPECT_EQ(report.status, FilterStatus::kNoWish);
  EXPECT_NEAR(report.command.roll, 0.0, 1e-12);
  EXPECT_NEAR(report.command.thrust, options_.mass * options_.gravity, 1e-9);
  // It brakes where level flight would leave the fence.
  state.position.x() = 1.7;
  state.velocity.x() = 0.95;
  filter.step(state, wish);
  EXPECT_EQ(report.status, FilterStatus::kNoWish);
  EXPECT_LT(report.axes[0].input, -0.1);
  EXPECT_LT(report.command.pitch, -0.01);
}

TEST_F(CommandFilterTest, WithoutAStateTheFailsafePolicyAnswers) {
  options_.hold_periods = 2;
  CommandFilter filter(fences(), options_);
  AttitudeCommand wish = hover(options_);
  wish.roll = 0.01;
  VehicleState lost;
  lost.velocity.z() = kNan;
  const FilterReport& report = filter.step(lost, wish);
  EXPECT_EQ(report.status, FilterStatus::kNoState);
  EXPECT_EQ(report.fallback, ControlStatus::kLevel);  // nothing to hold yet
  filter.step(VehicleState(), wish);
  EXPECT_EQ(report.status, FilterStatus::kPassed);
  for (int k = 0; k < 2; ++k) {
    filter.step(lost, wish);
    EXPECT_EQ(report.fallback, ControlStatus::kHoldLast);
    EXPECT_EQ(report.command.roll, 0.01);
  }
  filter.stepWithoutState();
  EXPECT_EQ(report.fallback, ControlStatus::kLevel);
  EXPECT_EQ(report.command.roll, 0.0);
}

TEST_F(CommandFilterTest, AStepAllocatesNothing) {
  CommandFilter filter(fences(0.04), options_);
  VehicleState inside, outside, lost;
  outside.position.x() = 9.0;
  lost.position.x() = kNan;
  AttitudeCommand wish = hover(options_);
  wish.pitch = 0.5;
  const long before = polyfly_test::allocationCount();
  filter.step(inside, wish);
  filter.step(outside, wish);
  filter.step(lost, wish);
  EXPECT_EQ(polyfly_test::allocationCount(), before);
}

TEST_F(CommandFilterTest, RefusesWhatDoesNotFit) {
  const auto complaint = [&](std::vector<RegionMap> maps) -> std::string {
    try {
      const CommandFilter filter(std::move(maps), options_);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const auto pair = [&](const Fence& first, const Fence& second) {
    std::vector<RegionMap> maps;
    maps.push_back(map(first));
    maps.push_back(map(second));
    return maps;
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(complaint({}), "one to three maps");
  has(complaint(pair({"x"}, {"x"})), "another map has the axis x");
  Fence slow{"y"};
  slow.period = 0.2;
  has(complaint(pair({"x"}, slow)), "sampling_time: all maps must have the same");
  Fence other{"y"};
  other.unit = "rad";
  has(complaint(pair({"x"}, other)), "parameters: must be");
  has(complaint(pair({"x"}, {"w"})), "parameters: must be");
  // The lag of thrust is not measured.
  Fence climb{"z"};
  climb.lag = 0.2;
  has(complaint(pair({"x"}, climb)), "parameters: must be");
  options_.thrust_max = 11.0;
  has(complaint(pair({"x"}, {"z"})), "need a thrust of");
}

}  // namespace
}  // namespace polyfly
