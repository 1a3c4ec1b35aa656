// What leaves the controller besides its command: an autopilot's thrust, the tuning of the linear problems,
// and where the laws expect the vehicle.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <vector>

#include "online_controller/laws/linear_tuning.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "online_controller/realtime/poll_window.hpp"
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

TEST(PollWindow, LooksOnlyWhileASampleIsDue) {
  using Clock = PollWindow::Clock;
  using Seconds = std::chrono::duration<double>;
  const Clock::time_point start{std::chrono::hours(1)};
  const auto after = [&](double seconds) {
    return start + std::chrono::duration_cast<Clock::duration>(Seconds(seconds));
  };
  PollWindow window(0.01, 0.25);
  EXPECT_EQ(window.sleep(after(0.0), 0.05), 0.05);  // nothing is known of samples yet
  window.served(start);
  EXPECT_NEAR(window.sleep(after(0.001), 0.05), 0.0065, 1e-9);
  EXPECT_NEAR(window.sleep(after(0.001), 0.002), 0.002, 1e-12);
  EXPECT_EQ(window.sleep(after(0.0076), 0.05), 0.0);
  EXPECT_EQ(window.sleep(after(0.0199), 0.05), 0.0);   // late
  EXPECT_EQ(window.sleep(after(0.0201), 0.05), 0.05);  // lost
  window.served(after(0.5));
  EXPECT_EQ(window.sleep(after(0.508), 0.05), 0.0);

  PollWindow never(0.01, 0.0), always(0.01, 1.0);
  never.served(start);
  always.served(start);
  for (const double seconds : {0.0, 0.005, 0.0099, 0.015}) {
    EXPECT_EQ(never.sleep(after(seconds), 0.05), 0.05);
    EXPECT_EQ(always.sleep(after(seconds), 0.05), 0.0);
  }
  EXPECT_EQ(always.sleep(after(0.03), 0.05), 0.05);
}

TEST(PollWindow, RehearsesOnceShortlyBeforeASample) {
  using Clock = PollWindow::Clock;
  using std::chrono::microseconds;
  const Clock::time_point start{std::chrono::hours(1)};
  PollWindow window(0.01, 0.25), never(0.01, 0.0);
  EXPECT_FALSE(window.rehearses(start));  // nothing is known of samples yet
  for (const Clock::time_point sample : {start, start + microseconds(10100)}) {
    window.served(sample);
    never.served(sample);
    EXPECT_FALSE(window.rehearses(sample + microseconds(9600)));
    EXPECT_TRUE(window.rehearses(sample + microseconds(9800)));
    EXPECT_FALSE(window.rehearses(sample + microseconds(9900)));
    EXPECT_FALSE(never.rehearses(sample + microseconds(9800)));
  }
}

/// The last of so many samples on time that the next one is expected to be so.
PollWindow::Clock::time_point serveSteadily(PollWindow& window, PollWindow::Clock::time_point first) {
  constexpr int kEnough = 11;
  for (int i = 0; i < kEnough; ++i) window.served(first + i * std::chrono::milliseconds(10));
  return first + (kEnough - 1) * std::chrono::milliseconds(10);
}

TEST(PollWindow, OneWithALeadRehearsesOnlyWhileSamplesComeOnTime) {
  using Clock = PollWindow::Clock;
  using std::chrono::microseconds;
  const microseconds before(9600);
  PollWindow window(0.01, 0.0, 0.0005);
  const auto rehearsalsOf = [&](Clock::time_point& sample, std::initializer_list<int> periods) {
    int count = 0;
    for (const int period : periods) {
      sample += microseconds(period);
      window.served(sample);
      EXPECT_EQ(window.sleep(sample, 0.05) < 0.05, window.awaitsRehearsal());  // nobody wakes up for nothing
      count += window.rehearses(sample + before) ? 1 : 0;
    }
    return count;
  };
  const auto ten = {10000, 10100, 9900, 10499, 9501, 10000, 10000, 10000, 10000, 10000};
  Clock::time_point sample{std::chrono::hours(1)};
  window.served(sample);
  EXPECT_EQ(rehearsalsOf(sample, ten), 1);  // from the tenth on
  EXPECT_EQ(rehearsalsOf(sample, ten), 10);
  EXPECT_EQ(rehearsalsOf(sample, {9400}), 0);
  EXPECT_EQ(rehearsalsOf(sample, ten), 1);
  EXPECT_EQ(rehearsalsOf(sample, {10600, 10000, 20000, 5000, 15000, 5000}), 0);
  EXPECT_EQ(rehearsalsOf(sample, ten), 1);
  window.disturbed();
  EXPECT_EQ(rehearsalsOf(sample, ten), 1);
}

TEST(PollWindow, OneWhoSleepsIsAwakeForARehearsal) {
  using Clock = PollWindow::Clock;
  using std::chrono::microseconds;
  Clock::time_point sample{std::chrono::hours(1)};
  PollWindow window(0.01, 0.0, 0.0005);
  EXPECT_EQ(window.sleep(sample, 0.05), 0.05);  // nothing is known of samples yet
  sample = serveSteadily(window, sample);
  for (int i = 0; i < 2; ++i) {
    sample += microseconds(10000);
    window.served(sample);
    EXPECT_NEAR(window.sleep(sample + microseconds(4000), 0.05), 0.0055, 1e-12);
    EXPECT_EQ(window.sleep(sample + microseconds(4000), 0.001), 0.001);
    EXPECT_FALSE(window.rehearses(sample + microseconds(9499)));
    EXPECT_EQ(window.sleep(sample + microseconds(9501), 0.05), 0.0);
    EXPECT_TRUE(window.rehearses(sample + microseconds(9501)));
    EXPECT_FALSE(window.rehearses(sample + microseconds(9502)));
    EXPECT_EQ(window.sleep(sample + microseconds(9502), 0.05), 0.05);  // until there is a sample
    EXPECT_EQ(window.expects(), sample + microseconds(10500));
  }
  sample += microseconds(10000);
  window.served(sample);
  EXPECT_FALSE(window.rehearses(sample + microseconds(9751)));  // too late: it might be in the sample's way
  EXPECT_EQ(window.sleep(sample + microseconds(9752), 0.05), 0.05);
  PollWindow both(0.01, 0.25, 0.0005);
  sample = serveSteadily(both, sample);
  EXPECT_NEAR(both.sleep(sample, 0.05), 0.0075, 1e-12);
  EXPECT_FALSE(both.rehearses(sample + microseconds(9400)));
  EXPECT_TRUE(both.rehearses(sample + microseconds(9600)));
}

TEST(ThrustCurve, PolynomialAndLimitsAfterIt) {
  ThrustCurveOptions options;
  options.polynomial = {0.05, 0.02, 0.0005};
  options.least = 0.25;
  options.greatest = 0.8;
  const ThrustCurve curve(options, 7.6, 30.4, kWeight);
  EXPECT_NEAR(curve(20.0), 0.05 + 0.02 * 20.0 + 0.0005 * 400.0, 1e-15);
  EXPECT_EQ(curve(30.4), 0.8);
  EXPECT_EQ(curve(7.6), 0.25);
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
  options = {};
  options.least = 0.6;  // above hover
  refused(options);
  options = {};
  options.greatest = 1.2;
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
void expectPrediction(ControlLaw& law) {
  VehicleState state;
  state.position = {0.1, -0.1, 1.0};
  std::vector<Reference> preview(21);
  for (Reference& reference : preview) reference.position = {0.9, 0.5, 1.5};
  std::vector<Eigen::Vector3d> positions(21);
  ASSERT_EQ(law.predict(preview.data(), 21, positions.data()), 0);
  const ControlReport& report = law.step(state, preview.data());
  ASSERT_EQ(report.status, ControlStatus::kOptimal);
  ASSERT_EQ(law.stagePeriod(), 0.1);
  ASSERT_EQ(law.predict(preview.data(), 21, positions.data()), 21);
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
  expectPrediction(*mapped.controller);
}

}  // namespace
}  // namespace polyfly
