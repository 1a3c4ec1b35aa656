#include "online_controller/laws/linear_tuning.hpp"

#include <limits>
#include <string>

#include "online_controller/laws/axis.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

/// State whose error the parameter of that name is.
int stateOf(const MpcProblem& problem, const char* name) {
  for (const MpcProblem::Parameter& parameter : problem.parameters) {
    if (parameter.role == ParameterRole::kError && parameter.signal.name == name) return parameter.index;
  }
  throw Error(problem.source + ": parameter '" + name + "': missing");
}

/// Reads or writes the tuning of one axis, by `exchange(tuning's field, problem's number)`.
template <class Problem, class Tuning, class Exchange>
void exchangeAxis(Problem& problem, Tuning& tuning, const AxisNames& names, Exchange&& exchange) {
  const int position = stateOf(problem, names.position_error);
  const int velocity = stateOf(problem, names.velocity_error);
  exchange(tuning.position_weight, problem.Q(position, position));
  exchange(tuning.velocity_weight, problem.Q(velocity, velocity));
  if (names.angle_error != nullptr) {
    const int angle = stateOf(problem, names.angle_error);
    exchange(tuning.angle_weight, problem.Q(angle, angle));
  }
  exchange(tuning.command_weight, problem.R(0, 0));
  exchange(tuning.rate_weight, problem.R_delta(0, 0));
  exchange(tuning.command_min, problem.inputs.at(0).lower);
  exchange(tuning.command_max, problem.inputs.at(0).upper);
}

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

Signal signal(const std::string& name, const std::string& unit, double bound) {
  Signal result;
  result.name = name;
  result.unit = unit;
  result.lower = -bound;
  result.upper = bound;
  return result;
}

/// Axis with a lagging tilt, or without a lag: names, sizes and parameters; the numbers come later.
MpcProblem frame(const AxisNames& names, double sampling_time, int horizon) {
  const int states = names.angle_error != nullptr ? 3 : 2;
  MpcProblem problem;
  problem.name = std::string("multirotor_") + names.axis;
  problem.description = "made from parameters";
  problem.source = std::string("parameters of the ") + names.axis + " axis";
  problem.states = {signal("p", "m", kUnlimited), signal("v", "m/s", kUnlimited)};
  if (states == 3) problem.states.push_back(signal("angle", "rad", kUnlimited));
  problem.inputs = {signal(names.input, names.input_unit, 0.0)};
  problem.disturbances = {signal("d", "m/s^2", kUnlimited)};
  problem.A_c = Eigen::MatrixXd::Zero(states, states);
  problem.A_c(0, 1) = 1.0;
  problem.B_c = Eigen::MatrixXd::Zero(states, 1);
  problem.Bd_c = Eigen::MatrixXd::Zero(states, 1);
  problem.Bd_c(1, 0) = 1.0;
  problem.C = Eigen::MatrixXd::Zero(1, states);
  problem.C(0, 0) = 1.0;
  problem.Q = Eigen::MatrixXd::Zero(states, states);
  problem.R = problem.R_delta = Eigen::MatrixXd::Zero(1, 1);
  problem.sampling_time = sampling_time;
  problem.horizon = horizon;
  const auto parameter = [&](const char* name, const std::string& unit, ParameterRole role, int index) {
    problem.parameters.push_back({signal(name, unit, 1e6), role, index});
  };
  parameter(names.position_error, "m", ParameterRole::kError, 0);
  parameter(names.velocity_error, "m/s", ParameterRole::kError, 1);
  if (states == 3) parameter(names.angle_error, "rad", ParameterRole::kError, 2);
  parameter(names.previous_input, names.input_unit, ParameterRole::kPreviousInput, 0);
  parameter(names.input_reference, names.input_unit, ParameterRole::kInputReference, 0);
  return problem;
}

void setLag(MpcProblem& problem, double drive, double gain, double time) {
  problem.A_c(1, 2) = drive;
  problem.A_c(2, 2) = -1.0 / time;
  problem.B_c(2, 0) = gain / time;
}

}  // namespace

LinearTuning linearTuning(const std::array<MpcProblem, 3>& problems) {
  LinearTuning tuning;
  for (std::size_t i = 0; i < 3; ++i) {
    exchangeAxis(problems[i], tuning[i], kAxisNames[i], [](double& field, double number) { field = number; });
  }
  return tuning;
}

std::array<MpcProblem, 3> tuned(std::array<MpcProblem, 3> problems, const LinearTuning& tuning) {
  constexpr std::array<const char*, 3> kWeights{"linear/position_weight_x", "linear/position_weight_y",
                                                "linear/position_weight_z"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(tuning[i].position_weight > 0.0))
      throw Error(std::string(kWeights[i]) + ": must be above 0: without it nothing brings the vehicle back");
    exchangeAxis(problems[i], tuning[i], kAxisNames[i], [](double field, double& number) { number = field; });
  }
  return problems;
}

std::array<MpcProblem, 3> linearProblems(const MultirotorModel& model, double sampling_time, int horizon) {
  std::array<MpcProblem, 3> problems;
  for (std::size_t i = 0; i < 3; ++i) {
    problems[i] = frame(kAxisNames[i], sampling_time, horizon);
    problems[i].A_c(1, 1) = -model.drag(static_cast<Eigen::Index>(i));
  }
  setLag(problems[0], model.gravity, model.pitch_gain, model.pitch_time);
  setLag(problems[1], -model.gravity, model.roll_gain, model.roll_time);
  problems[2].B_c(1, 0) = 1.0;
  constexpr double kAngle = 0.4363323;  // 25 degrees
  const LinearTuning firefly{{{40.0, 20.0, 20.0, 35.0, 0.3, -kAngle, kAngle},
                              {40.0, 20.0, 20.0, 35.0, 0.3, -kAngle, kAngle},
                              {60.0, 25.0, 0.0, 2.0, 0.0025, 5.0 - model.gravity, 20.0 - model.gravity}}};
  return tuned(std::move(problems), firefly);
}

}  // namespace polyfly
