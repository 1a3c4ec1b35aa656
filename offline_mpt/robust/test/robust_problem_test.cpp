// What the reader of robust problems accepts, and how it refuses the rest.
#include "robust_mpc/robust_problem.hpp"

#include <gtest/gtest.h>

#include "error_of.hpp"
#include "holds.hpp"
#include "made_robust.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "robust_mpc/robust_program.hpp"

namespace polyfly {
namespace {

std::string errorIn(const std::string& text) {
  return errorOf([&] { buildRobustProgram(parseRobustProblem(text, "robust.yaml")); });
}

TEST(RobustProblem, IsReadAsItIsWritten) {
  MadeRobust made;
  made.torque = true;
  made.references = true;
  made.floor = "0.02";
  made.stack = "shift";
  const RobustProblem problem = made.problem();
  EXPECT_EQ(problem.name, "made");
  EXPECT_EQ(problem.stateCount(), 3);
  EXPECT_EQ(problem.channelCount(), 2);
  EXPECT_EQ(problem.parameterCount(), 5);
  EXPECT_EQ(problem.stack, Stack::kShift);
  EXPECT_EQ(problem.floor, Rational(1, 50));
  EXPECT_FALSE(problem.state_ranges[0]);
  EXPECT_EQ(problem.state_ranges[2]->upper, Rational(7, 20));
  EXPECT_EQ(problem.parameters[4].input_shift[0], Rational(10, 9));
  // Eq. 42, in steps of 2^-40
  EXPECT_NEAR(problem.A(1, 2).get_d(), 0.6465562097702255, 1e-12);
  EXPECT_NEAR(problem.B(0, 0).get_d(), 0.0034178757200687025, 1e-12);
  EXPECT_NEAR(problem.G(1, 0).get_d(), 0.03998400426581347, 1e-12);
  EXPECT_EQ(problem.A(1, 2).get_den() <= (mpz_class(1) << 40), true);
  // the range -0.1 .. 0.2 of the second channel: half width and middle
  EXPECT_NEAR(problem.drift[2].get_d() * 3.0, problem.G(2, 1).get_d(), 1e-15);
}

TEST(RobustProblem, DiscreteModelsCountExactly) {
  std::string text = MadeRobust().text();
  text = replaced(text, "model:\n", "model:\n  time: discrete\n");
  text = replaced(text, "9.81", "\"1/3\"");
  EXPECT_EQ(parseRobustProblem(text, "a").A(1, 2), Rational(1, 3));
}

TEST(RobustProblem, TheDelayIsTheControllersAlone) {
  const std::string text = MadeRobust().text();
  const std::string with = replaced(text, "model:\n", "model:\n  delay: 0.06\n");
  EXPECT_EQ(parseRobustProblem(with, "a").A(1, 2), parseRobustProblem(text, "a").A(1, 2));
  EXPECT_EQ(parseFlightModel(with, "a").delay, 0.06);
  EXPECT_NE(errorIn(replaced(text, "model:\n", "model:\n  delay: 0.6\n"))
                .find("model.delay: must be from 0 to 0.5 s"),
            std::string::npos);
}

TEST(RobustProblem, RefusesWithFileFieldAndRule) {
  const std::string good = MadeRobust().text();
  EXPECT_EQ(errorIn(good), "no error");
  struct Case {
    const char* from;
    const char* to;
    const char* message;
  };
  const Case cases[] = {
      {"type: robust_mpc", "type: tracking_mpc", "type: must be robust_mpc"},
      {"horizon: 6", "horizon: 1", "horizon: "},
      {"horizon: 6", "horizons: 6", "horizons: unknown key"},
      {"stack: paper", "stack: newspaper", "stack: must be one of paper, shift, got 'newspaper'"},
      {"feedback_predictions: free", "feedback_predictions: some", "feedback_predictions: must be one of"},
      {"invariance: none", "invariance: always", "invariance: must be one of none, first_step, terminal"},
      {"floor: 0", "floor: -1", "floor: must not be below 0"},
      {"sampling_time: 0.08", "sampling_time: 0", "sampling_time: must be greater than 0"},
      {"[-0.5, 0.5]", "[0.5, -0.5]", "model.disturbances[0].range: lower end must be below"},
      {"[-0.5, 0.5]", "[0.5]", "model.disturbances[0].range: must have 2 entries"},
      {"9.81", "g", "model.A[1][2]: must be a decimal number or a fraction, got 'g'"},
      {"C: [[1, 0, 0]]", "C: [[1, 0]]", "model.C[0]: must have 3 entries"},
      {"C: [[1, 0, 0]]", "C: []", "model.C: must have at least one row"},
      {"{Q: [40, 20, 10], R: [35]}", "{Q: [40, 20, 10]}", "tie_break.R: missing"},
      {"{Q: [40, 20, 10], R: [35]}", "{gain: [[1, 2, 3]], R: [35]}", "tie_break: must have either"},
      {"of: v,", "of: p,", "another parameter has this role for 'p'"},
      {"of: v,", "of: q,", "must name a state, got 'q'"},
      {"role: error, of: v,", "role: reference, state: [0, 1, 0], input: [0],",
       "must have one with role error of state 'v'"},
      {"unit: m/s, range: [-1.5, 1.5]}\n  - {name: e_phi", "unit: m, range: [-1.5, 1.5]}\n  - {name: e_phi",
       "must be m/s as for 'v'"},
  };
  for (const Case& refused : cases) {
    const std::string message = errorIn(replaced(good, refused.from, refused.to));
    EXPECT_EQ(message.find("robust.yaml:"), 0u) << message;
    EXPECT_NE(message.find(refused.message), std::string::npos) << refused.to << ": " << message;
  }
}

TEST(RobustProblem, InvarianceNeedsBoundsAndASet) {
  MadeRobust made;
  made.invariance = "first_step";
  EXPECT_EQ(errorIn(made.text()), "no error");
  MadeRobust windy = made;
  windy.disturbance = "[-9, 9]";
  EXPECT_NE(errorIn(windy.text()).find("invariance: no state within the bounds can be kept"),
            std::string::npos);
  const std::string unbounded =
      replaced(made.text(), "name: phi, unit: rad, range: [-0.35, 0.35]", "name: phi, unit: rad");
  EXPECT_NE(errorIn(unbounded).find("'phi' must have a range"), std::string::npos);
}

TEST(RobustProblem, KnowsItsType) {
  EXPECT_TRUE(isRobustProblem(MadeRobust().text(), "a"));
  EXPECT_FALSE(isRobustProblem("type: tracking_mpc\n", "a"));
  EXPECT_FALSE(isRobustProblem("polyfly_problem: 1\n", "a"));
}

}  // namespace
}  // namespace polyfly
