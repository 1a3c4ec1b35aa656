// Closed loops of the minimum-peak robust MPC against all adversaries: no violated bound, no step without a
// plan.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "polyfly_test/robust_campaign.hpp"

namespace polyfly_test {
namespace {

using Controller = RobustCampaign::Controller;
using Options = RobustCampaign::Options;
using Result = RobustCampaign::Result;

constexpr std::array<Adversary, 4> kAdversaries{Adversary::kRandom, Adversary::kTelegraph, Adversary::kWorst,
                                                Adversary::kGreedy};

const RobustCampaign& campaign() {
  static const RobustCampaign once = [] {
    const char* root = std::getenv("POLYFLY_ROOT");
    return RobustCampaign(
        std::string(root != nullptr ? root : ".") + "/region_maps/problems/reference/robust_lateral.yaml",
        testing::TempDir() + "robust_flights_");
  }();
  return once;
}

Result flyAll(Options options, int flights) {
  Result all;
  for (const Adversary adversary : kAdversaries) {
    options.adversary = adversary;
    options.flights = flights / static_cast<int>(kAdversaries.size());
    all.add(campaign().fly(options));
    ++options.seed;
  }
  return all;
}

TEST(RobustFlights, TenThousandWithinTheBound) {
  const Result all = flyAll({}, 10000);
  EXPECT_EQ(all.steps, 1250000u);
  EXPECT_EQ(all.violations, 0u) << all.worst_violation;
  EXPECT_EQ(all.infeasible, 0u);
  EXPECT_EQ(all.broken_promises, 0u);
  EXPECT_LE(all.peak, all.peak_promised);
  EXPECT_TRUE(all.finite);
}

TEST(RobustFlights, FiveTimesLowerPeakThanLqrAndNominalMpc) {
  Options options;
  options.from_origin = true;
  const double robust = flyAll(options, 400).peak;
  options.controller = Controller::kLqr;
  const Result lqr = flyAll(options, 400);
  options.controller = Controller::kNominalMpc;
  const Result nominal = flyAll(options, 400);
  RecordProperty("robust", std::to_string(robust));
  RecordProperty("lqr", std::to_string(lqr.peak));
  RecordProperty("nominal", std::to_string(nominal.peak));
  EXPECT_LT(5.0 * robust, lqr.peak);
  EXPECT_LT(5.0 * robust, nominal.peak);
}

TEST(RobustFlights, TheOthersBreakTheBounds) {
  Options options;
  options.controller = Controller::kLqr;
  EXPECT_GT(flyAll(options, 400).violations, 0u);
  options.controller = Controller::kNominalMpc;
  EXPECT_GT(flyAll(options, 400).violations, 0u);
}

// Beyond the bound there are no promises, but no crash: the errors are scaled down to where there is a plan,
// and when the disturbance is within its bound again, so is all else.
TEST(RobustFlights, DegradesAndRecoversAtOneAndAHalfTimesTheBound) {
  Options options;
  options.share = 1.5;
  options.steps = 250;
  const Result all = flyAll(options, 1000);
  EXPECT_TRUE(all.finite);
  EXPECT_GT(all.infeasible, 0u);        // it happened
  EXPECT_EQ(all.late_degraded, 0u);     // and was over
  EXPECT_LT(all.worst_violation, 0.1);  // of a range
  // from far out the position comes back as the tie-break's LQR brings it: to 0.139 m under the full constant
  // wind
  EXPECT_LT(all.last_position, 0.15);
}

}  // namespace
}  // namespace polyfly_test
