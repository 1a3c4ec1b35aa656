// What the linear laws gain from the references ahead: flights that online_controller/README.md tabulates. And a map with
// a short model of these references, against the same problem solved online with the reference of each stage.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/laws/axis.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "polyfly_test/law_flight.hpp"
#include "polyfly_test/multirotor_plant.hpp"
#include "region_maps/region_map.hpp"
#include "shipped_problems.hpp"
#include "solved_maps.hpp"

namespace polyfly {
namespace {

using Path = std::function<Reference(double)>;

/// Their maps, solved once for all tests.
const std::array<const RegionMap*, 3>& maps() {
  static const std::vector<RegionMap> kOpened =
      solvedMaps(shippedProblems("look_ahead/"), "look_ahead_flight_test_");
  static const std::array<const RegionMap*, 3> kPointers{&kOpened[0], &kOpened[1], &kOpened[2]};
  return kPointers;
}

enum class Kind { kLinear, kMaps };

MultirotorController makeLaw(Kind kind, bool look_ahead) {
  MultirotorOptions options;
  options.look_ahead = look_ahead;
  if (kind == Kind::kMaps) return {maps(), options};
  return {shippedProblems(), options};
}

/// Root mean square of the position error along the path for so long [m].
double fly(const Path& path, double seconds, Kind kind, bool look_ahead) {
  MultirotorController law = makeLaw(kind, look_ahead);
  PlantState state;
  state.position = path(0.0).position;
  state.thrust = PlantOptions{}.gravity;
  MultirotorPlant plant(PlantOptions{}, state);
  std::vector<Reference> preview(static_cast<std::size_t>(law.previewLength()));
  double sum = 0.0;
  int samples = 0;
  for (; plant.time() < seconds; ++samples) {
    const VehicleState measured = plant.measure();
    for (std::size_t k = 0; k < preview.size(); ++k)
      preview[k] = path(measured.stamp + static_cast<double>(k) * law.previewPeriod());
    const ControlReport& report = law.step(measured, preview.data());
    EXPECT_EQ(report.status, ControlStatus::kOptimal);
    plant.advance(report.command);
    sum += (plant.state().position - path(plant.time()).position).squaredNorm();
  }
  return std::sqrt(sum / samples);
}

struct Gain {
  double linear = 1.0;
  double maps = 1.0;
};

void expectGain(const std::string& name, const Path& path, double seconds, const Gain& least) {
  for (const Kind kind : {Kind::kLinear, Kind::kMaps}) {
    const double one = fly(path, seconds, kind, false), ahead = fly(path, seconds, kind, true);
    const std::string law = name + (kind == Kind::kMaps ? "_maps" : "_linear");
    testing::Test::RecordProperty(law + "_one_reference", std::to_string(one));
    testing::Test::RecordProperty(law + "_look_ahead", std::to_string(ahead));
    EXPECT_LT((kind == Kind::kMaps ? least.maps : least.linear) * ahead, one)
        << law << ": " << one << " and " << ahead;
  }
}

/// From rest at 2 s on, 6 m along x and 6 m along y at 1.5 m/s, with or without the velocity.
Path corner(bool with_velocity) {
  return [=](double time) {
    constexpr double kSpeed = 1.5, kLeg = 6.0;
    const double way = kSpeed * std::max(0.0, time - 2.0);
    Reference reference;
    reference.position = {std::min(way, kLeg), std::clamp(way - kLeg, 0.0, kLeg), 1.0};
    if (with_velocity && way > 0.0 && way < kLeg) reference.velocity.x() = kSpeed;
    if (with_velocity && way >= kLeg && way < 2.0 * kLeg) reference.velocity.y() = kSpeed;
    return reference;
  };
}

TEST(LookAheadFlight, Corners) { expectGain("corners", corner(true), 14.0, {5.0, 4.0}); }

TEST(LookAheadFlight, WayPointsWithoutFeedForward) {
  expectGain("corners_without_velocity", corner(false), 14.0, {3.0, 2.0});
  const auto steps = [](double time) {
    Reference reference;
    reference.position = {std::floor(time / 2.0), 0.0, 1.0};
    return reference;
  };
  expectGain("way_points", steps, 16.0, {2.0, 2.0});
}

TEST(LookAheadFlight, AStop) {
  const auto stop = [](double time) {
    constexpr double kSpeed = 3.0;
    Reference reference;
    reference.position = {kSpeed * std::clamp(time - 1.0, 0.0, 3.0), 0.0, 1.0};
    if (time >= 1.0 && time < 4.0) reference.velocity.x() = kSpeed;
    return reference;
  };
  expectGain("stop", stop, 10.0, {8.0, 2.0});
}

/// Root mean square of the position error on the demonstration's figure [m].
double flyFigure(double rate, bool look_ahead) {
  MultirotorController law = makeLaw(Kind::kMaps, look_ahead);
  FigureOptions options;
  options.rate = rate;
  const FlightFigure figure(options);
  LawFlight flown(figure, PlantOptions{}, law);
  double sum = 0.0;
  int samples = 0;
  for (; !flown.over(); ++samples) {
    flown.measure();
    flown.advance(law.step(flown.state(), flown.preview()).command);
    sum += flown.error() * flown.error();
  }
  return std::sqrt(sum / samples);
}

TEST(LookAheadFlight, MapsFlyTheFigure) {
  // Held moves follow a reference that always turns less closely than one reference does, which is fed forward.
  const auto expectBelow = [](double rate, bool look_ahead, double most) {
    const double rms = flyFigure(rate, look_ahead);
    testing::Test::RecordProperty(
        "figure_" + std::to_string(rate) + (look_ahead ? "_look_ahead" : "_one_reference"),
        std::to_string(rms));
    EXPECT_LT(rms, most) << rate;
  };
  expectBelow(0.53, false, 0.001);
  expectBelow(0.53, true, 0.005);
  expectBelow(0.9, false, 0.016);
  expectBelow(0.9, true, 0.030);
}

/// An axis by its map, and the same problem online with the reference of each stage.
class MapLookAhead : public testing::TestWithParam<std::size_t> {
 protected:
  MapLookAhead()
      : problem_(shippedProblems("look_ahead/")[GetParam()]),
        names_(kAxisNames[GetParam()]),
        map_(*maps()[GetParam()], names_, MultirotorOptions{}),
        online_(onlineAxisLaw(problem_), names_, MultirotorOptions{}) {}

  double within(double most) { return std::uniform_real_distribution<double>(-most, most)(random_); }

  /// The inputs of both at the references; whether the map held the parameters.
  bool answer(const std::vector<AxisReference>& references, const AxisSample& sample, double previous) {
    AxisReport by_map, by_online;
    for (Axis* axis : {&map_, &online_}) {
      for (int t = 0; t <= axis->stages(); ++t) axis->setStage(t, references[static_cast<std::size_t>(t)]);
      axis->aim(true);
    }
    EXPECT_EQ(map_.evaluate(sample, references[0], previous, 0.0, by_map), ControlStatus::kOptimal);
    EXPECT_EQ(online_.evaluate(sample, references[0], previous, 0.0, by_online), ControlStatus::kOptimal);
    by_map_ = by_map.input;
    by_online_ = by_online.input;
    return by_map.lookup == LookupStatus::kInside;
  }

  bool atBound(double input) const {
    return input > problem_.inputs[0].upper - 1e-9 || input < problem_.inputs[0].lower + 1e-9;
  }

  MpcProblem problem_;
  AxisNames names_;
  Axis map_, online_;
  std::mt19937_64 random_{11};
  double by_map_ = 0.0, by_online_ = 0.0;
};

constexpr double kAgreement = 1e-6;  // inputs of map and online solution [rad, m/s^2]

// Its velocity leaves that of the first stage by -a t (with drag by a little less), and it feeds nothing of this forward.
TEST_P(MapLookAhead, EqualsTheOnlineLawWhereTheReferenceIsOfTheShortModel) {
  ASSERT_EQ(map_.stages(), problem_.horizon);
  const double drag = -problem_.A_c(1, 1);
  int at_bound = 0, ahead_matters = 0;
  for (int round = 0; round < 200; ++round) {
    const double size = round % 2 == 0 ? 2.0 : 0.3, a = within(2.9), v0 = within(1.0);
    std::vector<AxisReference> references;
    for (int t = 0; t <= problem_.horizon; ++t) {
      const double time = problem_.sampling_time * t;
      const double fallen = drag > 0.0 ? -std::expm1(-drag * time) / drag : time;
      const double way = drag > 0.0 ? (time - fallen) / drag : 0.5 * time * time;
      AxisReference reference{v0 * time - a * way, v0 - a * fallen, 0.0, 0.0, 0.0};
      // The tilt of the first stage stays.
      reference.acceleration = drag * a * fallen;
      reference.jerk = -drag * reference.acceleration;
      references.push_back(reference);
    }
    const AxisSample sample{within(size), v0 + within(size), GetParam() < 2 ? within(0.2) : 0.0};
    const double previous = within(0.2);
    ASSERT_TRUE(answer(references, sample, previous)) << round;
    EXPECT_NEAR(map_.disturbanceAhead(), a, 1e-7);
    EXPECT_NEAR(by_map_, by_online_, kAgreement) << round;
    at_bound += atBound(by_map_) ? 1 : 0;
    map_.aim(false);
    AxisReport blind;
    map_.evaluate(sample, references[0], previous, 0.0, blind);
    ahead_matters += std::abs(blind.input - by_map_) > 1e-3 ? 1 : 0;
  }
  EXPECT_GT(at_bound, 10);
  EXPECT_GT(ahead_matters, 50);
}

// Where no bound is active, whatever the reference is.
TEST_P(MapLookAhead, EqualsTheOnlineLawForAnyReferenceWithoutActiveBounds) {
  for (int round = 0; round < 50; ++round) {
    std::vector<AxisReference> references;
    for (int t = 0; t <= problem_.horizon; ++t)
      references.push_back({within(0.01), within(0.01), within(0.02), within(0.02), 0.1});
    const AxisSample sample{within(0.02), within(0.02), GetParam() < 2 ? within(0.01) : 0.0};
    ASSERT_TRUE(answer(references, sample, within(0.01)));
    EXPECT_NEAR(by_map_, by_online_, kAgreement) << round;
  }
}

// Beyond the parameter's range the map looks ahead less, and still answers.
TEST_P(MapLookAhead, ClipsWhatItLooksAheadTo) {
  std::vector<AxisReference> references(static_cast<std::size_t>(problem_.horizon) + 1);
  references.back().position = 1000.0;
  ASSERT_TRUE(answer(references, {}, 0.0));
  EXPECT_EQ(std::abs(map_.disturbanceAhead()), 3.0);
}

INSTANTIATE_TEST_SUITE_P(Axes, MapLookAhead, testing::Values(0, 1, 2));

}  // namespace
}  // namespace polyfly
