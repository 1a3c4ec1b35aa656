#include "identification/loop_response.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "made_flight.hpp"

namespace polyfly {
namespace {

double greatestDifference(const test::MadeLoop& made, const LoopShape& shape) {
  const LoopRecord record = test::makeFlight(made, 1);
  const std::vector<LoopSegment> segments = cutSegments(record, {{0.0, made.duration}}, 1.0);
  EXPECT_EQ(segments.size(), 1u);
  const LoopBasis basis = loopBasis(shape, segments.front());
  double greatest = 0.0;
  for (std::size_t i = 0; i < basis.forced.size(); ++i) {
    // The integration starts at rest, the exact response at rest under the first command: what is between is
    // free.
    const double model = made.gain * basis.forced[i] + made.offset;
    greatest = std::max(greatest, std::abs(model - segments.front().response[i]));
  }
  return greatest;
}

// The integration sees a switch up to half a millisecond early or late.
constexpr double kIntegrationError = 2.5e-3;

TEST(LoopResponse, FirstOrderAgreesWithIntegration) {
  for (const double tau : {0.05, 0.2, 0.6}) {
    for (const double delay : {0.0, 0.033, 0.21}) {
      test::MadeLoop made;
      made.gain = 0.9;
      made.tau = tau;
      made.delay = delay;
      made.noise = 0.0;
      EXPECT_LT(greatestDifference(made, {LoopOrder::kFirst, tau, 0.0, 0.0, delay}),
                kIntegrationError / tau * 0.2);
    }
  }
}

TEST(LoopResponse, SecondOrderAgreesWithIntegrationBelowAtAndAboveCriticalDamping) {
  for (const double zeta : {0.4, 0.9999999, 1.0, 1.00001, 2.5}) {
    test::MadeLoop made;
    made.order = LoopOrder::kSecond;
    made.a0 = 36.0;
    made.a1 = 2.0 * zeta * 6.0;
    made.delay = 0.07;
    made.noise = 0.0;
    EXPECT_LT(greatestDifference(made, {LoopOrder::kSecond, 0.0, 6.0, zeta, 0.07}), kIntegrationError)
        << zeta;
  }
}

TEST(LoopResponse, FreeResponseDecaysFromOne) {
  LoopSegment segment;
  for (int i = 0; i < 50; ++i) segment.time.push_back(0.1 * i);
  segment.response.resize(50);
  segment.command = {{0.0}, {0.0}};
  const LoopBasis first = loopBasis({LoopOrder::kFirst, 0.5, 0.0, 0.0, 0.0}, segment);
  ASSERT_EQ(first.free.size(), 1u);
  EXPECT_DOUBLE_EQ(first.free[0][0], 1.0);
  EXPECT_NEAR(first.free[0][10], std::exp(-2.0), 1e-12);
  const LoopBasis second = loopBasis({LoopOrder::kSecond, 0.0, 3.0, 0.5, 0.0}, segment);
  ASSERT_EQ(second.free.size(), 2u);
  EXPECT_DOUBLE_EQ(second.free[0][0], 1.0);
  EXPECT_DOUBLE_EQ(second.free[1][0], 0.0);
  EXPECT_GT(second.free[1][1], 0.0);
}

TEST(LoopResponse, SmoothedMeanOfAStraightLineIsItsSlope) {
  std::vector<double> time;
  std::vector<double> value;
  for (int i = 0; i < 40; ++i) {
    time.push_back(0.02 * i + 0.003 * (i % 3));
    value.push_back(4.0 - 3.0 * time.back());
  }
  for (const double half_width : {0.0, 0.01, 0.1}) {
    for (const double slope : smoothedMean(time, value, half_width)) EXPECT_NEAR(slope, -3.0, 1e-9);
  }
}

}  // namespace
}  // namespace polyfly
