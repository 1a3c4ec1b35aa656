// The laws that solve online: against the dense solver, and without a single allocation.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "allocations.hpp"
#include "mpc_core/dense_qp.hpp"
#include "mpc_core/online_program.hpp"
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "online_support.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

std::array<MpcProblem, 3> problems() {
  std::array<MpcProblem, 3> result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = parseProblem(polyfly_test::axisProblem(i), "problem");
  return result;
}

/// Largest difference of the first input to DenseQp's over random parameters, twice as wide as the box.
double differenceToDense(const ParametricProgram& program, int* infeasible) {
  OnlineProgram online(program);
  DenseQp dense(program.H, program.A, program.equalities);
  std::mt19937_64 random(21);
  double worst = 0.0;
  for (int round = 0; round < 400; ++round) {
    Eigen::VectorXd theta(program.parameterCount());
    for (int i = 0; i < program.parameterCount(); ++i) {
      const Signal& signal = program.parameters[static_cast<std::size_t>(i)];
      theta(i) = 2.0 * std::uniform_real_distribution<double>(signal.lower, signal.upper)(random);
    }
    const Eigen::VectorXd g = program.f + program.F * theta;
    const Eigen::VectorXd b = program.b + program.S * theta;
    const QpStatus expected = dense.solve(g.data(), b.data());
    Eigen::VectorXd u = Eigen::VectorXd::Zero(program.inputCount());
    EXPECT_EQ(online.solve(theta.data(), u.data()), expected) << "round " << round;
    if (expected != QpStatus::kOptimal) {
      ++*infeasible;
      continue;
    }
    const Eigen::VectorXd other = program.E * dense.z() + program.C * theta + program.c;
    worst = std::max(worst, (u - other).cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST(OnlineProgram, AgreesWithTheDenseSolverOnTheAxes) {
  for (const MpcProblem& problem : problems()) {
    int infeasible = 0;
    EXPECT_LT(differenceToDense(condense(problem), &infeasible), 1e-9) << problem.name;
    EXPECT_EQ(infeasible, 0);
  }
}

TEST(OnlineProgram, AgreesWithTheDenseSolverWithBoundedStates) {
  MpcProblem problem = problems()[1];
  problem.states[1].lower = -2.5;
  problem.states[1].upper = 2.5;
  problem.states[2].lower = -0.5;
  problem.states[2].upper = 0.5;
  int infeasible = 0;
  EXPECT_LT(differenceToDense(condense(problem), &infeasible), 1e-8);
  EXPECT_GT(infeasible, 50);
  EXPECT_LT(infeasible, 350);
}

TEST(OnlineProgram, RefusesWhatIsNotConvex) {
  ParametricProgram program = condense(problems()[2]);
  program.H.setZero();
  EXPECT_THROW(OnlineProgram{program}, Error);
}

/// The greatest angle that is commanded, and the least and greatest thrust over mass, far from where it shall be.
std::array<double, 3> limitsMet(const NonlinearMpcOptions& mpc) {
  std::array<double, 3> met{0.0, 1e9, 0.0};
  for (const Eigen::Vector3d& far : {Eigen::Vector3d(20.0, -20.0, 0.0), Eigen::Vector3d(-20.0, 20.0, 0.0),
                                     Eigen::Vector3d(0.0, 0.0, 40.0), Eigen::Vector3d(0.0, 0.0, -40.0)}) {
    NonlinearController law(MultirotorOptions{}, mpc);
    const std::vector<Reference> preview(static_cast<std::size_t>(law.previewLength()));
    VehicleState state;
    state.position = far;
    for (int i = 0; i < 20; ++i, state.stamp += 0.01) {
      const AttitudeCommand command = law.step(state, preview.data()).command;
      law.prepare();
      met[0] = std::max({met[0], std::abs(command.roll), std::abs(command.pitch)});
      met[1] = std::min(met[1], command.thrust / MultirotorOptions{}.mass);
      met[2] = std::max(met[2], command.thrust / MultirotorOptions{}.mass);
    }
  }
  return met;
}

TEST(NonlinearLimits, AreThoseOfTheVehicleOrOfTheChapter) {
  constexpr double kDegree = 3.14159265358979 / 180.0, kWithin = 1e-6;
  NonlinearMpcOptions mpc;
  const std::array<double, 3> usual = limitsMet(mpc);
  EXPECT_NEAR(usual[0], 25.0 * kDegree, kWithin);
  EXPECT_NEAR(usual[1], 5.0, kWithin);
  EXPECT_NEAR(usual[2], 20.0, kWithin);
  mpc.chapter_limits = true;
  const std::array<double, 3> chapter = limitsMet(mpc);
  EXPECT_NEAR(chapter[0], 45.0 * kDegree, kWithin);
  EXPECT_NEAR(chapter[1], 9.8066 / 2.0, kWithin);
  EXPECT_NEAR(chapter[2], 9.8066 * 1.5, kWithin);
}

// The commands that an attitude controller needs which is not aligned with odometry: the same, moved by the
// trim.
TEST(OnlineLaws, TrimMovesTheCommandsAndNothingElse) {
  MultirotorOptions trimmed;
  trimmed.roll_trim = 0.03;
  trimmed.pitch_trim = -0.02;
  const std::array<MpcProblem, 3> axes = problems();
  const auto compare = [&](ControlLaw& plain, ControlLaw& moved) {
    std::vector<Reference> preview(static_cast<std::size_t>(plain.previewLength()));
    for (Reference& reference : preview) reference.position = {0.1, -0.05, 0.1};
    VehicleState state;
    for (int i = 0; i < 60; ++i) {
      state.stamp = 0.01 * i;
      state.position.x() = 0.002 * i;
      const AttitudeCommand first = plain.step(state, preview.data()).command;
      const AttitudeCommand second = moved.step(state, preview.data()).command;
      ASSERT_NEAR(second.roll - first.roll, 0.03, 1e-9) << i;
      ASSERT_NEAR(second.pitch - first.pitch, -0.02, 1e-9) << i;
      ASSERT_NEAR(second.thrust, first.thrust, 1e-9) << i;
      plain.prepare();
      moved.prepare();
      // Both track once, as after another law.
      if (i == 30) {
        plain.track(state, first);
        moved.track(state, second);
      }
    }
    EXPECT_EQ(moved.report().level_trim.roll, 0.03);
  };
  MultirotorController linear(axes, MultirotorOptions{}), linear_moved(axes, trimmed);
  compare(linear, linear_moved);
  NonlinearController nonlinear(MultirotorOptions{}, NonlinearMpcOptions{});
  NonlinearController nonlinear_moved(trimmed, NonlinearMpcOptions{});
  compare(nonlinear, nonlinear_moved);
}

TEST(OnlineLaws, NeverAllocate) {
  const std::array<MpcProblem, 3> axes = problems();
  const Law linear{0}, nonlinear{1};
  std::vector<std::unique_ptr<ControlLaw>> laws;
  laws.push_back(std::make_unique<MultirotorController>(axes, MultirotorOptions()));
  laws.push_back(std::make_unique<NonlinearController>(MultirotorOptions(), NonlinearMpcOptions()));
  LawSwitch flight(std::move(laws), linear, MultirotorOptions());
  std::vector<Reference> preview(static_cast<std::size_t>(flight.previewLength()));
  for (Reference& reference : preview) reference.position = {2.5, -2.0, 1.0};
  VehicleState state;
  const long before = polyfly_test::allocationCount();
  int optimal = 0;
  for (int i = 0; i < 300; ++i) {
    state.stamp = 0.01 * i;
    state.position.x() = 0.005 * i;
    if (i % 50 == 49) flight.select(flight.active() == linear ? nonlinear : linear);
    optimal += flight.step(state, preview.data()).status == ControlStatus::kOptimal ? 1 : 0;
    flight.prepare();
  }
  flight.onSilence(4.0);
  flight.stepWithoutReference(5.0);
  flight.reset();
  EXPECT_EQ(polyfly_test::allocationCount(), before);
  EXPECT_EQ(optimal, 300);
}

TEST(OnlineLaws, AProblemThatIsNotOfTheAxisIsRefused) {
  std::array<MpcProblem, 3> axes = problems();
  std::swap(axes[0], axes[1]);
  try {
    MultirotorController refused(axes, MultirotorOptions());
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("problem: as the longitudinal problem: parameter 'e_p_y'"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace polyfly
