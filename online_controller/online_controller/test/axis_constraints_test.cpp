// Axes whose problems bound states themselves, block moves, or have models in discrete time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/online_program.hpp"
#include "online_controller/laws/axis.hpp"
#include "online_support.hpp"
#include "polyfly_base/error.hpp"

namespace {

using polyfly::Axis;
using polyfly::AxisReference;
using polyfly::AxisReport;
using polyfly::AxisSample;
using polyfly::ControlStatus;
using polyfly::kAxisNames;
using polyfly::MpcProblem;

constexpr double kTolerance = 1e-9;
constexpr double kPeriod = 0.01;

std::string insertedBefore(std::string text, const std::string& place, const std::string& lines) {
  const std::size_t at = text.find(place);
  EXPECT_NE(at, std::string::npos) << place;
  return text.insert(at, lines);
}

/// The lateral axis with a soft bound on the speed itself.
std::string limitedText(double speed) {
  char lines[200];
  std::snprintf(lines, sizeof lines,
                "moves: [1, 1, 2, 4, 12]\nconstraints:\n"
                "  - {of: v_y, range: [-%g, %g], soft: {linear: 4000, quadratic: 40}}\n",
                speed, speed);
  const std::string text = insertedBefore(polyfly_test::axisProblem(1), "weights:", lines);
  return insertedBefore(text, "  - {name: e_p_y",
                        "  - {name: v_y_ref, role: state_reference, of: v_y, unit: m/s, range: [-4, 4]}\n");
}

std::string rowsText(const Eigen::MatrixXd& matrix) {
  std::string text = "[";
  char number[40];
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    text += i > 0 ? ", [" : "[";
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      std::snprintf(number, sizeof number, "%s%.17g", j > 0 ? ", " : "", matrix(i, j));
      text += number;
    }
    text += "]";
  }
  return text + "]";
}

/// The problem of an axis with its model over one sampling time.
std::string discreteText(std::size_t axis) {
  std::string text = polyfly_test::axisProblem(axis);
  const MpcProblem problem = polyfly::parseProblem(text, "continuous");
  const polyfly::DiscreteModel model = polyfly::discretise(problem, problem.sampling_time);
  const std::size_t from = text.find("  A:");
  text.replace(from, text.find("  C:") - from,
               "  time: discrete\n  A: " + rowsText(model.A) + "\n  B: " + rowsText(model.B) +
                   "\n  B_d: " + rowsText(model.Bd) + "\n");
  return text;
}

TEST(AxisConstraints, AModelInDiscreteTimeFliesLikeItsContinuousOne) {
  for (std::size_t i = 0; i < 3; ++i) {
    const MpcProblem problem = polyfly::parseProblem(discreteText(i), "discrete");
    EXPECT_TRUE(problem.discrete);
    Axis discrete(polyfly::onlineAxisLaw(problem), kAxisNames[i], {});
    Axis continuous(polyfly::onlineAxisLaw(polyfly::parseProblem(polyfly_test::axisProblem(i), "continuous")),
                    kAxisNames[i], {});
    const AxisReference reference{0.1, 0.2, 0.3, 0.1};
    for (int k = 0; k < 20; ++k) {
      const AxisSample sample{0.1 * k - 1.0, 0.3 - 0.05 * k, i < 2 ? 0.01 * k : 0.0};
      discrete.observe(sample, 0.02, 1);
      continuous.observe(sample, 0.02, 1);
      AxisReport expected, report;
      EXPECT_EQ(continuous.evaluate(sample, reference, 0.02, 0.0, expected), ControlStatus::kOptimal);
      EXPECT_EQ(discrete.evaluate(sample, reference, 0.02, 0.0, report), ControlStatus::kOptimal);
      EXPECT_NEAR(report.input, expected.input, 1e-7);
      EXPECT_NEAR(discrete.disturbance(), continuous.disturbance(), 1e-7);
    }
  }
}

TEST(AxisConstraints, TheReferenceOfABoundedStateIsBound) {
  const MpcProblem problem = polyfly::parseProblem(limitedText(2.0), "limited");
  Axis axis(polyfly::onlineAxisLaw(problem), kAxisNames[1], {});
  polyfly::OnlineProgram oracle(condense(problem));
  const AxisSample sample{0.5, 1.4, 0.05};
  const AxisReference reference{1.2, 1.5, 0.0, 0.0};
  AxisReport report;
  ASSERT_EQ(axis.evaluate(sample, reference, 0.02, 0.0, report), ControlStatus::kOptimal);
  ASSERT_EQ(report.size, 6);
  EXPECT_EQ(report.theta[0], 1.5);
  EXPECT_NEAR(report.theta[2], 1.4 - 1.5, 1e-15);
  double input = 0.0;
  ASSERT_EQ(oracle.solve(report.theta.data(), &input), polyfly::QpStatus::kOptimal);
  EXPECT_NEAR(report.input, input, kTolerance);
}

/// Greatest speed on the way to a point that is 8 m away.
double greatestSpeed(const MpcProblem& problem) {
  Axis axis(polyfly::onlineAxisLaw(problem), kAxisNames[1], {});
  const polyfly::DiscreteModel plant = polyfly::discretise(problem, kPeriod);
  Eigen::VectorXd state = Eigen::VectorXd::Zero(3);
  double input = 0.0, greatest = 0.0;
  for (int k = 0; k < 1500; ++k) {
    AxisReport report;
    const AxisSample sample{state(0), state(1), state(2)};
    EXPECT_EQ(axis.evaluate(sample, {8.0, 0.0, 0.0, 0.0}, input, 0.0, report), ControlStatus::kOptimal);
    input = report.input;
    state = (plant.A * state + plant.B * input).eval();
    greatest = std::max(greatest, std::abs(state(1)));
  }
  EXPECT_NEAR(state(0), 8.0, 0.05);
  return greatest;
}

TEST(AxisConstraints, ASoftBoundOnTheSpeedLimitsTheFlight) {
  EXPECT_GT(greatestSpeed(polyfly::parseProblem(polyfly_test::axisProblem(1), "free")), 2.5);
  EXPECT_LT(greatestSpeed(polyfly::parseProblem(limitedText(2.0), "limited")), 2.05);
}

TEST(AxisConstraints, AReferenceOfAnotherStateIsRefused) {
  std::string text = limitedText(2.0);
  const std::string lines =
      "  - {name: p_y_ref, role: state_reference, of: phi, unit: rad, range: [-1, 1]}\n";
  text = insertedBefore(text, "  - {name: e_p_y", lines);
  try {
    const Axis axis(polyfly::onlineAxisLaw(polyfly::parseProblem(text, "wrong")), kAxisNames[1], {});
    FAIL() << "accepted";
  } catch (const polyfly::Error& error) {
    EXPECT_NE(std::string(error.what()).find("p_y_ref"), std::string::npos) << error.what();
  }
}

TEST(AxisConstraints, PlansOfBlockedMovesAreFollowedStageByStage) {
  const MpcProblem problem = polyfly::parseProblem(limitedText(2.0), "limited");
  const auto law = polyfly::onlineAxisLaw(problem);
  const double theta[] = {0.0, -1.0, 0.4, 0.05, 0.0, 0.1};
  double first = 0.0;
  ASSERT_EQ(law->evaluate(theta, &first).status, polyfly::LookupStatus::kInside);
  const auto planned = [&](int stage) {
    double input = 0.0;
    EXPECT_TRUE(law->planned(stage, 0.1, &input));
    return input;
  };
  EXPECT_NEAR(planned(0), first, 1e-12);
  EXPECT_EQ(planned(2), planned(3));
  EXPECT_EQ(planned(4), planned(7));
  EXPECT_EQ(planned(8), planned(40));
  EXPECT_NE(planned(3), planned(4));
}

}  // namespace
