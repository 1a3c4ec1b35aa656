// What the robust law answers where no plan meets all bounds, against linear programs without a map.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>
#include <string>

#include "offline_mpt/encode.hpp"
#include "online_controller/laws/axis.hpp"
#include "project_root.hpp"
#include "region_maps/map_image.hpp"
#include "robust_mpc/online_lp.hpp"
#include "robust_mpc/robust_law.hpp"

namespace polyfly {
namespace {

constexpr int kHalvings = 40;

/// A robust problem of the lateral axis, with its map.
struct Solved {
  explicit Solved(const std::string& file)
      : problem(loadRobustProblem(problemFile(file))),
        online(problem),
        image(content()),
        map(image.view(file)) {}

  MapContent content() const {
    const FeasibleSet set = projectFeasibleSet(buildRobustProgram(problem));
    const RoundedLaw law = roundLaw(problem, explicitLaw(problem, set), ExploreStatus::kComplete);
    return encode(law.program, law.partition);
  }

  bool isError(int j) const { return problem.parameters[static_cast<std::size_t>(j)].state >= 0; }

  /// The greatest share of the errors, or of all parameters, that has a plan; below 0: none.
  double greatestShare(const Eigen::VectorXd& theta, bool all) {
    const auto has_plan = [&](double share) { return online.solve(shrunk(theta, share, all)).feasible; };
    if (!has_plan(0.0)) return -1.0;
    double inside = 0.0, outside = 1.0;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (inside + outside);
      (has_plan(middle) ? inside : outside) = middle;
    }
    return inside;
  }

  Eigen::VectorXd shrunk(Eigen::VectorXd theta, double share, bool all) const {
    for (int j = 0; j < problem.parameterCount(); ++j) {
      if (all || isError(j)) theta[j] *= share;
    }
    return theta;
  }

  double referencePart(const Eigen::VectorXd& theta) const {
    double sum = 0.0;
    for (int j = 0; j < problem.parameterCount(); ++j) {
      if (!isError(j))
        sum += nearestDouble(problem.parameters[static_cast<std::size_t>(j)].input_shift[0]) * theta[j];
    }
    return sum;
  }

  RobustProblem problem;
  OnlineLp online;
  MapImage image;
  RegionMap map;
};

// Errors of position, velocity and angle up to twice their ranges, with the reference of velocity in its range.
TEST(ShrunkErrors, AreTheGreatestShareThatHasAPlan) {
  Solved solved("robust/aslquad_lateral.yaml");
  Axis axis(solved.map, kAxisNames[1], MultirotorOptions());
  std::mt19937 random(4);
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  int shrunk = 0;
  for (int i = 0; i < 300; ++i) {
    AxisSample sample;
    AxisReference reference;
    sample.position = 3.0 * within(random);
    reference.velocity = 0.8 * within(random);
    sample.velocity = reference.velocity + 3.0 * within(random);
    sample.angle = 0.6 * within(random);
    AxisReport report;
    const ControlStatus status = axis.evaluate(sample, reference, 0.0, 0.0, report);
    if (status != ControlStatus::kLeastViolation) continue;
    ++shrunk;
    Eigen::VectorXd theta(solved.problem.parameterCount());
    for (int j = 0; j < theta.size(); ++j) {
      const Signal& signal = solved.problem.parameters[static_cast<std::size_t>(j)].signal;
      theta[j] = std::clamp(report.theta[static_cast<std::size_t>(j)], signal.lower, signal.upper);
    }
    bool all = false;
    double share = solved.greatestShare(theta, all);
    if (share < 0.0) share = solved.greatestShare(theta, all = true);
    ASSERT_GE(share, 0.0);
    EXPECT_LT(share, 1.0);
    const Eigen::VectorXd at = solved.shrunk(theta, share, all);
    const OnlineLp::Answer answer = solved.online.solve(at);
    ASSERT_TRUE(answer.feasible);
    EXPECT_NEAR(report.input, answer.input + solved.referencePart(at), 1e-5) << theta.transpose();
  }
  EXPECT_GT(shrunk, 100);
}

TEST(ShrunkErrors, WhatIsNotFiniteHasNoAnswer) {
  const Solved solved("robust/aslquad_lateral.yaml");
  Axis axis(solved.map, kAxisNames[1], MultirotorOptions());
  AxisSample sample;
  sample.position = std::nan("");
  AxisReport report;
  EXPECT_EQ(axis.evaluate(sample, AxisReference(), 0.0, 0.0, report), ControlStatus::kHoldLast);
}

}  // namespace
}  // namespace polyfly
