// Replay and validation of a flight by robust maps, compared with the linear program at each decision.
#include <gtest/gtest.h>

#include <string>

#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_test/aslquad_figures.hpp"
#include "polyfly_test/multirotor_plant.hpp"
#include "project_root.hpp"
#include "recorded_flight.hpp"
#include "robust_mpc/online_lp.hpp"
#include "validation/report.hpp"
#include "validation/validation.hpp"

namespace polyfly_test {
namespace {

const AslquadFlights& flights() {
  static const AslquadFlights kOnce(polyfly::problemFile("robust"),
                                    testing::TempDir() + "robust_validation_");
  return kOnce;
}

polyfly::FlightLog logOf(const std::vector<AslquadSample>& flight) {
  polyfly::FlightLog log;
  log.source = "made flight";
  const polyfly::Reference& hold = flight.front().reference;
  log.add(polyfly::ReferenceTrajectory::pose(hold.position, hold.yaw), std::nullopt);
  for (const AslquadSample& sample : flight) {
    log.add(sample.measured);
    log.commands.push_back({sample.measured.stamp, sample.command});
  }
  return log;
}

polyfly::OnlineOracle oracleOf(const polyfly::RegionMap& map) {
  return polyfly::onlineRobustLaw(std::string(map.problemText()), map.path());
}

class RobustValidation : public testing::Test {
 protected:
  RobustValidation()
      : options_(flights().options(AslquadLaw::kRobust, 0.81)),
        log_(logOf(flights().fly(AslquadFigure::kHit, AslquadLaw::kRobust, 1))) {}

  polyfly::ValidationReport validate(const polyfly::OracleMaker& maker) const {
    return polyfly::validate(log_, polyfly::replay(log_, flights().maps(), options_), flights().maps(),
                             options_, maker);
  }

  polyfly::MultirotorOptions options_;
  polyfly::FlightLog log_;
};

TEST_F(RobustValidation, TheFlightIsReplayedAndItsMapsAnswerAsTheLinearProgram) {
  // This option has no effect: robust maps answer for the whole disturbance.
  options_.offset_free = true;
  const polyfly::ValidationReport report = validate(oracleOf);
  ASSERT_EQ(report.samples, log_.odometry.size());
  for (const auto& axis : report.axes) {
    EXPECT_EQ(axis.qp_compared, report.samples) << axis.axis;
    EXPECT_EQ(axis.qp_failures, 0u) << axis.axis;
    EXPECT_LT(axis.qp.max, 1e-6) << axis.axis;
  }
  EXPECT_GT(report.axes[1].qp.max, 0.0);  // two computations
  for (const auto& difference : report.commands.difference) EXPECT_EQ(difference.max, 0.0);
  EXPECT_EQ(report.commands.compared, report.samples);
}

TEST_F(RobustValidation, WithoutAnOracleItSaysThatNothingCouldBeCompared) {
  try {
    validate({});
    FAIL() << "validated without an online solution";
  } catch (const polyfly::Error& error) {
    EXPECT_NE(std::string(error.what()).find("online solution is not at hand"), std::string::npos)
        << error.what();
  }
}

/// A flight of 4 s that begins faster than any plan within the bounds may, with odometry at 100 Hz.
polyfly::FlightLog fastFlight(const polyfly::MultirotorOptions& options) {
  polyfly::PlantOptions plant_options;
  plant_options.mass = options.mass;
  plant_options.roll_time = plant_options.pitch_time = 0.2;
  polyfly::PlantState start;
  start.velocity = {0.0, 1.9, 0.0};
  start.thrust = plant_options.gravity;
  polyfly::MultirotorPlant plant(plant_options, start);
  const auto pose = polyfly::ReferenceTrajectory::pose(Eigen::Vector3d::Zero(), 0.0);
  return polyfly::recordedFlight(flights().maps(), options, pose, plant, 4.0);
}

// Statuses of the flight, of the replay, and on console and page.
TEST(RobustValidationOfALeastViolation, IsReplayedAndTold) {
  polyfly::MultirotorOptions options = flights().options(AslquadLaw::kRobust, 0.65);
  options.control_period = 0.01;
  const polyfly::FlightLog log = fastFlight(options);
  const polyfly::AxisMaps maps = flights().maps();
  const std::vector<polyfly::ReplaySample> samples = polyfly::replay(log, maps, options);
  const polyfly::ValidationReport report = polyfly::validate(log, samples, maps, options, oracleOf);
  EXPECT_EQ(report.commands.max_difference, 0.0);
  EXPECT_EQ(report.statuses.differing, 0u);
  EXPECT_EQ(report.statuses.recorded, report.statuses.replayed);
  const auto count =
      report.statuses.replayed[static_cast<std::size_t>(polyfly::ControlStatus::kLeastViolation)];
  EXPECT_GE(count, 8u);  // one decision at least, held over its sampling time
  EXPECT_EQ(report.statuses.replayed[0] + count, report.samples);
  EXPECT_EQ(report.outside_map_samples, count);
  EXPECT_EQ(report.axes[1].outside_partition, count);
  ASSERT_EQ(report.axes[1].excursions.size(), 1u);
  const polyfly::Excursion& excursion = report.axes[1].excursions[0];
  EXPECT_EQ(excursion.cause, polyfly::LookupStatus::kOutsidePartition);
  EXPECT_EQ(excursion.statuses[static_cast<std::size_t>(polyfly::ControlStatus::kLeastViolation)], count);
  for (const auto& axis : report.axes) {
    EXPECT_EQ(axis.qp_failures, 0u) << axis.axis;
    EXPECT_LT(axis.qp.max, 1e-6) << axis.axis;
  }
  const std::string told = "least_violation " + std::to_string(count),
                    folder = testing::TempDir() + "least_violation";
  const std::string text = polyfly::toText(polyfly::reportOn(report));
  EXPECT_NE(text.find(told + "\n"), std::string::npos) << text;
  polyfly::writeReport({log, samples, maps, options, report}, folder);
  const std::string page = polyfly::readText(folder + "/index.html");
  EXPECT_NE(page.find("<td>" + told + "</td>"), std::string::npos);
  EXPECT_NE(page.find("Answers of the replay: optimal " + std::to_string(report.samples - count) + ", " +
                      told + "."),
            std::string::npos);
}

TEST(OnlineRobustLaw, IsForRobustProblemsOnly) {
  const polyfly::MpcProblem tracking = polyfly::loadProblem(polyfly::problemFile("multirotor_vertical.yaml"));
  EXPECT_FALSE(polyfly::onlineRobustLaw(tracking.text, tracking.source));
}

}  // namespace
}  // namespace polyfly_test
