// What is found of a disturbance in proportion to a known signal.
#include "mpc_core/coefficient_estimate.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "allocations.hpp"
#include "support.hpp"

namespace {

using namespace polyfly;
using namespace polyfly_test;

constexpr double kDrag = 0.16, kWind = 0.3, kDeviation = 0.2;

struct Sample {
  Eigen::Vector3d y;
  double u, signal;  // since the sample before
};

MpcProblem lateral() { return loadProblem(problemFile("multirotor_lateral.yaml")); }

/// The lateral axis with more drag than its problem says, in a constant wind, by the exponential series. The signal is the
/// velocity before the period.
std::vector<Sample> flight(int samples, double noise, double amplitude, std::uint32_t seed) {
  MpcProblem problem = lateral();
  problem.A_c(1, 1) -= kDrag;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(5, 5);
  all.topRows(3) << problem.A_c, problem.B_c, problem.Bd_c;
  const Eigen::MatrixXd step = exponentialSeries(all * ObserverOptions{}.period).topRows(3);
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  std::vector<Sample> result;
  for (int k = 0; k < samples; ++k) {
    const double u = amplitude * std::cos(0.01 * k), v = x(1);
    Eigen::VectorXd now(5);
    now << x, u, kWind;
    x = step * now;
    const Eigen::Vector3d error(0.005 * normal(generator), 0.02 * normal(generator),
                                0.01 * normal(generator));
    result.push_back({x + noise * error, u, v});
  }
  return result;
}

/// The same flight in gusts of `sigma` [m/s^2] that fade in 1 s.
std::vector<Sample> gusts(std::vector<Sample> calm, double sigma, std::uint32_t seed) {
  MpcProblem problem = lateral();
  problem.A_c(1, 1) -= kDrag;
  const DiscreteModel model = discretise(problem, ObserverOptions{}.period);
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  const double kept = std::exp(-ObserverOptions{}.period);
  Eigen::Vector3d more = Eigen::Vector3d::Zero();
  double gust = 0.0;
  for (Sample& sample : calm) {
    gust = kept * gust + std::sqrt(1.0 - kept * kept) * sigma * normal(generator);
    more = model.A * more + model.Bd * gust;
    sample.y += more;
  }
  return calm;
}

struct Found {
  double drag, wind;
};

Found find(const std::vector<Sample>& samples) {
  DisturbanceObserver observer(lateral(), {});
  CoefficientEstimate drag(lateral(), {}, 1, kDeviation);
  for (const Sample& sample : samples) {
    observer.update(sample.y.data(), &sample.u, 1, -drag.value() * sample.signal);
    drag.update(observer, sample.signal, 1);
  }
  return {drag.value(), observer.disturbance()};
}

TEST(CoefficientEstimate, FindsADragAndLeavesTheConstantPart) {
  const Found found = find(flight(3000, 0.0, 0.1, 1));
  EXPECT_NEAR(found.drag, kDrag, 0.01 * kDrag);
  EXPECT_NEAR(found.wind, kWind, 0.01);
}

// Taken for noise of each sample they would teach a drag that is wrong by as much as there is.
TEST(CoefficientEstimate, GustsTeachLittle) {
  constexpr int kFlights = 50;
  double sum = 0.0;
  for (std::uint32_t seed = 1; seed <= kFlights; ++seed)
    sum += std::pow(find(gusts(flight(3000, 0.0, 0.3, 1), 1.0, seed)).drag - kDrag, 2);
  EXPECT_LT(std::sqrt(sum / kFlights), 0.75 * kDrag);
}

/// Sum of squares of the innovations of v and of c, in their deviations, while c is known to be `drag`.
double misfit(const std::vector<Sample>& samples, double drag) {
  DisturbanceObserver observer(lateral(), {});
  double sum = drag * drag / (kDeviation * kDeviation);
  for (const Sample& sample : samples) {
    observer.update(sample.y.data(), &sample.u, 1, -drag * sample.signal);
    sum += std::pow(observer.innovation(1), 2) / observer.innovationVariance(1);
  }
  return sum;
}

// The misfit is quadratic in c, so three values tell its minimum. What is forgotten in a second is little.
TEST(CoefficientEstimate, IsTheLeastSquaresOfTheInnovations) {
  for (const std::uint32_t seed : {4u, 5u, 6u}) {
    for (const int samples : {60, 150, 300}) {
      const std::vector<Sample> flown = flight(samples, 1.0, 0.2, seed);
      const double below = misfit(flown, -0.1), at = misfit(flown, 0.0), above = misfit(flown, 0.1);
      const double least = -0.05 * (above - below) / (above - 2.0 * at + below);
      EXPECT_NEAR(find(flown).drag, least, 0.03 * kDeviation) << seed << " " << samples;
    }
  }
}

// A velocity that lies for a moment is no drag, whatever the innovations are then.
TEST(CoefficientEstimate, NothingIsLearntOfWhatIsNotFollowed) {
  constexpr double kLie = 3.0;  // [m/s]
  DisturbanceObserver observer(lateral(), {});
  CoefficientEstimate drag(lateral(), {}, 1, kDeviation);
  for (const Sample& sample : flight(1500, 0.0, 0.3, 1)) {
    observer.update(sample.y.data(), &sample.u, 1, -drag.value() * sample.signal);
    drag.update(observer, sample.signal, 1);
  }
  const double before = drag.value(), period = ObserverOptions{}.period;
  Sample sample = flight(1501, 0.0, 0.3, 1).back();
  sample.y(1) -= kLie;
  observer.update(sample.y.data(), &sample.u, 1, -before * sample.signal);
  drag.update(observer, std::nullopt, 1);
  EXPECT_NEAR(drag.value(), before * std::exp(-period / CoefficientEstimate::kLostTime), 1e-12);
}

TEST(CoefficientEstimate, StaysWithinThreeDeviationsAndGoesOnInAnother) {
  DisturbanceObserver observer(lateral(), {});
  CoefficientEstimate drag(lateral(), {}, 1, 0.01), next(lateral(), {}, 1, 0.01);
  for (const Sample& sample : flight(3000, 0.0, 0.3, 7)) {
    observer.update(sample.y.data(), &sample.u, 1, -drag.value() * sample.signal);
    drag.update(observer, sample.signal, 1);
    ASSERT_LE(std::abs(drag.value()), 0.03);
  }
  EXPECT_GT(drag.value(), 0.02);
  next.transferState(drag, -0.015);
  EXPECT_DOUBLE_EQ(next.value(), drag.value() - 0.015);
  next.transferState(drag, 1.0);
  EXPECT_DOUBLE_EQ(next.value(), 0.03);
  drag.reset();
  EXPECT_EQ(drag.value(), 0.0);
}

TEST(CoefficientEstimate, DoesNotAllocate) {
  DisturbanceObserver observer(lateral(), {});
  CoefficientEstimate drag(lateral(), {}, 1, kDeviation);
  const double y[] = {1.0, 0.5, 0.1}, u = 0.1;
  const long start = allocationCount();
  for (int k = 0; k < 100; ++k) {
    observer.update(y, &u, 1 + k % 30, -drag.value());
    drag.update(observer, 0.5, 1 + k % 30);
  }
  EXPECT_EQ(allocationCount() - start, 0);
}

TEST(Observer, AKnownDisturbanceIsNotEstimated) {
  DisturbanceObserver observer(lateral(), {});
  DisturbanceObserver unaware(lateral(), {});
  for (const Sample& sample : flight(1000, 0.0, 0.1, 8)) {
    const double known = kWind - kDrag * sample.signal;
    observer.update(sample.y.data(), &sample.u, 1, known);
    unaware.update(sample.y.data(), &sample.u, 1);
  }
  // The velocity of the signal is that before the period.
  EXPECT_NEAR(observer.disturbance(), 0.0, 2e-3);
  EXPECT_GT(std::abs(unaware.disturbance()), 0.05);
}

}  // namespace
