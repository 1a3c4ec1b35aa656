// Ranges of disturbances out of simulated flights with known ones.
#include "robust_mpc/disturbance_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../test/random.hpp"
#include "made_robust.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

using Flight = std::vector<std::vector<double>>;

/// A flight of the discrete model with disturbances in physical units, by channel.
template <typename Disturbance>
Flight fly(const RobustProblem& problem, int steps, Random& random, const Disturbance& disturbance) {
  const int nx = problem.stateCount(), nw = problem.channelCount();
  std::vector<double> x(static_cast<std::size_t>(nx), 0.0);
  Flight flight;
  for (int k = 0; k < steps; ++k) {
    const double u = random.uniform(-0.1, 0.1);
    flight.push_back(x);
    flight.back().push_back(u);
    std::vector<double> next(x.size(), 0.0);
    for (int i = 0; i < nx; ++i) {
      const auto row = static_cast<std::size_t>(i);
      next[row] = problem.B(i, 0).get_d() * u;
      for (int j = 0; j < nx; ++j) next[row] += problem.A(i, j).get_d() * x[static_cast<std::size_t>(j)];
    }
    for (int c = 0; c < nw; ++c) {
      const Signal& channel = problem.disturbances[static_cast<std::size_t>(c)];
      const double w = disturbance(c);
      for (int i = 0; i < nx; ++i)
        next[static_cast<std::size_t>(i)] +=
            problem.G(i, c).get_d() * 2.0 / (channel.upper - channel.lower) * w;
    }
    x = next;
  }
  return flight;
}

TEST(DisturbanceBounds, FindsWhatWasThere) {
  MadeRobust made;
  made.torque = true;
  const RobustProblem problem = made.problem();
  Random random(1);
  const Flight flight = fly(problem, 5001, random, [&](int channel) {
    return channel == 0 ? random.uniform(-0.3, 0.4) : random.uniform(-0.02, 0.15);
  });
  BoundsOptions options;
  const DisturbanceBounds bounds = boundDisturbances(problem, {flight}, options);
  ASSERT_EQ(bounds.channels.size(), 2u);
  EXPECT_LT(bounds.unexplained, 1e-9);
  EXPECT_EQ(bounds.channels[0].samples, 5000u);
  EXPECT_NEAR(bounds.channels[0].lower, -0.3, 0.01);
  EXPECT_NEAR(bounds.channels[0].upper, 0.4, 0.01);
  EXPECT_NEAR(bounds.channels[1].lower, -0.02, 0.005);
  EXPECT_NEAR(bounds.channels[1].upper, 0.15, 0.005);
  EXPECT_EQ(bounds.channels[0].declared, 1.0);  // -0.5 .. 0.5
  for (const ChannelBounds& channel : bounds.channels) {
    EXPECT_GE(channel.confidence, 0.95);
    EXPECT_GE(channel.covered, 0.99);
    EXPECT_LT(channel.covered, 1.0);
  }
}

// The promise itself: of many sets of samples, the range holds the share in at least as many as the
// confidence says, and not in nearly all of them, which would be a range too wide.
TEST(DisturbanceBounds, KeepTheirConfidence) {
  const RobustProblem problem = MadeRobust().problem();
  BoundsOptions options;
  options.coverage = 0.9;
  options.confidence = 0.8;
  Random random(2);
  int held = 0;
  constexpr int kTrials = 600;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Flight flight = fly(problem, 201, random, [&](int) { return random.uniform(-1.0, 1.0); });
    const ChannelBounds channel = boundDisturbances(problem, {flight}, options).channels[0];
    EXPECT_GE(channel.confidence, 0.8);
    held += 0.5 * (channel.upper - channel.lower) >= 0.9 ? 1 : 0;  // share of a uniform distribution
  }
  EXPECT_GT(held, static_cast<int>(0.77 * kTrials));
  EXPECT_LT(held, static_cast<int>(0.93 * kTrials));
}

TEST(DisturbanceBounds, SaysWhenThereAreTooFewSamples) {
  const RobustProblem problem = MadeRobust().problem();
  Random random(3);
  const Flight flight = fly(problem, 101, random, [&](int) { return random.uniform(-1.0, 1.0); });
  const DisturbanceBounds bounds = boundDisturbances(problem, {flight}, {});
  EXPECT_LT(bounds.channels[0].confidence, 0.95);
  EXPECT_EQ(bounds.channels[0].covered, 1.0);
  EXPECT_NE(boundsText(bounds, {}).find("too few samples"), std::string::npos);
  BoundsOptions thinned;
  thinned.every = 10;
  EXPECT_LT(boundDisturbances(problem, {flight}, thinned).channels[0].confidence,
            bounds.channels[0].confidence);
}

TEST(DisturbanceBounds, SplitsAtGapsAndSeesAWrongModel) {
  const RobustProblem problem = MadeRobust().problem();
  Random random(4);
  Flight flight = fly(problem, 400, random, [&](int) { return random.uniform(-0.4, 0.4); });
  const Flight second = fly(problem, 400, random, [&](int) { return random.uniform(-0.4, 0.4); });
  const std::size_t whole = boundDisturbances(problem, {flight, second}, {}).channels[0].samples;
  EXPECT_EQ(whole, 798u);  // no step from one flight to the next
  flight[100][1] = NAN;
  EXPECT_EQ(boundDisturbances(problem, {flight, second}, {}).channels[0].samples, 796u);
  for (std::vector<double>& row : flight) row[2] *= 1.5;  // an angle that the model does not know
  EXPECT_GT(boundDisturbances(problem, {flight}, {}).unexplained, 0.2);
}

TEST(DisturbanceBounds, RefusesBadInput) {
  const RobustProblem problem = MadeRobust().problem();
  const Flight row{{0.0, 0.0, 0.0, 0.0}};
  EXPECT_THROW(boundDisturbances(problem, {row}, {}), Error);
  EXPECT_THROW(boundDisturbances(problem, {{{0.0}, {0.0}}}, {}), Error);
  const Flight two{row[0], row[0]};
  BoundsOptions options;
  options.coverage = 1.0;
  EXPECT_THROW(boundDisturbances(problem, {two}, options), Error);
  options = BoundsOptions();
  options.every = 0;
  EXPECT_THROW(boundDisturbances(problem, {two}, options), Error);
  EXPECT_EQ(boundDisturbances(problem, {two}, {}).channels[0].samples, 1u);
}

}  // namespace
}  // namespace polyfly
