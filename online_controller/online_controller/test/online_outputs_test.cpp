// What leaves the controller besides its command: an autopilot's thrust, the tuning of the linear problems,
// and where the laws expect the vehicle.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "online_controller/laws/linear_tuning.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "online_controller/types/thrust_curve.hpp"
#include "online_support.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kWeight = 1.52 * 9.8066;  // [N]

std::array<MpcProblem, 3> axisProblems() {
  std::array<MpcProblem, 3> problems;
  for (std::size_t i = 0; i < 3; ++i) problems[i] = parseProblem(polyfly_test::axisProblem(i), "problem");
  return problems;
}

TEST(ThrustCurve, HoverThrustIsProportional) {
  ThrustCurveOptions options;
  options.hover_thrust = 0.4;
  const ThrustCurve curve(options, 7.6, 30.4, kWeight);
  EXPECT_NEAR(curve(kWeight), 0.4, 1e-15);
  EXPECT_NEAR(curve(0.5 * kWeight), 0.2, 1e-15);
  EXPECT_EQ(curve(100.0), 1.0);
  EXPECT_EQ(curve(-1.0), 0.0);
  EXPECT_EQ(curve(std::nan("")), 0.0);
}

TEST(ThrustCurve, PolynomialAndItsEnds) {
  ThrustCurveOptions options;
  options.polynomial = {-0.3, 0.02, 0.001};
  const ThrustCurve curve(options, 7.6, 30.4, kWeight);
  EXPECT_NEAR(curve(20.0), -0.3 + 0.02 * 20.0 + 0.001 * 400.0, 1e-15);
  EXPECT_EQ(curve(30.4), 1.0);
  EXPECT_EQ(curve(7.6), 0.0);
}

TEST(ThrustCurve, ItsEndsHoldBeyondWhatWasTested) {
  // Limits may be widened in flight: this one falls from 33 N on, and below 0 from 67 N on.
  ThrustCurveOptions options;
  options.polynomial = {0.06, 0.06, -0.0009};
  const ThrustCurve curve(options, 7.6, 30.4, kWeight);
  const double end = 0.06 + 0.06 * 30.4 - 0.0009 * 30.4 * 30.4;
  for (const double thrust : {30.4, 35.0, 70.0, 1e6})
    EXPECT_NEAR(curve(thrust), std::min(end, 1.0), 1e-15) << thrust;
  EXPECT_EQ(curve(0.0), 0.0);  // motors off, not c[0]
  // Below the least that a law asks for the sticks may be; one that rises there again is not followed.
  options.polynomial = {0.5, -0.06, 0.006};
  const ThrustCurve bowl(options, 7.6, 14.95, 14.9);
  EXPECT_NEAR(bowl(1.0), 0.5 - 0.06 * 7.6 + 0.006 * 7.6 * 7.6, 1e-12);
  EXPECT_EQ(bowl(0.0), 0.0);
}

TEST(ThrustCurve, RefusesWhatCannotBeFlown) {
  const auto refused = [](const ThrustCurveOptions& options) {
    EXPECT_THROW(ThrustCurve(options, 7.6, 30.4, kWeight), Error);
  };
  ThrustCurveOptions options;
  options.polynomial = {0.0, 0.05, -0.001};  // falls from 25 N
  refused(options);
  options.polynomial = {0.0, std::nan("")};
  refused(options);
  options.polynomial = {1.0, 0.01};  // hover above the limit
  refused(options);
}

TEST(LinearTuning, IsWhatTheProblemsHold) {
  const LinearTuning tuning = linearTuning(axisProblems());
  EXPECT_EQ(tuning[0].position_weight, 40.0);
  EXPECT_EQ(tuning[1].angle_weight, 20.0);
  EXPECT_EQ(tuning[2].velocity_weight, 25.0);
  EXPECT_EQ(tuning[2].rate_weight, 0.0025);
  EXPECT_EQ(tuning[2].command_max, 10.1934);
  LinearTuning changed = tuning;
  changed[1].velocity_weight = 7.0;
  changed[0].command_max = 0.1;
  const std::array<MpcProblem, 3> problems = tuned(axisProblems(), changed);
  EXPECT_EQ(problems[1].Q(1, 1), 7.0);
  EXPECT_EQ(problems[0].inputs[0].upper, 0.1);
  EXPECT_EQ(linearTuning(problems)[1].velocity_weight, 7.0);
}

// The problems made from the model are those of the files, in every command.
TEST(LinearTuning, ProblemsFromParametersAnswerAsTheFiles) {
  MultirotorController made(linearProblems(MultirotorModel{}, 0.1, 20), MultirotorOptions{});
  MultirotorController read(axisProblems(), MultirotorOptions{});
  Reference reference;
  for (int i = 0; i < 50; ++i) {
    VehicleState state;
    state.stamp = 0.01 * i;
    reference.position = {3.0 * std::sin(i), 2.0 * std::cos(2.0 * i), 0.05 * i};
    const AttitudeCommand a = made.step(state, reference).command;
    const AttitudeCommand b = read.step(state, reference).command;
    EXPECT_NEAR(a.roll, b.roll, 1e-6);
    EXPECT_NEAR(a.pitch, b.pitch, 1e-6);
    EXPECT_NEAR(a.thrust, b.thrust, 1e-5);
  }
}

TEST(LinearTuning, ChangedLimitsHold) {
  LinearTuning tuning = linearTuning(axisProblems());
  tuning[0].command_max = 0.1;
  MultirotorController law(tuned(axisProblems(), tuning), MultirotorOptions{});
  Reference reference;
  reference.position.x() = 2.0;
  EXPECT_NEAR(law.step(VehicleState{}, reference).axis[0].input, 0.1, 1e-12);
}

/// The prediction begins at the vehicle, its first stage is what the model makes of the first command, and it
/// ends nearer the reference.
template <class AnyLaw>
void expectPrediction(AnyLaw& law) {
  VehicleState state;
  state.position = {0.1, -0.1, 1.0};
  std::vector<Reference> preview(21);
  for (Reference& reference : preview) reference.position = {0.9, 0.5, 1.5};
  std::vector<Eigen::Vector3d> positions(21);
  LawInsight insight;
  insight.room = 21;
  insight.positions = positions.data();
  law.inspect(preview.data(), insight);
  ASSERT_EQ(insight.count, 0);
  const ControlReport& report = law.step(state, preview.data());
  ASSERT_EQ(report.status, ControlStatus::kOptimal);
  ASSERT_EQ(law.timing().stage_period, 0.1);
  law.inspect(preview.data(), insight);
  ASSERT_EQ(insight.count, 21);
  EXPECT_LT((positions[0] - state.position).norm(), 1e-12);
  const double climb = 0.5 * report.axis[2].input * 0.1 * 0.1;
  EXPECT_NEAR(positions[1].z(), 1.0 + climb, 0.02 * climb);
  EXPECT_LT((positions[20] - preview[20].position).norm(), 0.2);
}

TEST(Prediction, OfEachLaw) {
  MultirotorController linear(axisProblems(), MultirotorOptions{});
  expectPrediction(linear);
  NonlinearController nonlinear(MultirotorOptions{}, NonlinearMpcOptions{});
  expectPrediction(nonlinear);
  polyfly_test::Flight mapped;
  MultirotorController explicit_law({&mapped.maps[0]->map(), &mapped.maps[1]->map(), &mapped.maps[2]->map()},
                                    {});
  expectPrediction(explicit_law);
}

}  // namespace
}  // namespace polyfly
