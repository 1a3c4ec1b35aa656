// Odometry whose attitude jumps, or that repeats itself under new stamps, with all four laws on a rigid body
// that has an attitude controller of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "outlier_flight.hpp"
#include "region_maps/region_map.hpp"
#include "shipped_problems.hpp"
#include "solved_maps.hpp"
#include "solved_robust_maps.hpp"

namespace polyfly {
namespace {

constexpr double kPi = 3.14159265358979323846;
// Rounding difference of two flights [m, rad].
constexpr double kRounding = 1e-6;
constexpr double kDegree = kPi / 180.0;

using Maps = std::vector<RegionMap>;

std::array<const RegionMap*, 3> pointers(const Maps& maps) { return {&maps[0], &maps[1], &maps[2]}; }

const Maps& nominalMaps() {
  static const Maps kOpened = solvedMaps(shippedProblems(), "odometry_outliers_");
  return kOpened;
}

const Maps& robustMaps() {
  static const Maps kOpened = aslquadMaps("odometry_outliers_");
  return kOpened;
}

std::unique_ptr<ControlLaw> explicitLinear(const MultirotorOptions& options) {
  return std::make_unique<MultirotorController>(pointers(nominalMaps()), options);
}
std::unique_ptr<ControlLaw> linear(const MultirotorOptions& options) {
  return std::make_unique<MultirotorController>(shippedProblems(), options);
}
std::unique_ptr<ControlLaw> nonlinear(const MultirotorOptions& options) {
  return std::make_unique<NonlinearController>(options, NonlinearMpcOptions{});
}
std::unique_ptr<ControlLaw> robustExplicit(const MultirotorOptions& options) {
  return std::make_unique<MultirotorController>(pointers(robustMaps()), options);
}

struct NamedLaw {
  const char* name;
  MakeLaw make;
};

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest finds it by this name.
void PrintTo(const NamedLaw& law, std::ostream* stream) { *stream << law.name; }

/// In hover, or in the middle of its way, where it has its greatest speed of 2.3 m/s.
void begin(OutlierFlight& flight, Task task) {
  flight.fly(5.0);
  if (task == Task::kHover) return;
  flight.goAhead(6.0, 5.0, task == Task::kTurningLine ? 3.0 : 0.0);
  if (task == Task::kStart) return;
  EXPECT_EQ(flight.fly(2.0).refused, 0.0);
}

/// The flight from the fault's beginning until it is long over.
Flown fly(MakeLaw make, const Setting& setting, Task task, const Fault& fault) {
  OutlierFlight flight(make, setting);
  begin(flight, task);
  const Flown flown = flight.fly(7.0 + 2.0 * fault.length, fault);
  EXPECT_EQ(flight.supervisor().state(), FlightState::kPositionHold);
  EXPECT_LT(flown.last, 0.1);
  return flown;
}

/// Samples that are none: how the same vehicle flies where nothing of them reaches the law.
Fault unusable(double length) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  return {[=](VehicleState& state, double) { state.attitude.coeffs().setConstant(kNan); }, length};
}

/// As far as without odometry, and what commands do until it is noticed that odometry repeats itself.
void expectAsInSilence(const Flown& flown, const Flown& silence) {
  EXPECT_LT(flown.away, 1.3 * silence.away + 0.25);
  EXPECT_LT(flown.tilt, silence.tilt + 5.0 * kDegree);
}

class OdometryOutliers : public testing::TestWithParam<NamedLaw> {};

// Nothing of what is wrong reaches the law: it flies as if these samples were not there.
TEST_P(OdometryOutliers, AYawThatIsOffForAWhileIsAsNoOdometry) {
  const std::pair<double, std::vector<double>> cases[] = {
      {0.1, {120.0}}, {0.5, {90.0, 180.0}}, {2.0, {180.0}}};  // [s], [deg]
  for (const auto& [length, angles] : cases) {
    for (const Task task : {Task::kHover, Task::kLine, Task::kTurningLine}) {
      const Flown blind = fly(GetParam().make, {}, task, unusable(length));
      for (const double degrees : angles) {
        const Flown flown = fly(GetParam().make, {}, task, yawOff(degrees * kDegree, length));
        EXPECT_NEAR(flown.refused, length, 0.5 * kPeriod) << degrees;
        EXPECT_NEAR(flown.tilt, blind.tilt, kRounding) << degrees;
        EXPECT_NEAR(flown.away, blind.away, kRounding) << degrees;
        if (length > 0.5) continue;
        EXPECT_LT(flown.tilt, 15.0 * kDegree) << degrees;
        EXPECT_LT(flown.away, 0.2) << degrees;
      }
    }
  }
}

TEST_P(OdometryOutliers, OutliersThatComeAgainAndAgainAreNotFollowed) {
  OutlierFlight flight(GetParam().make);
  begin(flight, Task::kHover);
  for (int k = 0; k < 8; ++k) {
    const Flown flown = flight.fly(1.0, yawOff((k % 2 == 0 ? 1.0 : -1.0) * (90.0 + 10.0 * k) * kDegree, 0.3));
    EXPECT_NEAR(flown.refused, 0.3, 0.5 * kPeriod) << k;
    EXPECT_LT(flown.tilt, 15.0 * kDegree) << k;
    EXPECT_LT(flown.away, 0.15) << k;
  }
}

TEST_P(OdometryOutliers, ATiltThatIsOffAndAPositionBesideIsNotFollowed) {
  const Eigen::Vector3d axes[] = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()};
  for (const Eigen::Vector3d& axis : axes) {
    OutlierFlight flight(GetParam().make);
    begin(flight, Task::kHover);
    const auto spoil = [&](VehicleState& state, double) {
      state.attitude = state.attitude * Eigen::Quaterniond(Eigen::AngleAxisd(1.5, axis));
    };
    const Flown flown = flight.fly(4.0, {spoil, 0.5});
    EXPECT_NEAR(flown.refused, 0.5, 0.5 * kPeriod);
    EXPECT_LT(flown.away, 0.1);
  }
  // A position that jumps is believed after 0.1 s, but not with such a yaw.
  OutlierFlight flight(GetParam().make);
  begin(flight, Task::kHover);
  const Fault yaw = yawOff(kPi, 0.5);
  const auto both = [&](VehicleState& state, double since) {
    yaw.spoil(state, since);
    state.position.x() += 3.0;
  };
  const Flown flown = flight.fly(4.0, {both, 0.5});
  EXPECT_NEAR(flown.refused, 0.5, 0.5 * kPeriod);
  EXPECT_LT(flown.away, 0.1);
}

TEST_P(OdometryOutliers, SignAndLengthOfAQuaternionAreNoOutlier) {
  for (const double factor : {-1.0, 1.04, -0.96}) {
    OutlierFlight plain(GetParam().make), other(GetParam().make);
    const auto spoil = [factor](VehicleState& state, double since) {
      if (std::lround(since / kPeriod) % 2 == 0) state.attitude.coeffs() *= factor;
    };
    begin(plain, Task::kTurningLine);
    begin(other, Task::kTurningLine);
    const Flown expected = plain.fly(3.0), flown = other.fly(3.0, {spoil, 3.0});
    EXPECT_EQ(flown.refused, 0.0) << factor;
    EXPECT_NEAR(flown.away, expected.away, kRounding) << factor;
  }
}

TEST_P(OdometryOutliers, AFrameThatHasTurnedIsBelievedInTheEnd) {
  OutlierFlight flight(GetParam().make);
  begin(flight, Task::kHover);
  const Fault turned = turnedFrame(flight.plant().position(), kPi, 10.0);
  const Flown flown = flight.fly(10.0, turned);
  EXPECT_NEAR(flown.refused, 2.1, 0.5 * kPeriod);  // hold_periods and level_periods
  EXPECT_EQ(flight.supervisor().state(), FlightState::kPositionHold);
  EXPECT_LT(flown.tilt, 20.0 * kDegree);
  EXPECT_LT(flown.away, 1.0);  // most of it the wind's, while the vehicle is level
  EXPECT_LT(flown.last, 0.1);
}

// Velocities that are turned with the yaw do not lead where the positions go: this frame has not turned.
TEST_P(OdometryOutliers, AYawThatIsOffForGoodIsNotBelievedAgainstTheMotion) {
  for (const Task task : {Task::kHover, Task::kLine}) {  // wind moves what hovers
    OutlierFlight flight(GetParam().make);
    begin(flight, task);
    const Flown flown = flight.fly(6.0, yawOff(kPi, 6.0));
    EXPECT_NEAR(flown.refused, 6.0, 0.5 * kPeriod);
    EXPECT_EQ(flight.supervisor().state(), FlightState::kFailsafe);
    EXPECT_LT(flown.tilt, 15.0 * kDegree);
    EXPECT_EQ(flight.supervisor().report().status, ControlStatus::kDescend);
  }
}

TEST_P(OdometryOutliers, OdometryThatRepeatsItselfInMotionIsSilence) {
  for (const bool noisy : {true, false}) {
    for (const double length : {0.2, 0.5, 1.0, 3.0}) {
      Setting setting;
      setting.noisy = noisy;
      const Flown moving = fly(GetParam().make, setting, Task::kLine, repeated(length));
      EXPECT_NEAR(moving.refused, length - 0.11, 2.0 * kPeriod) << length;
      expectAsInSilence(moving, fly(GetParam().make, setting, Task::kLine, unusable(length)));
      const Flown starting = fly(GetParam().make, setting, Task::kStart, repeated(length));
      EXPECT_GT(starting.refused, length - 0.35) << length;
      expectAsInSilence(starting, fly(GetParam().make, setting, Task::kStart, unusable(length)));
    }
  }
}

TEST_P(OdometryOutliers, APartOfTheOdometryThatRepeatsItselfIsSilence) {
  for (const Task task : {Task::kLine, Task::kStart}) {
    const Flown silence = fly(GetParam().make, {}, task, unusable(2.0));
    for (const bool pose : {true, false}) {
      const Flown flown = fly(GetParam().make, {}, task, repeatedPart(2.0, pose));
      EXPECT_GT(flown.refused, 1.0) << pose;
      expectAsInSilence(flown, silence);
    }
  }
}

TEST_P(OdometryOutliers, RepetitionWithoutMotionIsNone) {
  // A simulator in equilibrium, with wind and without.
  for (const double force : {0.0, 0.4}) {
    Setting calm;
    calm.noisy = false;
    calm.force = {force, 0.0, 0.0};
    OutlierFlight hovering(GetParam().make, calm);
    hovering.fly(8.0);
    EXPECT_EQ(hovering.fly(3.0, repeated(3.0)).refused, 0.0);
  }
  // Odometry of 20 Hz that is published at 100 Hz.
  OutlierFlight slow(GetParam().make);
  const auto last = std::make_shared<VehicleState>();
  const auto held = [last](VehicleState& state, double since) {
    const double stamp = state.stamp;
    if (std::lround(since / kPeriod) % 5 == 0) *last = state;
    state = *last;
    state.stamp = stamp;
  };
  slow.fly(5.0, {held, 5.0});
  slow.goAhead(6.0, 5.0, 3.0);
  EXPECT_EQ(slow.fly(8.0, {held, 8.0}).refused, 0.0);
}

TEST_P(OdometryOutliers, TheGateChangesNoBitOfAGoodFlight) {
  for (const AttitudeLoop loop :
       {AttitudeLoop::kBodyRates, AttitudeLoop::kGeometric, AttitudeLoop::kQuaternion}) {
    Setting with, without;
    with.loop = without.loop = loop;
    without.options.jump_angle = without.options.repeat_time = 0.0;
    OutlierFlight gated(GetParam().make, with), open(GetParam().make, without);
    for (OutlierFlight* flight : {&gated, &open}) {
      begin(*flight, Task::kHover);
      flight->goAhead(8.0, 5.0, 7.0);  // yaws as fast as it may
      EXPECT_EQ(flight->fly(8.0).refused, 0.0);
    }
    EXPECT_EQ(gated.plant().position(), open.plant().position());
    EXPECT_EQ(gated.plant().attitude().coeffs(), open.plant().attitude().coeffs());
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, OdometryOutliers,
                         testing::Values(NamedLaw{"explicit_linear", explicitLinear},
                                         NamedLaw{"linear", linear}, NamedLaw{"nonlinear", nonlinear},
                                         NamedLaw{"robust_explicit", robustExplicit}),
                         [](const auto& law) { return std::string(law.param.name); });

}  // namespace
}  // namespace polyfly
