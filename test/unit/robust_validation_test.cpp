// Replay and validation of a flight by robust maps, compared with the linear program at each decision.
#include <gtest/gtest.h>

#include <string>

#include "polyfly_base/error.hpp"
#include "polyfly_test/aslquad_figures.hpp"
#include "project_root.hpp"
#include "robust_mpc/online_law.hpp"
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

TEST(OnlineRobustLaw, IsForRobustProblemsOnly) {
  const polyfly::MpcProblem tracking = polyfly::loadProblem(polyfly::problemFile("multirotor_vertical.yaml"));
  EXPECT_FALSE(polyfly::onlineRobustLaw(tracking.text, tracking.source));
}

}  // namespace
}  // namespace polyfly_test
