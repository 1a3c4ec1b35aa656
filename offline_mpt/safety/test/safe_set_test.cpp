// The safe set and what it promises, against closed forms, brute force and finely integrated motions.
#include "safety_filter/safe_set.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "error_of.hpp"
#include "holds.hpp"
#include "made_filters.hpp"
#include "safety_filter/prove_filter.hpp"
#include "safety_filter/uncertain_model.hpp"

namespace polyfly {
namespace {

SafetyFilterProblem complete(const MadeFilter& made) {
  const SafetyFilterProblem problem = made.problem();
  return parseSafetyFilter(withSafeSet(problem, computeSafeSet(problem)), "made.yaml");
}

/// Least slack of H xi <= k.
double depth(const SafeSet& set, const Eigen::VectorXd& xi) { return (set.k - set.H * xi).minCoeff(); }

/// The admissible inputs at xi, of a problem with one input.
struct Admissible {
  double lower, upper;
};
Admissible admissible(const SafetyFilterProblem& problem, const Eigen::VectorXd& xi) {
  Admissible result{problem.inputs[0].lower, problem.inputs[0].upper};
  const SafeSet& set = *problem.safe_set;
  for (Eigen::Index i = 0; i < set.G.rows(); ++i) {
    const double bound = set.b[i] + set.M.row(i).dot(xi);
    if (set.G(i, 0) > 0.0) result.upper = std::min(result.upper, bound / set.G(i, 0));
    if (set.G(i, 0) < 0.0) result.lower = std::max(result.lower, bound / set.G(i, 0));
    if (set.G(i, 0) == 0.0) {
      EXPECT_GE(bound, 0.0);
    }
  }
  return result;
}

// A double integrator stays in its ranges if and only if full braking against the worst disturbance does: after k
// periods it is at p + k h v - k^2 h^2 u / 2 + sum_j (W_p + j h W_v). The ranges are inset by h^2 u / 8.
TEST(SafeSet, IsTheClosedFormOfADoubleIntegrator) {
  for (const double w : {0.0, 0.3}) {
    MadeFilter made;
    made.disturbance = w;
    const SafetyFilterProblem problem = complete(made);
    const double h = made.period, u = made.strength, W_p = w * h * h / 2, W_v = w * h;
    const double greatest_p = 1.5 - h * h * u / 8, greatest_v = 1.5;
    const auto slack = [&](double p, double v) {
      double least = greatest_v - v;
      double pushed = 0.0;
      for (int k = 0; k < 40; ++k) {
        least = std::min(least, (greatest_p - pushed - p - k * h * v + k * k * h * h * u / 2) / (1 + k * h));
        pushed += W_p + k * h * W_v;
      }
      return least;
    };
    int inside = 0, outside = 0;
    for (double p = -1.55; p < 1.56; p += 0.011) {
      for (double v = -1.55; v < 1.56; v += 0.013) {
        const double expected = std::min(slack(p, v), slack(-p, -v));
        if (std::fabs(expected) < 1e-5) continue;
        ++(expected > 0.0 ? inside : outside);
        EXPECT_EQ(depth(*problem.safe_set, Eigen::Vector2d(p, v)) > 0.0, expected > 0.0)
            << p << " " << v << " with w " << w;
      }
    }
    EXPECT_GT(inside, 10000);
    EXPECT_GT(outside, 1000);
  }
}

struct Motion {
  SafetyFilterProblem problem;
  std::mt19937_64 random{7};

  double uniform(double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  }
  double corner(double size) { return uniform(0.0, 1.0) < 0.5 ? -size : size; }

  Eigen::Vector2d slope(const Eigen::Vector2d& x, double u, double w) const {
    Eigen::Vector2d result = problem.A_c * x + problem.B_c.col(0) * u;
    if (problem.Bd_c.cols() > 0) result += problem.Bd_c.col(0) * w;
    return result;
  }

  /// One period by the method of Runge and Kutta. The disturbance jumps between its ends at random times.
  void advance(Eigen::Vector2d& x, double before, double u, int steps) {
    const double h = problem.sampling_time / steps;
    const double w_size = problem.disturbances.empty() ? 0.0 : problem.disturbances[0].upper;
    double w = corner(w_size);
    for (int i = 0; i < steps; ++i) {
      if (uniform(0.0, 1.0) < 0.1) w = corner(w_size);
      const double input = (i + 0.5) * h < problem.delay ? before : u;
      const Eigen::Vector2d k1 = slope(x, input, w), k2 = slope(x + h / 2 * k1, input, w),
                            k3 = slope(x + h / 2 * k2, input, w), k4 = slope(x + h * k3, input, w);
      x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      for (int j = 0; j < 2; ++j) {
        const auto& range = problem.states[static_cast<std::size_t>(j)];
        ASSERT_LE(x[j], range.upper + 1e-9) << "at " << x.transpose();
        ASSERT_GE(x[j], range.lower - 1e-9) << "at " << x.transpose();
      }
    }
  }
};

// Wishes that push towards the edge, errors at their ends. The answer is projected here, not by a map.
void flyAdversarially(const MadeFilter& made, int flights, int periods) {
  Motion motion{complete(made)};
  const SafetyFilterProblem& problem = motion.problem;
  const bool delayed = problem.delay > 0.0;
  double closest = 1e9;
  for (int flight = 0; flight < flights; ++flight) {
    Eigen::Vector2d x(motion.uniform(-1.4, 1.4), motion.uniform(-1.4, 1.4));
    double before = motion.uniform(-made.strength, made.strength);
    const double push = flight % 3 == 0 ? 5.0 : flight % 3 == 1 ? -5.0 : 0.0;
    for (int k = 0; k < periods; ++k) {
      Eigen::VectorXd xi(problem.augmentedCount());
      for (int j = 0; j < 2; ++j) xi[j] = x[j] + motion.corner(problem.state_errors[j]);
      if (delayed) xi[2] = before;
      const double inside = depth(*problem.safe_set, xi);
      if (k == 0 && inside < 0.0) break;
      ASSERT_GE(inside, -1e-12) << "flight " << flight << ", period " << k << " at " << xi.transpose();
      closest = std::min(closest, inside);
      const Admissible range = admissible(problem, xi);
      ASSERT_LE(range.lower, range.upper);
      const double wish = push == 0.0 ? motion.corner(5.0) : push;
      double u = std::clamp(wish, range.lower, range.upper) + motion.corner(problem.input_errors[0]);
      u = std::clamp(u, problem.inputs[0].lower, problem.inputs[0].upper);
      motion.advance(x, before, u, 40);
      if (::testing::Test::HasFatalFailure()) return;
      before = u;
    }
  }
  EXPECT_LT(closest, 0.02) << "never near the edge: the test shows nothing";
}

TEST(SafeSet, HoldsADoubleIntegratorUnderDisturbances) {
  MadeFilter made;
  made.disturbance = 0.4;
  made.input_error = 1e-3;
  flyAdversarially(made, 60, 100);
}

TEST(SafeSet, HoldsUnderErrorsOfMeasurement) {
  MadeFilter made;
  made.disturbance = 0.1;
  made.error = 0.01;
  flyAdversarially(made, 60, 100);
}

TEST(SafeSet, HoldsWithADelayOfPartOfThePeriodAndOfAllOfIt) {
  for (const double delay : {0.01, 0.02, 0.05}) {
    MadeFilter made;
    made.delay = delay;
    made.disturbance = 0.2;
    made.input_error = 1e-3;
    flyAdversarially(made, 60, 100);
  }
}

// Modes that swing and grow: nothing of the exponential's series vanishes.
TEST(SafeSet, HoldsAnUnstableOscillator) {
  MadeFilter made;
  made.A = "[[0.1, 1], [-3, 0.4]]";
  made.strength = 6.0;
  made.disturbance = 0.2;
  made.input_error = 1e-3;
  flyAdversarially(made, 60, 100);
  made.delay = 0.03;
  flyAdversarially(made, 60, 100);
}

// A coarse period, in which a state bends far out of the chord between samples.
TEST(SafeSet, HoldsBetweenSamplesOfACoarsePeriod) {
  MadeFilter made;
  made.period = 0.5;
  flyAdversarially(made, 60, 40);
  const UncertainModel model = uncertainModel(made.problem());
  EXPECT_EQ(model.excursion[0], Rational(1, 16));  // h^2 u / 8
  EXPECT_EQ(model.excursion[1], 0);
}

TEST(SafeSet, SampledModelIsThatOfTheDoubleIntegrator) {
  MadeFilter made;
  made.period = 0.5;
  made.delay = 0.25;
  made.disturbance = 0.5;
  const UncertainModel model = uncertainModel(made.problem());
  ASSERT_EQ(model.stateCount(), 3);
  EXPECT_EQ(model.A(0, 1), Rational(1, 2));
  EXPECT_EQ(model.A(0, 2), Rational(3, 32));  // the first quarter of a second: 1/4 * 3/8
  EXPECT_EQ(model.A(1, 2), Rational(1, 4));
  EXPECT_EQ(model.A(2, 2), 0);
  EXPECT_EQ(model.B(0, 0), Rational(1, 32));
  EXPECT_EQ(model.B(1, 0), Rational(1, 4));
  EXPECT_EQ(model.B(2, 0), 1);
  EXPECT_EQ(model.W[0], Rational(1, 16));
  EXPECT_EQ(model.W[1], Rational(1, 4));
  EXPECT_EQ(model.W[2], 0);
  // Half a period at each of two inputs: 4 * tau (h - tau) / h for v.
  EXPECT_EQ(model.excursion[1], Rational(1, 2));
}

TEST(SafeSet, RefusesProblemsWithoutOne) {
  MadeFilter weak;
  weak.disturbance = 2.5;
  EXPECT_TRUE(holds(errorOf([&] { computeSafeSet(weak.problem()); }),
                    "made.yaml: model: no set of states can be kept"));
  MadeFilter blind;
  blind.error = 1.6;
  EXPECT_THROW(computeSafeSet(blind.problem()), Error);
  MadeFilter slow;
  slow.period = 6.0;
  EXPECT_THROW(computeSafeSet(slow.problem()), Error);
}

}  // namespace
}  // namespace polyfly
