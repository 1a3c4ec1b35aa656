// Eq. 38 with the reference of each stage, against a quadratic program over all states and inputs. The oracle has its own
// discretisation, terminal weight and references.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <tuple>
#include <vector>

#include "allocations.hpp"
#include "mpc_core/dense_qp.hpp"
#include "online_controller/laws/axis.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_support.hpp"

namespace polyfly {
namespace {

constexpr double kAgreement = 1e-6;  // inputs of two solvers [rad, m/s^2]

/// x' = A x + B u + d e_v over one stage by many small steps: B_0 and B_1 weigh an input that runs straight.
struct Stage {
  Eigen::MatrixXd A;
  Eigen::VectorXd B_begin, B_end, Bd;
};

Stage integrate(const MpcProblem& problem) {
  constexpr int kSteps = 20000;
  const double h = problem.sampling_time / kSteps;
  const Eigen::Index n = problem.stateCount();
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
  // Implicit midpoint rule.
  const Eigen::MatrixXd left = (one - 0.5 * h * problem.A_c).inverse();
  const Eigen::MatrixXd step = left * (one + 0.5 * h * problem.A_c);
  Stage stage{one, Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  for (int k = 0; k < kSteps; ++k) {
    const double share = (k + 0.5) / kSteps;
    stage.A = (step * stage.A).eval();
    stage.B_begin = (step * stage.B_begin + h * left * problem.B_c * (1.0 - share)).eval();
    stage.B_end = (step * stage.B_end + h * left * problem.B_c * share).eval();
    stage.Bd = (step * stage.Bd + h * left * problem.Bd_c).eval();
  }
  return stage;
}

Eigen::MatrixXd terminalWeight(const Stage& stage, const MpcProblem& problem) {
  if (problem.P.size() > 0) return problem.P;
  const Eigen::VectorXd B = stage.B_begin + stage.B_end;
  Eigen::MatrixXd P = problem.Q;
  for (int k = 0; k < 20000; ++k) {
    const Eigen::RowVectorXd BPA = B.transpose() * P * stage.A;
    P = (stage.A.transpose() * P * stage.A - BPA.transpose() * BPA / (problem.R(0, 0) + B.dot(P * B)) +
         problem.Q)
            .eval();
  }
  return P;
}

/// State and input on a reference, from the derivatives: v' = A_vv v + G s + d, s' = A_ss s + b u.
struct Point {
  Eigen::VectorXd x;
  double u = 0.0;
};

Point onReference(const MpcProblem& problem, const AxisReference& reference) {
  const bool lag = problem.stateCount() == 3;
  const double drag = problem.A_c(1, 1), gain = lag ? problem.A_c(1, 2) : problem.B_c(1, 0);
  const double drive = (reference.acceleration - drag * reference.velocity - reference.disturbance) / gain;
  const double rate = (reference.jerk - drag * reference.acceleration) / gain;
  Point point{Eigen::VectorXd::Zero(problem.stateCount()), drive};
  point.x(0) = reference.position;
  point.x(1) = reference.velocity;
  if (!lag) return point;
  point.x(2) = drive;
  point.u = (rate - problem.A_c(2, 2) * drive) / problem.B_c(2, 0);
  return point;
}

/// Eq. 38 over (u_0, x_1, u_1, .., x_N): the inputs.
class FullProgram {
 public:
  explicit FullProgram(const MpcProblem& problem)
      : problem_(problem), stage_(integrate(problem)), P_(terminalWeight(stage_, problem)) {}

  std::vector<double> solve(const std::vector<AxisReference>& references, const Eigen::VectorXd& x0,
                            double previous) const {
    const Eigen::Index N = problem_.horizon, nx = problem_.stateCount(), block = nx + 1, n = N * block;
    const auto u = [&](Eigen::Index t) { return t * block; };
    const auto x = [&](Eigen::Index t) { return (t - 1) * block + 1; };
    std::vector<Point> points;
    for (const AxisReference& reference : references) points.push_back(onReference(problem_, reference));
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n), A = Eigen::MatrixXd::Zero(N * nx + 3 * N, n);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n), b(A.rows());
    const double R = problem_.R(0, 0), Rd = problem_.R_delta(0, 0);
    const double d = references[0].disturbance / problem_.Bd_c(1, 0);
    for (Eigen::Index t = 0; t < N; ++t) {
      const Point& now = points[static_cast<std::size_t>(t)];
      const Point& next = points[static_cast<std::size_t>(t) + 1];
      H(u(t), u(t)) += 2.0 * (R + Rd);
      g(u(t)) -= 2.0 * R * now.u;
      if (t == 0) g(u(0)) -= 2.0 * Rd * previous;
      if (t > 0) {
        H(u(t - 1), u(t - 1)) += 2.0 * Rd;
        H(u(t - 1), u(t)) -= 2.0 * Rd;
        H(u(t), u(t - 1)) -= 2.0 * Rd;
      }
      const Eigen::MatrixXd& weight = t + 1 < N ? problem_.Q : P_;
      H.block(x(t + 1), x(t + 1), nx, nx) += 2.0 * weight;
      g.segment(x(t + 1), nx) -= 2.0 * weight * next.x;
      // x_{t+1} - A x_t - (B_0 + B_1) u_t = - B_1 u_ss[t] + B_1 u_ss[t+1] + B_d d
      const Eigen::Index row = t * nx;
      A.block(row, x(t + 1), nx, nx).setIdentity();
      A.block(row, u(t), nx, 1) = -(stage_.B_begin + stage_.B_end);
      b.segment(row, nx) = stage_.B_end * (next.u - now.u) + stage_.Bd * d;
      if (t > 0) {
        A.block(row, x(t), nx, nx) = -stage_.A;
      } else {
        b.segment(row, nx) += stage_.A * x0;
      }
      A(N * nx + 2 * t, u(t)) = 1.0;
      b(N * nx + 2 * t) = problem_.inputs[0].upper;
      A(N * nx + 2 * t + 1, u(t)) = -1.0;
      b(N * nx + 2 * t + 1) = -problem_.inputs[0].lower;
    }
    std::vector<int> equalities;
    for (int i = 0; i < static_cast<int>(N * nx); ++i) equalities.push_back(i);
    b.tail(N).setZero();
    Eigen::Index first = 0;
    for (const int length : problem_.moves) {
      for (Eigen::Index t = first + 1; t < first + length; ++t) {
        const Eigen::Index row = N * nx + 2 * N + t;
        A(row, u(t)) = 1.0;
        A(row, u(first)) = -1.0;
        equalities.push_back(static_cast<int>(row));
      }
      first += length;
    }
    DenseQp qp(H, A, equalities);
    EXPECT_EQ(qp.solve(g.data(), b.data()), QpStatus::kOptimal);
    std::vector<double> inputs;
    for (Eigen::Index t = 0; t < N; ++t) inputs.push_back(qp.z()(u(t)));
    return inputs;
  }

 private:
  MpcProblem problem_;
  Stage stage_;
  Eigen::MatrixXd P_;
};

enum class Moves {
  kFree,
  kBlocked,
  /// The terminal weight is so great that the program is condensed beside a feedback.
  kBesideFeedback,
};

MpcProblem problemOf(std::size_t axis, Moves moves) {
  MpcProblem problem = parseProblem(polyfly_test::axisProblem(axis), "problem");
  switch (moves) {
    case Moves::kFree:
      break;
    case Moves::kBlocked:
      problem.moves = {1, 1, 2, 4, problem.horizon - 8};
      break;
    case Moves::kBesideFeedback:
      problem.P = 1e7 * problem.Q;
      break;
  }
  return problem;
}

/// An axis, and what its moves are.
class LookAhead : public testing::TestWithParam<std::tuple<std::size_t, Moves>> {
 protected:
  LookAhead()
      : number_(std::get<0>(GetParam())),
        problem_(problemOf(number_, std::get<1>(GetParam()))),
        axis_(onlineAxisLaw(problem_), kAxisNames[number_], MultirotorOptions{}) {}

  double input(const std::vector<AxisReference>& references, const AxisSample& sample, double previous) {
    for (int t = 0; t <= axis_.stages(); ++t) axis_.setStage(t, references[static_cast<std::size_t>(t)]);
    axis_.aim(true);
    AxisReport report;
    EXPECT_EQ(axis_.evaluate(sample, references[0], previous, 0.0, report), ControlStatus::kOptimal);
    return report.input;
  }

  Eigen::VectorXd stateOf(const AxisSample& sample) const {
    Eigen::VectorXd x(problem_.stateCount());
    x(0) = sample.position;
    x(1) = sample.velocity;
    if (x.size() == 3) x(2) = sample.angle;
    return x;
  }

  std::size_t number_;
  MpcProblem problem_;
  Axis axis_;
};

// References that jump from stage to stage, with active bounds in some.
TEST_P(LookAhead, SolvesEquation38WithTheReferenceOfEachStage) {
  const FullProgram oracle(problem_);
  std::mt19937_64 random(7);
  const auto within = [&](double most) {
    return std::uniform_real_distribution<double>(-most, most)(random);
  };
  int at_bound = 0;
  for (int round = 0; round < 40; ++round) {
    const double far = number_ == 2 ? 15.0 : 3.0;  // thrust has more room than tilt
    const double size = round % 4 == 0 ? far : 0.3;
    std::vector<AxisReference> references;
    const double disturbance = within(0.5);
    for (int t = 0; t <= problem_.horizon; ++t)
      references.push_back({within(size), within(size), within(0.5 * size), within(0.5 * size), disturbance});
    const AxisSample sample{within(size), within(size), number_ < 2 ? within(0.2) : 0.0};
    const double previous = within(0.2);
    const double expected = oracle.solve(references, stateOf(sample), previous).front();
    EXPECT_NEAR(input(references, sample, previous), expected, kAgreement) << round;
    at_bound +=
        expected > problem_.inputs[0].upper - 1e-9 || expected < problem_.inputs[0].lower + 1e-9 ? 1 : 0;
  }
  EXPECT_GT(at_bound, 3);
  EXPECT_LT(at_bound, 35);
}

// A pose is the same with and without look-ahead, and so is what the model can follow without error.
TEST_P(LookAhead, ChangesNothingWhereTheReferenceIsFollowed) {
  std::vector<AxisReference> pose(static_cast<std::size_t>(problem_.horizon) + 1, {1.0, 0.0, 0.0, 0.0, 0.2});
  std::vector<AxisReference> ramp;
  for (int t = 0; t <= problem_.horizon; ++t) {
    const double time = problem_.sampling_time * t;
    ramp.push_back({0.2 * time + 0.1 * time * time, 0.2 + 0.2 * time, 0.2, 0.0, 0.0});
  }
  for (const auto* references : {&pose, &ramp}) {
    const AxisSample sample{(*references)[0].position + 0.01, (*references)[0].velocity, 0.0};
    const double previous = 0.01;
    const double ahead = input(*references, sample, previous);
    axis_.aim(false);
    AxisReport report;
    axis_.evaluate(sample, (*references)[0], previous, 0.0, report);
    const bool steady = references == &pose || problem_.A_c(1, 1) == 0.0;
    EXPECT_NEAR(ahead, report.input, steady ? 1e-9 : 2e-3);
  }
}

class PlanOfTheLaw : public LookAhead {};

// All inputs that the law plans, with references that stay. Beside a feedback it takes none of the stages.
TEST_P(PlanOfTheLaw, PlansTheInputsOfTheWholeProgram) {
  const FullProgram oracle(problem_);
  const std::unique_ptr<AxisLaw> law = onlineAxisLaw(problem_);
  EXPECT_EQ(law->takesGradient(), std::get<1>(GetParam()) != Moves::kBesideFeedback);
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  for (int round = 0; round < 10; ++round) {
    const Eigen::VectorXd x =
        Eigen::VectorXd::NullaryExpr(problem_.stateCount(), [&] { return within(random); });
    const double previous = 0.4 * within(random);
    std::vector<double> theta;
    for (const MpcProblem::Parameter& parameter : problem_.parameters)
      theta.push_back(parameter.role == ParameterRole::kError           ? x(parameter.index)
                      : parameter.role == ParameterRole::kPreviousInput ? previous
                                                                        : 0.0);
    const std::vector<AxisReference> references(static_cast<std::size_t>(problem_.horizon) + 1,
                                                AxisReference{});
    const std::vector<double> expected = oracle.solve(references, x, previous);
    double input = 0.0;
    ASSERT_EQ(law->evaluate(theta.data(), &input).status, LookupStatus::kInside);
    EXPECT_NEAR(input, expected.front(), kAgreement);
    for (int t = 0; t < problem_.horizon; ++t) {
      ASSERT_TRUE(law->planned(t, 0.0, &input));
      EXPECT_NEAR(input, expected[static_cast<std::size_t>(t)], kAgreement) << t;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Axes, LookAhead,
                         testing::Combine(testing::Values(0, 1, 2),
                                          testing::Values(Moves::kFree, Moves::kBlocked)));
INSTANTIATE_TEST_SUITE_P(Axes, PlanOfTheLaw,
                         testing::Combine(testing::Values(0, 1, 2),
                                          testing::Values(Moves::kFree, Moves::kBlocked,
                                                          Moves::kBesideFeedback)));

TEST(LookAheadOfTheController, ReadsTheReferenceOfEachStageAndNeverAllocates) {
  std::array<MpcProblem, 3> problems;
  for (std::size_t i = 0; i < 3; ++i) problems[i] = parseProblem(polyfly_test::axisProblem(i), "problem");
  MultirotorOptions without;
  without.look_ahead = false;
  MultirotorController law(problems, MultirotorOptions{}), blind(problems, without);
  EXPECT_EQ(blind.previewLength(), 1);
  ASSERT_EQ(law.previewLength(), problems[0].horizon + 1);
  EXPECT_EQ(law.previewPeriod(), problems[0].sampling_time);
  // It stands where it shall be for another second, and leans on its way before.
  std::vector<Reference> preview(static_cast<std::size_t>(law.previewLength()));
  for (std::size_t k = 10; k < preview.size(); ++k) preview[k].position.x() = 1.0;
  const VehicleState state;
  const long before = polyfly_test::allocationCount();
  EXPECT_GT(law.step(state, preview.data()).command.pitch, 0.01);
  EXPECT_EQ(polyfly_test::allocationCount(), before);
  EXPECT_NEAR(blind.step(state, preview.data()).command.pitch, 0.0, 1e-12);
  // A number that is none in a later stage has no answer.
  preview.back().position.y() = std::nan("");
  EXPECT_EQ(law.step(state, preview.data()).reason, ControlReason::kNotFinite);
  // One reference for all stages.
  law.forget(LawMemory::kAll);
  EXPECT_NEAR(law.step(state, Reference{}).command.pitch, 0.0, 1e-12);
}

TEST(LookAheadOfTheController, IsNotOfferedWithBoundedStates) {
  MpcProblem problem = parseProblem(polyfly_test::axisProblem(1), "problem");
  EXPECT_TRUE(StageReferences::supports(problem));
  problem.terminal_equality = true;
  EXPECT_FALSE(StageReferences::supports(problem));
  problem.terminal_equality = false;
  problem.states[1].lower = -2.0;
  EXPECT_FALSE(StageReferences::supports(problem));
}

}  // namespace
}  // namespace polyfly
