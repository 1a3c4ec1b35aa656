#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/laws/axis.hpp"
#include "online_support.hpp"

namespace {

using polyfly::Axis;
using polyfly::AxisReference;
using polyfly::AxisSample;
using polyfly::AxisTarget;
using polyfly::kAxisNames;
using polyfly::MapContent;
using polyfly_test::axisContent;
using polyfly_test::axisRefusal;
using polyfly_test::MapInMemory;

std::string replaceAll(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// A refusal names the map, the axis, and `parts`.
void expectRefusal(const std::string& refusal, const std::vector<std::string>& parts) {
  EXPECT_EQ(refusal.rfind("made.map: ", 0), 0u) << refusal;
  for (const std::string& part : parts)
    EXPECT_NE(refusal.find(part), std::string::npos) << part << " in: " << refusal;
}

TEST(Axis, TakesTheMapsOfTheProjectsProblems) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(axisRefusal(i, axisContent(i)), "") << kAxisNames[i].axis;
}

TEST(Axis, RefusesTheMapOfAnotherAxis) {
  expectRefusal(axisRefusal(0, axisContent(1)), {"longitudinal", "'e_p_y'", "not a signal of this axis"});
  expectRefusal(axisRefusal(1, axisContent(0)), {"lateral", "'e_p_x'"});
  expectRefusal(axisRefusal(2, axisContent(0)), {"vertical", "'e_p_x'"});
}

TEST(Axis, RefusesAnIncompleteSolution) {
  MapContent content = axisContent(1);
  content.solver_status = "limited";
  expectRefusal(axisRefusal(1, content), {"solver status", "'complete'", "'limited'"});
}

TEST(Axis, RefusesWrongSignals) {
  MapContent content = axisContent(1);
  content.parameters[2].unit = "deg";
  expectRefusal(axisRefusal(1, content), {"'e_phi'", "unit must be 'rad'", "'deg'"});

  content = axisContent(1);
  content.parameters[4].name = "phi_ref";
  expectRefusal(axisRefusal(1, content), {"'phi_ref'", "not a signal"});

  content = axisContent(1);
  content.inputs[0].name = "theta_cmd";
  expectRefusal(axisRefusal(1, content), {"inputs", "'phi_cmd'", "'theta_cmd'"});

  content = axisContent(1);
  content.inputs[0].unit = "N";
  expectRefusal(axisRefusal(1, content), {"'phi_cmd'", "unit must be 'rad'", "'N'"});
}

TEST(Axis, RefusesAMissingParameter) {
  // The vertical problem has all but the angle: give the lateral axis its map with the signals renamed.
  std::string text = polyfly_test::axisProblem(2);
  text = replaceAll(replaceAll(text, "e_p_z", "e_p_y"), "e_v_z", "e_v_y");
  text = replaceAll(replaceAll(text, "T_cmd", "phi_cmd"), "role: previous_input, of: phi_cmd, unit: m/s^2",
                    "role: previous_input, of: phi_cmd, unit: rad");
  MapContent content =
      polyfly_test::oneRegionContent(replaceAll(text, "role: previous_input, of: phi_cmd, unit: rad",
                                                "role: previous_input, of: phi_cmd, unit: m/s^2"),
                                     {1.0, 1.0});
  for (std::size_t i = 2; i < 4; ++i) content.parameters[i].unit = "rad";
  content.inputs[0].unit = "rad";
  expectRefusal(axisRefusal(1, content), {"'e_phi'", "missing"});
}

TEST(Axis, RefusesAModelThatIsNotItsChain) {
  const std::string text = polyfly_test::axisProblem(1);
  // The velocity must come from the angle with a lag, and the disturbance must act on the velocity.
  const auto refusal_of = [&](const std::string& from, const std::string& to) {
    EXPECT_NE(text.find(from), std::string::npos) << from;
    return axisRefusal(1, polyfly_test::oneRegionContent(replaceAll(text, from, to), {0.3, 0.35, -1.0}));
  };
  expectRefusal(refusal_of("- [0, 1, 0]", "- [0, 2, 0]"), {"model", "derivative of the position"});
  expectRefusal(refusal_of("- [0, 0, -4.0]", "- [0, 0, 4.0]"), {"model", "stable first-order lag"});
  expectRefusal(refusal_of("- [0, 0, -4.0]", "- [0, 0.5, -4.0]"), {"model", "first-order lag"});
}

TEST(Axis, BindsByNameNotByPlace) {
  // The same map with its parameters in another order gives the same input.
  MapContent content = axisContent(1);
  MapContent turned = content;
  std::reverse(turned.parameters.begin(), turned.parameters.end());
  std::reverse(turned.laws.begin(), turned.laws.end() - 1);
  const MapInMemory map(content);
  const MapInMemory turned_map(turned);
  Axis axis(map.map(), kAxisNames[1], {});
  Axis turned_axis(turned_map.map(), kAxisNames[1], {});
  const AxisSample sample{0.5, -0.3, 0.04};
  const AxisReference reference{0.1, 0.2, 0.3, 0.1};
  polyfly::AxisReport report;
  polyfly::AxisReport turned_report;
  EXPECT_EQ(axis.evaluate(sample, reference, 0.02, 0.0, report), polyfly::ControlStatus::kOptimal);
  EXPECT_EQ(turned_axis.evaluate(sample, reference, 0.02, 0.0, turned_report),
            polyfly::ControlStatus::kOptimal);
  EXPECT_NEAR(report.input, turned_report.input, 1e-15);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(report.theta[i], turned_report.theta[4 - i]);
}

TEST(Axis, AnOffsetMovesItsInputsAgainstTheBoundsAndNothingElse) {
  const polyfly::MpcProblem problem = polyfly::parseProblem(polyfly_test::axisProblem(1), "problem");
  Axis axis(polyfly::onlineAxisLaw(problem), kAxisNames[1], {});
  const AxisReference reference{0.1, 0.2, 0.3, 0.1};
  constexpr double kOffset = 0.04;
  polyfly::AxisReport without, with;
  const AxisSample near{0.12, 0.17, -0.02};
  EXPECT_EQ(axis.evaluate(near, reference, 0.02, 0.0, without), polyfly::ControlStatus::kOptimal);
  EXPECT_EQ(axis.evaluate(near, reference, 0.02, kOffset, with), polyfly::ControlStatus::kOptimal);
  EXPECT_LT(std::abs(without.input) + kOffset, axis.inputUpper());
  EXPECT_NEAR(with.input, without.input + kOffset, 1e-9);
  const AxisSample far{2.9, 1.0, -0.2};  // a bound is active
  EXPECT_EQ(axis.evaluate(far, reference, axis.inputUpper(), kOffset, with),
            polyfly::ControlStatus::kOptimal);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_LE(std::abs(with.theta[i]), i < 2 ? 3.0 : 0.6);
  EXPECT_EQ(std::abs(with.input), axis.inputUpper());
}

/// A map of one region of a minimum-peak robust MPC, u = sum of gains and parameters.
MapContent robustContent(const std::string& problem_text, const std::vector<double>& gains) {
  MapContent content = axisContent(1);
  content.problem_text = problem_text;
  content.parameters = {{"e_p_y", "m", -2, 2},
                        {"e_v_y", "m/s", -2, 2},
                        {"e_phi", "rad", -0.5, 0.5},
                        {"v_y_ref", "m/s", -0.8, 0.8},
                        {"phi_cmd_ref", "rad", -0.15, 0.15}};
  content.parameters.resize(gains.size());
  content.laws = gains;
  content.laws.push_back(0.0);
  return content;
}

/// Lateral axis whose model has this drag [1/s] and B_d, and finds the rest of the drag.
Axis lateralAxis(double drag, double disturbance_gain, bool adapt_model = true) {
  polyfly::MpcProblem problem = polyfly::parseProblem(polyfly_test::axisProblem(1), "problem");
  problem.A_c(1, 1) = -drag;
  problem.Bd_c(1, 0) = disturbance_gain;
  polyfly::MultirotorOptions options;
  options.adapt_model = adapt_model;
  return {polyfly::onlineAxisLaw(problem), kAxisNames[1], options};
}

/// The drag of model and estimate together [1/s].
double wholeDrag(const Axis& axis, double disturbance_gain) {
  AxisReference moving;
  moving.velocity = 1.0;
  return axis.drag() - disturbance_gain * (axis.disturbanceAt(moving) - axis.disturbanceAt({}));
}

/// Flies to and fro for 30 s with a drag of 0.17 1/s in wind; the velocity at the end [m/s].
double teach(Axis& axis) {
  constexpr double kPeriod = 0.01, kDrag = 0.17, kWind = 0.3, kGravity = 9.8066;
  constexpr int kParts = 10;
  AxisSample sample;
  for (int k = 0; k < 3000; ++k) {
    const double input = 0.2 * std::cos(0.01 * k), velocity = sample.velocity;
    for (int part = 0; part < kParts; ++part) {
      const double step = kPeriod / kParts;
      sample.position += step * sample.velocity;
      sample.velocity += step * (-kGravity * sample.angle - kDrag * sample.velocity + kWind);
      sample.angle += step * axis.lagGain() / axis.lagTime() * (input - sample.angle / axis.lagGain());
    }
    axis.observe(sample, input, 1, velocity);
  }
  return sample.velocity;
}

TEST(Axis, KeepsTheDragOfTheVehicleInAnotherModel) {
  Axis axis = lateralAxis(0.01, 1.0), twice = lateralAxis(0.01, 2.0), next = lateralAxis(0.05, 2.0);
  const double velocity = teach(axis);
  teach(twice);
  EXPECT_NEAR(wholeDrag(axis, 1.0), 0.17, 0.01);
  EXPECT_NEAR(wholeDrag(twice, 2.0), 0.17, 0.01);
  next.transferState(axis);
  EXPECT_NEAR(wholeDrag(next, 2.0), wholeDrag(axis, 1.0), 1e-12);

  // One that finds no drag holds against the same force at this velocity.
  Axis fixed = lateralAxis(0.01, 1.0, false);
  fixed.transferState(axis);
  AxisReference now;
  now.velocity = velocity;
  EXPECT_GT(std::abs(velocity), 0.5);
  EXPECT_EQ(wholeDrag(fixed, 1.0), fixed.drag());
  EXPECT_NEAR(fixed.disturbance(), axis.disturbanceAt(now), 0.01);

  axis.setDisturbance(0.2);
  EXPECT_EQ(axis.disturbance(), 0.2);
  EXPECT_EQ(wholeDrag(axis, 1.0), axis.drag());
}

TEST(Axis, TakesTheMapOfARobustProblem) {
  const std::string text = polyfly_test::robustAxisProblem("lateral");
  const MapInMemory map(robustContent(text, {1.0, 10.0, 100.0, 1000.0, 10000.0}));
  Axis axis(map.map(), kAxisNames[1], {});
  const AxisSample sample{0.5, -0.3, 0.04};
  const AxisReference reference{0.1, 0.2, 0.3, 0.0};
  polyfly::AxisReport report;
  EXPECT_EQ(axis.evaluate(sample, reference, 0.02, 0.0, report), polyfly::ControlStatus::kOptimal);
  ASSERT_EQ(report.size, 5);
  const AxisTarget target = axis.target(reference, 0.0, 0.0);
  EXPECT_NEAR(report.theta[0], 0.4, 1e-15);
  EXPECT_NEAR(report.theta[1], -0.5, 1e-15);
  EXPECT_NEAR(report.theta[2], 0.04 - target.angle, 1e-15);
  EXPECT_EQ(report.theta[3], 0.2);
  EXPECT_EQ(report.theta[4], target.input);

  // without references the target is level flight
  const MapInMemory level_map(robustContent(text, {1.0, 10.0, 100.0}));
  Axis level(level_map.map(), kAxisNames[1], {});
  EXPECT_EQ(level.evaluate(sample, reference, 0.02, 0.0, report), polyfly::ControlStatus::kOptimal);
  ASSERT_EQ(report.size, 3);
  EXPECT_NEAR(report.theta[2], 0.04, 1e-15);

  MapContent wrong = robustContent(text, {1.0, 10.0, 100.0, 1000.0, 10000.0});
  wrong.parameters[4].name = "phi_cmd_prev";  // it has no previous input
  expectRefusal(axisRefusal(1, wrong), {"'phi_cmd_prev'", "not a signal"});
  expectRefusal(axisRefusal(1, robustContent(text, {1.0, 10.0})), {"'e_phi'", "missing"});
  const std::string discrete = replaceAll(text, "model:\n", "model:\n  time: discrete\n");
  expectRefusal(axisRefusal(1, robustContent(discrete, {1.0, 10.0, 100.0})), {"model.time", "continuous"});
}

TEST(Axis, TakesTheModelsOfTheRobustProblems) {
  for (const char* axis : {"longitudinal", "lateral", "vertical"}) {
    const polyfly::MpcProblem problem =
        polyfly::parseFlightModel(polyfly_test::robustAxisProblem(axis), "robust.yaml");
    EXPECT_TRUE(problem.minimum_peak);
    EXPECT_EQ(problem.name, std::string("aslquad_") + axis);
    EXPECT_EQ(problem.parameters.size(), problem.states.size());
    EXPECT_EQ(problem.Bd_c.cols(), 1);
  }
}

TEST(AxisTarget, AtRestIsTheSteadyStateOfEquation6) {
  for (std::size_t i = 0; i < 3; ++i) {
    const MapInMemory map(axisContent(i));
    Axis axis(map.map(), kAxisNames[i], {});
    const polyfly::MpcProblem problem = polyfly::parseProblem(polyfly_test::axisProblem(i), "problem");
    const polyfly::DiscreteModel model = polyfly::discretise(problem, problem.sampling_time);
    for (const double disturbance : {0.0, 0.7, -1.3}) {
      const polyfly::SteadyState steady = polyfly::steadyState(
          model, problem.C, Eigen::VectorXd::Constant(1, disturbance), Eigen::VectorXd::Ones(1));
      const AxisTarget target = axis.target({1.0, 0.0, 0.0, 0.0}, disturbance, 0.0);
      EXPECT_NEAR(target.input, steady.u(0), 1e-10);
      if (problem.stateCount() == 3) {
        EXPECT_NEAR(target.angle, steady.x(2), 1e-10);
      }
    }
  }
}

TEST(AxisTarget, SatisfiesTheModelAlongAMovingReference) {
  // (p_ref, v_ref, s_ref) with u_ref must solve x' = A x + B u + Bd d: the derivative by central differences.
  constexpr double kStep = 1e-4;
  // Angular frequency of the sine [rad/s].
  constexpr double kRate = 1.7;
  const auto disturbance = [](double t) { return 0.4 + 0.3 * std::sin(0.9 * t); };
  const auto change = [](double t) { return 0.3 * 0.9 * std::cos(0.9 * t); };
  const auto along = [](double t) {
    return AxisReference{2.0 * std::sin(kRate * t), 2.0 * kRate * std::cos(kRate * t),
                         -2.0 * kRate * kRate * std::sin(kRate * t),
                         -2.0 * kRate * kRate * kRate * std::cos(kRate * t)};
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const MapInMemory map(axisContent(i));
    Axis axis(map.map(), kAxisNames[i], {});
    const polyfly::MpcProblem problem = polyfly::parseProblem(polyfly_test::axisProblem(i), "problem");
    const int states = problem.stateCount();
    const auto state_at = [&](double t) {
      const AxisReference reference = along(t);
      Eigen::VectorXd state(states);
      state.head(2) << reference.position, reference.velocity;
      if (states == 3) state(2) = axis.target(reference, disturbance(t), change(t)).angle;
      return state;
    };
    for (double t = 0.0; t < 4.0; t += 0.37) {
      const Eigen::VectorXd rate = (state_at(t + kStep) - state_at(t - kStep)) / (2.0 * kStep);
      const double input = axis.target(along(t), disturbance(t), change(t)).input;
      const Eigen::VectorXd model =
          problem.A_c * state_at(t) + problem.B_c * input + problem.Bd_c * disturbance(t);
      EXPECT_LT((rate - model).lpNorm<Eigen::Infinity>(), 1e-6) << kAxisNames[i].axis << " at " << t;
    }
  }
}

TEST(AxisTarget, ClosedLoopTracksASineUnderWindWithoutOffset) {
  // The linear model, integrated by RK4, flown with observer and law at 100 Hz.
  constexpr double kPeriod = 0.01;
  constexpr int kSubsteps = 5;
  constexpr double kWind = 0.6;
  constexpr double kRate = 1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const MapInMemory map(axisContent(i));
    Axis axis(map.map(), kAxisNames[i], {});
    const polyfly::MpcProblem problem = polyfly::parseProblem(polyfly_test::axisProblem(i), "problem");
    Eigen::VectorXd state = Eigen::VectorXd::Zero(problem.stateCount());
    double input = 0.0;
    double worst = 0.0;
    for (int k = 0; k < 3000; ++k) {
      const double t = k * kPeriod;
      const AxisReference reference{std::sin(kRate * t), kRate * std::cos(kRate * t), -std::sin(kRate * t),
                                    -std::cos(kRate * t)};
      const AxisSample sample{state(0), state(1), state.size() == 3 ? state(2) : 0.0};
      axis.observe(sample, input, 1);
      polyfly::AxisReport report;
      ASSERT_NE(axis.evaluate(sample, reference, input, 0.0, report), polyfly::ControlStatus::kHoldLast);
      input = report.input;
      if (t > 20.0) worst = std::max(worst, std::abs(sample.position - reference.position));
      const auto rate = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        return problem.A_c * x + problem.B_c * input + problem.Bd_c * kWind;
      };
      for (int s = 0; s < kSubsteps; ++s) {
        const double h = kPeriod / kSubsteps;
        const Eigen::VectorXd k1 = rate(state);
        const Eigen::VectorXd k2 = rate(state + 0.5 * h * k1);
        const Eigen::VectorXd k3 = rate(state + 0.5 * h * k2);
        const Eigen::VectorXd k4 = rate(state + h * k3);
        state += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
      }
    }
    // What is left is the zero-order hold of the input, half a period late.
    EXPECT_LT(worst, 0.02) << kAxisNames[i].axis;
    EXPECT_NEAR(axis.disturbance(), kWind, 0.05) << kAxisNames[i].axis;
  }
}

}  // namespace
