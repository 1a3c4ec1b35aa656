#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "region_maps/write_map.hpp"
#include "synthetic_flight.hpp"
#include "validation/map_use.hpp"
#include "validation/validation.hpp"

namespace polyfly {
namespace {

constexpr double kHalving = 1e-3;  // error of distances that are found by halving [scaled]
constexpr double kRounding = 1e-12;
constexpr std::size_t kLateral = 1;

class Coverage : public testing::Test {
 protected:
  Coverage() { options_.jump_distance = 0.0; }  // flights are far away from one sample to the next

  FlightLog flight(double moved, std::size_t from, std::size_t to) {
    FlightRecorder recorder(maps_.axes(), options_);
    recorder.hold(SyntheticFlight::home());
    for (std::size_t sample = 0; sample < 100; ++sample) {
      const bool away = sample >= from && sample < to;
      recorder.fly(SyntheticFlight::state(sample, {away ? moved : 0.0, 0.0, 0.0}));
    }
    return recorder.log();
  }
  std::vector<ReplaySample> samples(const FlightLog& log) { return replay(log, maps_.axes(), options_); }
  ValidationReport validated(const FlightLog& log) {
    return validate(log, samples(log), maps_.axes(), options_);
  }
  // A copy of the lateral map whose second region is wanting.
  RegionMap halfMap() {
    MapContent content = handMadeMap(kLateral);
    content.regions.resize(1);
    content.candidates = {0};
    content.leaves = {{0, 1}};
    content.nodes.clear();
    content.root = MapContent::kLeaf | 0u;
    content.rows.resize(1);
    writeMap(content, folder_ / "half.map");
    return RegionMap::open(folder_ / "half.map");
  }

  ScratchFolder folder_;
  HandMadeMaps maps_{folder_};
  MultirotorOptions options_;
};

TEST_F(Coverage, measuresDistancesToFacesAndEdges) {
  const RegionMap& map = *maps_.axes()[kLateral];
  const Signal& error = map.parameters()[0];
  const double half = 0.5 * (error.upper - error.lower);
  MapUseCounter counter(map);
  std::vector<double> theta(map.parameters().size(), 0.0);
  theta[0] = 0.8 * half;
  const SampleUse sample = counter.add(1.0, theta.data());
  EXPECT_EQ(sample.lookup.status, LookupStatus::kInside);
  // The two regions meet where the error is 0.
  EXPECT_NEAR(sample.face, 0.8, kRounding);
  // No region ends before the box.
  EXPECT_NEAR(sample.edge, 0.2, kHalving);
  EXPECT_EQ(sample.edge_parameter, 0);
  EXPECT_NEAR(counter.use().parameters[0].room, 0.2 * half, kHalving * half);
  theta[0] = -0.1 * half;
  counter.add(2.0, theta.data());
  EXPECT_NEAR(counter.use().face.least, 0.1, kRounding);
  EXPECT_EQ(counter.use().face.stamp, 2.0);
  EXPECT_EQ(counter.use().edge.stamp, 1.0);
  EXPECT_EQ(counter.use().visited(), 2u);
}

TEST_F(Coverage, findsTheEdgeWhereTheRegionsEndBeforeTheBox) {
  const RegionMap map = halfMap();
  const double half = 0.5 * (map.parameters()[0].upper - map.parameters()[0].lower);
  MapUseCounter counter(map);
  std::vector<double> theta(map.parameters().size(), 0.0);
  theta[0] = -0.25 * half;
  EXPECT_NEAR(counter.add(0.0, theta.data()).edge, 0.25, kHalving);
  theta[0] = 0.25 * half;
  EXPECT_EQ(counter.add(0.1, theta.data()).lookup.status, LookupStatus::kOutsidePartition);
  EXPECT_EQ(counter.use().outside_partition, 1u);
  EXPECT_EQ(counter.use().inside, 1u);
}

// The controller clips it to its range, so nothing leads beyond.
TEST_F(Coverage, countsNoEdgeAlongTheDisturbanceAhead) {
  MapContent content = handMadeMap(kLateral);
  content.parameters.back().name = "d_y_ahead";
  writeMap(content, folder_ / "ahead.map");
  const RegionMap map = RegionMap::open(folder_ / "ahead.map");
  MapUseCounter counter(map);
  std::vector<double> theta(map.parameters().size(), 0.0);
  theta.back() = map.parameters().back().upper;
  EXPECT_NEAR(counter.add(0.0, theta.data()).edge, 1.0, kHalving);
  EXPECT_EQ(counter.use().parameters.back().room, std::numeric_limits<double>::infinity());
}

TEST_F(Coverage, countsByRegion) {
  const RegionMap& map = *maps_.axes()[kLateral];
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  MapUseCounter counter(map);
  std::vector<double> theta(map.parameters().size());
  std::size_t below = 0;
  for (int sample = 0; sample < 400; ++sample) {
    for (std::size_t index = 0; index < theta.size(); ++index) {
      const Signal& signal = map.parameters()[index];
      theta[index] =
          0.5 * (signal.lower + signal.upper) + 0.5 * (signal.upper - signal.lower) * place(generator);
    }
    below += theta[0] < 0.0 ? 1 : 0;
    counter.add(0.01 * sample, theta.data());
  }
  const MapUse& use = counter.use();
  EXPECT_EQ(use.region_samples[0], below);
  EXPECT_EQ(use.region_samples[1], 400 - below);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  theta[1] = nan;
  EXPECT_EQ(counter.add(9.0, theta.data()).lookup.status, LookupStatus::kNotFinite);
  EXPECT_EQ(counter.use().not_finite, 1u);
}

TEST_F(Coverage, tellsWhereTheFlightLeftTheMapAndWhatWasAnswered) {
  options_.solve_outside = false;
  const ValidationReport report = validated(flight(2.0, 40, 47));
  ASSERT_EQ(report.axes[0].excursions.size(), 1u);
  const Excursion& excursion = report.axes[0].excursions[0];
  EXPECT_EQ(excursion.samples, 7u);
  EXPECT_EQ(excursion.from, SyntheticFlight::state(40).stamp);
  EXPECT_EQ(excursion.to, SyntheticFlight::state(46).stamp);
  EXPECT_EQ(excursion.parameter, "e_p_x");
  EXPECT_NEAR(excursion.beyond, report.axes[0].parameters[0].greatest - 0.5, kRounding);
  EXPECT_EQ(excursion.statuses[static_cast<std::size_t>(ControlStatus::kClipped)], 7u);
  EXPECT_TRUE(report.axes[1].excursions.empty());
  EXPECT_NE(toText(reportOn(report)).find("Where the flight left the map"), std::string::npos);
}

TEST_F(Coverage, twoFlightsTogetherCountAsOne) {
  const FlightLog away = flight(2.0, 40, 47), home = flight(0.0, 0, 0);
  const std::vector<ReplaySample> first = samples(away), second = samples(home);
  const ValidationReport one = validated(away), two = validated(home);
  const ValidationReport all = validate({{away, first, options_}, {home, second, options_}}, maps_.axes());
  EXPECT_EQ(all.samples, 200u);
  EXPECT_EQ(all.outside_map_samples, 7u);
  EXPECT_NEAR(all.coverage, 1.0 - 7.0 / 200.0, kRounding);
  EXPECT_NEAR(all.tracking.rms,
              std::sqrt(0.5 * (one.tracking.rms * one.tracking.rms + two.tracking.rms * two.tracking.rms)),
              kRounding);
  EXPECT_EQ(all.tracking.max, one.tracking.max);
  EXPECT_EQ(all.axes[0].inside, one.axes[0].inside + two.axes[0].inside);
  EXPECT_EQ(all.axes[0].excursions.size(), 1u);
  EXPECT_EQ(all.axes[0].parameters[0].greatest, one.axes[0].parameters[0].greatest);
  const Json json = jsonOf(all, {one, two});
  EXPECT_EQ(json["flights"].size(), 2u);
  EXPECT_EQ(json["samples"], 200);
  EXPECT_EQ(json["flights"][1]["samples"], 100);
}

}  // namespace
}  // namespace polyfly
