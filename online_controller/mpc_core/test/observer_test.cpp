// Observer of Eq. 5: no offset, stable, and free of allocation.
#include "mpc_core/observer.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "allocations.hpp"
#include "support.hpp"

namespace {

using namespace polyfly;
using namespace polyfly_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const char* const kFiles[] = {"multirotor_longitudinal.yaml", "multirotor_lateral.yaml",
                              "multirotor_vertical.yaml"};

/// Exact sampled motion of one axis, with an own discretisation.
class Axis {
 public:
  Axis(const MpcProblem& problem, double period) : nx_(problem.stateCount()), x_(VectorXd::Zero(nx_)) {
    MatrixXd augmented = MatrixXd::Zero(nx_ + 2, nx_ + 2);
    augmented.topRows(nx_) << problem.A_c, problem.B_c, problem.Bd_c;
    step_ = exponentialSeries(augmented * period).topRows(nx_);
  }
  void advance(double u, double d) {
    VectorXd all(nx_ + 2);
    all << x_, u, d;
    x_ = step_ * all;
  }
  VectorXd& x() { return x_; }
  /// [A Bd; 0 1], and with a rate of the disturbance what it does in a period.
  MatrixXd transition(const ObserverOptions& options) const {
    const Eigen::Index more = options.rate > 0.0 ? 2 : 1;
    MatrixXd rate(more, more);
    if (more == 1) {
      rate << 0.0;
    } else {
      rate << 0.0, 1.0, 0.0, -1.0 / options.rate_time;
    }
    MatrixXd matrix = MatrixXd::Zero(nx_ + more, nx_ + more);
    matrix.topLeftCorner(nx_, nx_) = step_.leftCols(nx_);
    matrix.block(0, nx_, nx_, 1) = step_.rightCols(1);
    matrix.bottomRightCorner(more, more) = exponentialSeries(rate * options.period);
    return matrix;
  }

 private:
  Eigen::Index nx_;
  VectorXd x_;
  MatrixXd step_;
};

/// Without a rate of the disturbance, and with one.
std::vector<ObserverOptions> bothModels() {
  ObserverOptions with;
  with.rate = 0.04;
  return {ObserverOptions{}, with};
}

void expectNoOffset(const char* file, const ObserverOptions& options) {
  const MpcProblem problem = loadProblem(problemFile(file));
  DisturbanceObserver observer(problem, options);
  Axis axis(problem, options.period);
  double u = 0.0;
  int settled = 0;  // first period after which the estimate stays within 10 %
  for (int k = 0; k < 3000; ++k) {
    observer.update(axis.x().data(), &u, 1);
    if (std::abs(observer.disturbance() - 0.8) > 0.08) settled = k;
    u = 0.1 * std::sin(0.02 * k);
    axis.advance(u, 0.8);
  }
  EXPECT_NEAR(observer.disturbance(), 0.8, 1e-8) << file;
  EXPECT_NEAR(observer.rate(), 0.0, 1e-8) << file;
  EXPECT_LT(settled * options.period, 1.5) << file;
}

TEST(Observer, ConstantDisturbanceIsEstimatedWithoutOffset) {
  for (const ObserverOptions& options : bothModels())
    for (const char* file : kFiles) expectNoOffset(file, options);
}

/// RMS of the error of d and of its rate while d = 0.3 sin(t).
std::pair<double, double> errorsWhileTurning(const MpcProblem& problem, const ObserverOptions& options) {
  DisturbanceObserver observer(problem, options);
  Axis axis(problem, options.period);
  const double u = 0.0;
  double of_value = 0.0, of_rate = 0.0;
  constexpr int kFirst = 1000, kSamples = 3000;
  for (int k = 0; k < kSamples; ++k) {
    axis.advance(u, 0.3 * std::sin(options.period * k));
    observer.update(axis.x().data(), &u, 1);
    if (k < kFirst) continue;
    const double time = options.period * (k + 1);
    of_value += std::pow(observer.disturbance() - 0.3 * std::sin(time), 2);
    of_rate += std::pow(observer.rate() - 0.3 * std::cos(time), 2);
  }
  return {std::sqrt(of_value / (kSamples - kFirst)), std::sqrt(of_rate / (kSamples - kFirst))};
}

TEST(Observer, ADisturbanceThatTurnsIsFollowedByItsRate) {
  for (const char* file : kFiles) {
    const MpcProblem problem = loadProblem(problemFile(file));
    ObserverOptions options;
    options.disturbance = 0.005;
    const double without = errorsWhileTurning(problem, options).first;
    options.rate = 0.04;
    const auto [value, rate] = errorsWhileTurning(problem, options);
    EXPECT_LT(value, 0.3 * without) << file;
    EXPECT_LT(rate, 0.7 * 0.3 / std::sqrt(2.0)) << file;
  }
}

TEST(Observer, ARestartAndAnObserverWithoutARateForgetIt) {
  const MpcProblem problem = loadProblem(problemFile(kFiles[1]));
  const std::vector<ObserverOptions> models = bothModels();
  DisturbanceObserver observer(problem, models[1]);
  Axis axis(problem, models[1].period);
  const double u = 0.0;
  for (int k = 0; k < 100; ++k) {
    axis.advance(u, 0.01 * k);
    observer.update(axis.x().data(), &u, 1);
  }
  ASSERT_GT(observer.rate(), 0.1);
  const double disturbance = observer.disturbance();
  DisturbanceObserver with(problem, models[1]), without(problem, models[0]);
  with.transferState(observer);
  EXPECT_EQ(with.rate(), observer.rate());
  without.transferState(observer);
  EXPECT_EQ(without.disturbance(), disturbance);
  EXPECT_EQ(without.rate(), 0.0);
  with.setDisturbance(0.2);
  EXPECT_EQ(with.rate(), 0.0);
  observer.update(axis.x().data(), &u, DisturbanceObserver::kMaxPeriods + 1);
  EXPECT_EQ(observer.disturbance(), disturbance);
  EXPECT_EQ(observer.rate(), 0.0);
}

TEST(Observer, EstimatesTheState) {
  const MpcProblem problem = loadProblem(problemFile(kFiles[1]));
  DisturbanceObserver observer(problem, {});
  Axis axis(problem, ObserverOptions{}.period);
  double u = 0.2;
  for (int k = 0; k < 3000; ++k) {
    axis.advance(u, -0.5);
    observer.update(axis.x().data(), &u, 1);
  }
  ASSERT_EQ(observer.stateCount(), 3);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(observer.state()[i], axis.x()(i), 1e-6 * (1.0 + std::abs(axis.x()(i))));
}

TEST(Observer, EstimateHasNoBiasUnderNoise) {
  const MpcProblem problem = loadProblem(problemFile(kFiles[0]));
  const ObserverOptions options;
  DisturbanceObserver observer(problem, options);
  Axis axis(problem, options.period);
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  const double u = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kSamples = 20000;
  constexpr int kSettle = 2000;
  for (int k = 0; k < kSamples + kSettle; ++k) {
    axis.advance(u, 0.6);
    VectorXd y = axis.x();
    for (Eigen::Index i = 0; i < 3; ++i)
      y(i) += options.measurement[static_cast<std::size_t>(i)] * normal(generator);
    observer.update(y.data(), &u, 1);
    if (k < kSettle) continue;
    sum += observer.disturbance() - 0.6;
    squares += (observer.disturbance() - 0.6) * (observer.disturbance() - 0.6);
  }
  EXPECT_LT(std::abs(sum / kSamples), 0.01);
  EXPECT_LT(std::sqrt(squares / kSamples), 0.1);
}

void expectStableForEveryGap(const char* file, const ObserverOptions& options) {
  const MpcProblem problem = loadProblem(problemFile(file));
  const DisturbanceObserver observer(problem, options);
  const MatrixXd transition = Axis(problem, options.period).transition(options);
  MatrixXd predict = MatrixXd::Identity(transition.rows(), transition.cols());
  for (int periods = 1; periods <= DisturbanceObserver::kMaxPeriods; ++periods) {
    predict = (transition * predict).eval();
    const MatrixXd error = predict + observer.gain() * predict.topRows(observer.stateCount());
    EXPECT_LT(spectralRadius(error), 1.0 - 1e-3) << file << " " << periods;
  }
}

TEST(Observer, ErrorDynamicsAreStableForEveryGap) {
  for (const ObserverOptions& options : bothModels())
    for (const char* file : kFiles) expectStableForEveryGap(file, options);
}

void expectGainOfTheRecursion(const ObserverOptions& options) {
  const MpcProblem problem = loadProblem(problemFile(kFiles[1]));
  const DisturbanceObserver observer(problem, options);
  const MatrixXd F = Axis(problem, options.period).transition(options);
  const Eigen::Index size = F.rows();
  const MatrixXd C = MatrixXd::Identity(3, size);
  MatrixXd W = MatrixXd::Zero(size, size);
  MatrixXd V = MatrixXd::Zero(3, 3);
  for (int i = 0; i < 3; ++i) {
    W(i, i) = std::pow(options.process[static_cast<std::size_t>(i)], 2);
    V(i, i) = std::pow(options.measurement[static_cast<std::size_t>(i)], 2);
  }
  W(3, 3) = std::pow(options.disturbance, 2);
  if (size == 5) W(4, 4) = std::pow(options.rate, 2);
  MatrixXd P = MatrixXd::Identity(size, size);  // predicted covariance, by the textbook recursion
  MatrixXd K;
  for (int i = 0; i < 20000; ++i) {
    K = P * C.transpose() * (C * P * C.transpose() + V).inverse();
    P = (F * (P - K * C * P) * F.transpose() + W).eval();
  }
  EXPECT_LT(maxAbs(observer.gain() + K), 1e-9);  // sign of Eq. 5: predicted minus measured
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(observer.innovationVariance(i), P(i, i) + V(i, i), 1e-9);
}

TEST(Observer, GainIsThatOfTheCovarianceRecursion) {
  for (const ObserverOptions& options : bothModels()) expectGainOfTheRecursion(options);
}

TEST(Observer, MissedSamplesArePredictedAcross) {
  const MpcProblem problem = loadProblem(problemFile(kFiles[1]));
  DisturbanceObserver observer(problem, {});
  Axis axis(problem, ObserverOptions{}.period);
  std::mt19937 generator(2);
  std::uniform_int_distribution<int> gap(1, DisturbanceObserver::kMaxPeriods);
  const double u = -0.05;
  for (int sample = 0; sample < 2000; ++sample) {
    const int periods = gap(generator);
    for (int k = 0; k < periods; ++k) axis.advance(u, 0.4);
    observer.update(axis.x().data(), &u, periods);
  }
  EXPECT_NEAR(observer.disturbance(), 0.4, 1e-6);
}

/// An observer that has converged to d = 0.4 on a hovering axis.
DisturbanceObserver converged(const MpcProblem& problem, Axis* axis) {
  DisturbanceObserver observer(problem, {});
  const double u = 0.0;
  for (int k = 0; k < 3000; ++k) {
    axis->advance(u, 0.4);
    observer.update(axis->x().data(), &u, 1);
  }
  return observer;
}

TEST(Observer, LongGapKeepsTheDisturbanceAndTakesTheState) {
  const MpcProblem problem = loadProblem(problemFile(kFiles[1]));
  Axis axis(problem, ObserverOptions{}.period);
  DisturbanceObserver observer = converged(problem, &axis);
  const double before = observer.disturbance();
  const double y[] = {5.0, -6.0, 0.3};
  const double u = 0.0;
  observer.update(y, &u, DisturbanceObserver::kMaxPeriods + 1);
  EXPECT_EQ(observer.disturbance(), before);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(observer.state()[i], y[i]);
  observer.update(y, &u, std::numeric_limits<int>::max());
  EXPECT_EQ(observer.disturbance(), before);
}

TEST(Observer, IgnoresWhatIsNotFinite) {
  const MpcProblem problem = loadProblem(problemFile(kFiles[1]));
  Axis axis(problem, ObserverOptions{}.period);
  DisturbanceObserver observer = converged(problem, &axis);
  const double before = observer.disturbance();
  const double u = 0.0;
  const double bad = std::nan("");
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (int i = 0; i < 3; ++i) {
      VectorXd y = axis.x();
      y(i) = value;
      observer.update(y.data(), &u, 1);
    }
  }
  observer.update(axis.x().data(), &bad, 1);
  EXPECT_EQ(observer.disturbance(), before);
}

TEST(Observer, NonPositivePeriodsCountAsOne) {
  const MpcProblem problem = loadProblem(problemFile(kFiles[1]));
  Axis axis(problem, ObserverOptions{}.period);
  DisturbanceObserver one = converged(problem, &axis);
  DisturbanceObserver other = one;
  const double u = 0.1;
  axis.advance(u, 0.7);
  one.update(axis.x().data(), &u, 1);
  other.update(axis.x().data(), &u, -3);
  EXPECT_EQ(one.disturbance(), other.disturbance());
}

TEST(Observer, ResetForgets) {
  const MpcProblem problem = loadProblem(problemFile(kFiles[1]));
  Axis axis(problem, ObserverOptions{}.period);
  DisturbanceObserver observer = converged(problem, &axis);
  EXPECT_GT(observer.disturbance(), 0.1);
  observer.reset();
  EXPECT_EQ(observer.disturbance(), 0.0);
  // The first sample sets the state, without a jump of the disturbance.
  const double y[] = {100.0, 1.0, 0.1};
  const double u = 0.0;
  observer.update(y, &u, 1);
  EXPECT_EQ(observer.disturbance(), 0.0);
  EXPECT_EQ(observer.state()[0], 100.0);
}

TEST(Observer, UpdateDoesNotAllocate) {
  const MpcProblem problem = loadProblem(problemFile(kFiles[1]));
  DisturbanceObserver observer(problem, bothModels()[1]);
  const double y[] = {1.0, 0.5, 0.1};
  const double u = 0.1;
  const long start = allocationCount();
  for (int k = 0; k < 100; ++k) observer.update(y, &u, 1 + k % 30);
  observer.reset();
  EXPECT_EQ(allocationCount() - start, 0);
}

TEST(Observer, RefusesBadOptionsAndModels) {
  const MpcProblem good = loadProblem(problemFile(kFiles[1]));
  const auto message = [&](auto change) {
    ObserverOptions options;
    MpcProblem problem = good;
    change(&problem, &options);
    return errorOf([&] { DisturbanceObserver observer(problem, options); });
  };
  using Problem = MpcProblem*;
  using Options = ObserverOptions*;
  EXPECT_EQ(message([](Problem, Options o) { o->period = 0.0; }), "observer: period: must be greater than 0");
  EXPECT_EQ(message([](Problem, Options o) { o->disturbance = 0.0; }),
            "observer: disturbance: must be greater than 0");
  EXPECT_EQ(message([](Problem, Options o) { o->rate = -1.0; }), "observer: rate: must be 0 or more");
  EXPECT_EQ(message([](Problem, Options o) { o->rate_time = 0.0; }),
            "observer: rate_time: must be greater than 0");
  EXPECT_EQ(message([](Problem, Options o) { o->measurement[2] = -1.0; }),
            "observer: measurement[2]: must be greater than 0");
  EXPECT_EQ(message([](Problem, Options o) { o->process[1] = std::nan(""); }),
            "observer: process[1]: must be 0 or more");
  EXPECT_NE(message([](Problem p, Options) { p->B_c = MatrixXd::Zero(3, 2); }).find("one input"),
            std::string::npos);
  EXPECT_NE(message([](Problem p, Options) { p->Bd_c.resize(3, 0); }).find("one disturbance"),
            std::string::npos);
  EXPECT_NE(message([](Problem p, Options) { p->Bd_c.setZero(); }).find("no stable observer"),
            std::string::npos);
  EXPECT_NE(message([](Problem p, Options) { p->A_c = MatrixXd::Zero(5, 5); }).find("1 to 4 states"),
            std::string::npos);
}

}  // namespace
