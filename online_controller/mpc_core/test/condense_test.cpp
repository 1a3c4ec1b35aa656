// The condensed program against Eq. 3-4 written out: original coordinates, disturbance and all.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "support.hpp"

namespace {

using namespace polyfly;
using namespace polyfly_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kCostTolerance = 1e-10;  // relative
constexpr double kRowTolerance = 1e-11;   // absolute, on slacks of order one

/// Eq. 3-4 by simulation. Shares no code with the subject: own discretisation, own terminal weight.
class DirectProblem {
 public:
  explicit DirectProblem(const MpcProblem& problem) : problem_(problem) {
    const Eigen::Index nx = problem.stateCount();
    const Eigen::Index nu = problem.inputCount();
    const Eigen::Index nd = problem.Bd_c.cols();
    MatrixXd augmented = MatrixXd::Zero(nx + nu + nd, nx + nu + nd);
    augmented.topRows(nx) << problem.A_c, problem.B_c, problem.Bd_c;
    const MatrixXd exponential = exponentialSeries(augmented * problem.sampling_time);
    A_ = exponential.topLeftCorner(nx, nx);
    B_ = exponential.block(0, nx, nx, nu);
    Bd_ = exponential.block(0, nx + nu, nx, nd);
    P_ = problem.Q;
    for (int i = 0; i < 20000; ++i) {
      const MatrixXd K = (problem.R + B_.transpose() * P_ * B_).inverse() * B_.transpose() * P_ * A_;
      P_ = (problem.Q + A_.transpose() * P_ * (A_ - B_ * K)).eval();
    }
  }

  struct Point {
    VectorXd x, x_ref, u_ref, u_previous, d;
  };

  /// States x_0..x_N for the inputs u_k = columns of `u`.
  MatrixXd states(const Point& point, const MatrixXd& u) const {
    MatrixXd x(point.x.size(), problem_.horizon + 1);
    x.col(0) = point.x;
    for (int k = 0; k < problem_.horizon; ++k) x.col(k + 1) = A_ * x.col(k) + B_ * u.col(k) + Bd_ * point.d;
    return x;
  }

  double cost(const Point& point, const MatrixXd& u) const {
    const MatrixXd x = states(point, u);
    const auto square = [](const MatrixXd& weight, const VectorXd& v) { return v.dot(weight * v); };
    double sum = 0.0;
    VectorXd before = point.u_previous;
    for (int k = 0; k < problem_.horizon; ++k) {
      sum += square(problem_.Q, x.col(k) - point.x_ref) + square(problem_.R, u.col(k) - point.u_ref) +
             square(problem_.R_delta, u.col(k) - before);
      before = u.col(k);
    }
    return sum + square(P_, x.col(problem_.horizon) - point.x_ref);
  }

  /// Distances to all finite bounds on u_0..u_{N-1} and x_1 - x_ref..x_N - x_ref, sorted.
  std::vector<double> slacks(const Point& point, const MatrixXd& u) const {
    const MatrixXd x = states(point, u);
    std::vector<double> all;
    const auto add = [&](const Signal& signal, double value) {
      if (std::isfinite(signal.upper)) all.push_back(signal.upper - value);
      if (std::isfinite(signal.lower)) all.push_back(value - signal.lower);
    };
    for (int k = 0; k < problem_.horizon; ++k) {
      for (int i = 0; i < problem_.inputCount(); ++i)
        add(problem_.inputs[static_cast<std::size_t>(i)], u(i, k));
      for (int i = 0; i < problem_.stateCount(); ++i) {
        add(problem_.states[static_cast<std::size_t>(i)], x(i, k + 1) - point.x_ref(i));
      }
    }
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  MpcProblem problem_;
  MatrixXd A_, B_, Bd_, P_;
};

class Randoms {
 public:
  explicit Randoms(unsigned seed) : generator_(seed) {}
  VectorXd vector(Eigen::Index size) {
    return VectorXd::NullaryExpr(size, [&] { return uniform_(generator_); });
  }
  MatrixXd matrix(Eigen::Index rows, Eigen::Index cols) {
    return MatrixXd::NullaryExpr(rows, cols, [&] { return uniform_(generator_); });
  }

 private:
  std::mt19937 generator_;
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

/// theta as problem.parameters orders it.
VectorXd parametersOf(const MpcProblem& problem, const DirectProblem::Point& point) {
  VectorXd theta(static_cast<Eigen::Index>(problem.parameters.size()));
  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    const MpcProblem::Parameter& parameter = problem.parameters[static_cast<std::size_t>(j)];
    switch (parameter.role) {
      case ParameterRole::kError:
        theta(j) = point.x(parameter.index) - point.x_ref(parameter.index);
        break;
      case ParameterRole::kPreviousInput:
        theta(j) = point.u_previous(parameter.index);
        break;
      case ParameterRole::kInputReference:
        theta(j) = point.u_ref(parameter.index);
        break;
      case ParameterRole::kStateReference:
        theta(j) = point.x_ref(parameter.index);
        break;
      case ParameterRole::kState:
        theta(j) = point.x(parameter.index);
        break;
      case ParameterRole::kReference:
        theta(j) = problem.C.row(parameter.index).dot(point.x_ref);
        break;
      case ParameterRole::kDisturbance:
        theta(j) = point.d(parameter.index);
        break;
    }
  }
  return theta;
}

/// Cost, rows and output of the condensed program agree with Eq. 3-4 at random plans. `steady` completes a
/// point whose u_ref is drawn, so that x_ref is a steady state.
template <typename Steady>
void expectEquivalent(const MpcProblem& problem, unsigned seed, const Steady& steady) {
  const ParametricProgram program = condense(problem);
  const DirectProblem direct(problem);
  const Eigen::Index nu = problem.inputCount();
  Randoms randoms(seed);
  for (int trial = 0; trial < 20; ++trial) {
    DirectProblem::Point point;
    point.x = randoms.vector(problem.stateCount());
    point.u_ref = randoms.vector(nu);
    point.u_previous = randoms.vector(nu);
    steady(&randoms, &point);
    const MatrixXd u = randoms.matrix(nu, problem.horizon);
    const VectorXd theta = parametersOf(problem, point);
    const MatrixXd reference = point.u_ref.replicate(1, problem.horizon);
    const MatrixXd moves = u - reference;
    const VectorXd z = Eigen::Map<const VectorXd>(moves.data(), moves.size());

    const double expected = direct.cost(point, u) - direct.cost(point, reference);
    const double condensed = 0.5 * z.dot(program.H * z) + (program.f + program.F * theta).dot(z);
    EXPECT_NEAR(condensed, expected, kCostTolerance * direct.cost(point, u));

    const VectorXd slack = program.b + program.S * theta - program.A * z;
    std::vector<double> sorted(slack.data(), slack.data() + slack.size());
    const VectorXd slack_theta = program.b_theta - program.A_theta * theta;
    sorted.insert(sorted.end(), slack_theta.data(), slack_theta.data() + slack_theta.size());
    std::sort(sorted.begin(), sorted.end());
    const std::vector<double> slacks = direct.slacks(point, u);
    ASSERT_EQ(sorted.size(), slacks.size());
    for (std::size_t i = 0; i < sorted.size(); ++i) EXPECT_NEAR(sorted[i], slacks[i], kRowTolerance);

    EXPECT_LT(maxAbs(program.E * z + program.C * theta + program.c - u.col(0)), 1e-14);
  }
}

/// Steady state of the lateral and longitudinal axis by hand: angle K u_ref, wind against its acceleration.
struct TiltSteady {
  double acceleration_per_angle;
  void operator()(Randoms* randoms, DirectProblem::Point* point) const {
    const double angle = 0.9 * point->u_ref(0);
    point->x_ref = (VectorXd(3) << randoms->vector(1)(0), 0.0, angle).finished();
    point->d = VectorXd::Constant(1, -acceleration_per_angle * angle);
  }
};

TEST(Condense, LateralEqualsTheOriginalProblem) {
  expectEquivalent(loadProblem(problemFile("multirotor_lateral.yaml")), 1, TiltSteady{-9.8066});
}

TEST(Condense, LongitudinalEqualsTheOriginalProblem) {
  expectEquivalent(loadProblem(problemFile("multirotor_longitudinal.yaml")), 2, TiltSteady{9.8066});
}

TEST(Condense, VerticalEqualsTheOriginalProblem) {
  expectEquivalent(loadProblem(problemFile("multirotor_vertical.yaml")), 3,
                   [](Randoms* randoms, DirectProblem::Point* point) {
                     point->x_ref = (VectorXd(2) << randoms->vector(1)(0), 0.0).finished();
                     point->d = -point->u_ref;
                   });
}

/// Three states, two inputs, bounds on some states and on one side only, parameters out of order.
MpcProblem coupledProblem() {
  MpcProblem problem;
  problem.name = "coupled";
  problem.states = {{"a", "1", -2.0, kInfinity}, {"b", "1", -kInfinity, kInfinity}, {"c", "1", -3.0, 4.0}};
  problem.inputs = {{"u", "1", -1.0, 2.0}, {"v", "1", -0.5, 0.75}};
  problem.A_c = (MatrixXd(3, 3) << 0.1, 1.0, 0.3, -0.4, -0.2, 0.5, 0.0, 0.3, 0.2).finished();
  problem.B_c = (MatrixXd(3, 2) << 0.0, 1.0, 1.0, 0.2, 0.4, -0.3).finished();
  problem.Bd_c = MatrixXd::Identity(3, 3);
  problem.disturbances = {{"d0", "1", 0, 0}, {"d1", "1", 0, 0}, {"d2", "1", 0, 0}};
  problem.C = (MatrixXd(2, 3) << 1, 0, 0, 0, 0, 1).finished();
  problem.sampling_time = 0.2;
  problem.horizon = 7;
  problem.Q = (MatrixXd(3, 3) << 3, 0.5, 0, 0.5, 2, 0.1, 0, 0.1, 1).finished();
  problem.R = (MatrixXd(2, 2) << 1, 0.2, 0.2, 0.5).finished();
  problem.R_delta = (MatrixXd(2, 2) << 0.7, -0.1, -0.1, 0.3).finished();
  using Role = ParameterRole;
  problem.parameters = {
      {{"v_ref", "1", -1, 1}, Role::kInputReference, 1}, {{"e_c", "1", -1, 1}, Role::kError, 2},
      {{"u_prev", "1", -1, 1}, Role::kPreviousInput, 0}, {{"e_a", "1", -1, 1}, Role::kError, 0},
      {{"v_prev", "1", -1, 1}, Role::kPreviousInput, 1}, {{"e_b", "1", -1, 1}, Role::kError, 1},
      {{"u_ref", "1", -1, 1}, Role::kInputReference, 0}};
  return problem;
}

void dropRole(MpcProblem* problem, ParameterRole role, int index) {
  auto& all = problem->parameters;
  const auto matches = [&](const MpcProblem::Parameter& p) { return p.role == role && p.index == index; };
  all.erase(std::remove_if(all.begin(), all.end(), matches), all.end());
}

TEST(Condense, CoupledInputsStateBoundsAndParametersInAnyOrder) {
  const MpcProblem problem = coupledProblem();
  expectEquivalent(problem, 4, [&](Randoms* randoms, DirectProblem::Point* point) {
    point->x_ref = randoms->vector(3);
    point->d = -(problem.A_c * point->x_ref + problem.B_c * point->u_ref);
  });
}

TEST(Condense, AbsentPreviousInputMeansTheReference) {
  MpcProblem problem = coupledProblem();
  dropRole(&problem, ParameterRole::kPreviousInput, 1);
  expectEquivalent(problem, 5, [&](Randoms* randoms, DirectProblem::Point* point) {
    point->u_previous(1) = point->u_ref(1);
    point->x_ref = randoms->vector(3);
    point->d = -(problem.A_c * point->x_ref + problem.B_c * point->u_ref);
  });
}

TEST(Condense, AbsentInputReferenceMeansZero) {
  MpcProblem problem = coupledProblem();
  dropRole(&problem, ParameterRole::kInputReference, 0);
  dropRole(&problem, ParameterRole::kInputReference, 1);
  expectEquivalent(problem, 6, [&](Randoms* randoms, DirectProblem::Point* point) {
    point->u_ref.setZero();
    point->x_ref = randoms->vector(3);
    point->d = -(problem.A_c * point->x_ref);
  });
}

TEST(Condense, RowWithoutInputBecomesAConditionOnTheParameters) {
  MpcProblem problem = coupledProblem();
  // `a` feels no input at the first step: no direct path, and b reaches it only later in discrete time.
  problem.A_c = (MatrixXd(3, 3) << -0.5, 0, 0, 0, -0.2, 0.5, 0, 0.3, 0.2).finished();
  problem.B_c.row(0).setZero();
  problem.C = (MatrixXd(2, 3) << 0, 1, 0, 0, 0, 1).finished();
  const ParametricProgram program = condense(problem);
  // No plan changes the lower bound of `a`.
  EXPECT_EQ(program.A_theta.rows(), problem.horizon);
  for (Eigen::Index row = 0; row < program.A.rows(); ++row) EXPECT_GT(maxAbs(program.A.row(row)), 0.0);
  expectEquivalent(problem, 7, [&](Randoms* randoms, DirectProblem::Point* point) {
    point->x_ref = randoms->vector(3);
    point->d = -(problem.A_c * point->x_ref + problem.B_c * point->u_ref);
  });
}

TEST(Condense, CarriesNamesBoxesBoundsAndText) {
  const std::string path = problemFile("multirotor_lateral.yaml");
  const MpcProblem problem = loadProblem(path);
  const ParametricProgram program = loadProgram(path);
  EXPECT_EQ(program.name, "multirotor_lateral");
  EXPECT_EQ(program.text, fileText(path));
  EXPECT_EQ(program.text_kind, "yaml");
  EXPECT_EQ(program.period, problem.sampling_time);
  ASSERT_EQ(program.parameters.size(), problem.parameters.size());
  for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
    EXPECT_EQ(program.parameters[i].name, problem.parameters[i].signal.name);
    EXPECT_EQ(program.parameters[i].unit, problem.parameters[i].signal.unit);
    EXPECT_EQ(program.parameters[i].lower, problem.parameters[i].signal.lower);
    EXPECT_EQ(program.parameters[i].upper, problem.parameters[i].signal.upper);
  }
  EXPECT_EQ(program.inputs[0].upper, problem.inputs[0].upper);
  const ParametricProgram again = parseProgram(program.text, program.text_kind, "copy");
  // The same text gives the same program, bit for bit.
  EXPECT_EQ(again.H, program.H);
  EXPECT_EQ(again.F, program.F);
  EXPECT_EQ(again.S, program.S);
}

TEST(Condense, NamesWhatEachRowBounds) {
  const MpcProblem problem = coupledProblem();
  const ParametricProgram program = condense(problem);
  ASSERT_EQ(program.row_names.size(), static_cast<std::size_t>(program.rowCount()));
  const auto contains = [](const std::vector<Signal>& signals, const std::string& name) {
    return std::any_of(signals.begin(), signals.end(),
                       [&](const Signal& signal) { return name.rfind(signal.name + " at its ", 0) == 0; });
  };
  int inputs = 0;
  for (Eigen::Index row = 0; row < program.A.rows(); ++row) {
    const std::string& name = program.row_names[static_cast<std::size_t>(row)];
    Eigen::Index column = 0;
    const double greatest = program.A.row(row).cwiseAbs().maxCoeff(&column);
    if (greatest != 1.0 || program.A.row(row).cwiseAbs().sum() != 1.0) {
      EXPECT_TRUE(contains(problem.states, name)) << name;
      continue;
    }
    ++inputs;
    const std::string side = program.A(row, column) > 0.0 ? " at its upper bound" : " at its lower bound";
    EXPECT_EQ(name, problem.inputs[static_cast<std::size_t>(column % 2)].name + side + ", step " +
                        std::to_string(column / 2));
  }
  EXPECT_EQ(inputs, 2 * 2 * problem.horizon);
}

TEST(Condense, RemarksOnReferencesThatNoInputHolds) {
  MpcProblem problem = loadProblem(problemFile("multirotor_lateral.yaml"));
  EXPECT_TRUE(condense(problem).remarks.empty());
  for (MpcProblem::Parameter& parameter : problem.parameters) {
    if (parameter.role == ParameterRole::kInputReference) parameter.signal.upper = 2.0;
  }
  const std::vector<std::string> remarks = condense(problem).remarks;
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("phi_cmd_ref: its range -0.25 .. 2 exceeds the bounds"), std::string::npos)
      << remarks[0];
}

TEST(Condense, RemarksOnParametersOfADriftWithManyFreeMoves) {
  MpcProblem problem = loadProblem(problemFile("look_ahead/lateral.yaml"));
  EXPECT_TRUE(condense(problem).remarks.empty());
  problem.moves.clear();
  const std::vector<std::string> remarks = condense(problem).remarks;
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("parameters: d_y_ahead: with 20 free moves"), std::string::npos) << remarks[0];
}

TEST(Condense, EqualsTheReferenceProblem) {
  const std::string path = referenceData("rmpc/lmpc_N20_5.json");
  if (path.empty()) GTEST_SKIP() << "the reference data are absent";
  const nlohmann::json reference = nlohmann::json::parse(fileText(path));
  const ParametricProgram program = loadProgram(problemFile("reference/lateral_asl.yaml"));
  const auto expect_near = [&](const char* key, const MatrixXd& ours) {
    const nlohmann::json& theirs = reference.at(key);
    ASSERT_EQ(static_cast<Eigen::Index>(theirs.size()), ours.rows()) << key;
    for (Eigen::Index row = 0; row < ours.rows(); ++row) {
      const nlohmann::json& line = theirs[static_cast<std::size_t>(row)];
      for (Eigen::Index col = 0; col < ours.cols(); ++col) {
        const double value = (line.is_array() ? line[static_cast<std::size_t>(col)] : line).get<double>();
        EXPECT_NEAR(ours(row, col), value, 1e-13 * maxAbs(ours)) << key << " " << row << " " << col;
      }
    }
  };
  expect_near("H", program.H);
  expect_near("f", program.f);
  expect_near("F", program.F);
  expect_near("A", program.A);
  expect_near("b", program.b);
  expect_near("S", program.S);
  for (std::size_t i = 0; i < program.parameters.size(); ++i) {
    EXPECT_EQ(program.parameters[i].upper, reference.at("box")[i].get<double>());
    EXPECT_EQ(program.parameters[i].lower, -reference.at("box")[i].get<double>());
  }
}

}  // namespace
