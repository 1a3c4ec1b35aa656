#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/online_program.hpp"
#include "path_caster.hpp"
#include "polyfly_base/error.hpp"
#include "solve.hpp"

namespace polyfly::python {
namespace {

namespace py = pybind11;
using Path = std::filesystem::path;

const char* roleName(const MpcProblem::Parameter& parameter) {
  switch (parameter.role) {
    case ParameterRole::kError:
      return "error";
    case ParameterRole::kPreviousInput:
      return "previous_input";
    case ParameterRole::kInputReference:
      return "input_reference";
    case ParameterRole::kStateReference:
      return "state_reference";
    case ParameterRole::kState:
      return "state";
    case ParameterRole::kReference:
      return "reference";
    case ParameterRole::kDisturbance:
      return "disturbance";
  }
  return "";
}

/// Indices of the states that a bound on x itself concerns.
std::vector<int> boundedStates(const MpcProblem& problem) {
  std::vector<int> states;
  for (int i = 0; i < problem.stateCount(); ++i) {
    const bool bounded = std::any_of(
        problem.constraints.begin(), problem.constraints.end(),
        [i](const StageConstraint& constraint) { return constraint.absolute && constraint.G_x(i) != 0.0; });
    if (bounded) states.push_back(i);
  }
  return states;
}

SteadyState steadyStateOf(const MpcProblem& problem, const Eigen::VectorXd& reference,
                          const std::optional<Eigen::VectorXd>& disturbance) {
  const auto check = [&](const char* field, Eigen::Index size, Eigen::Index expected) {
    if (size == expected) return;
    throw Error(problem.name + ": " + field + ": must have " + std::to_string(expected) + " numbers, got " +
                std::to_string(size));
  };
  const Eigen::Index nd = problem.Bd_c.cols();
  const Eigen::VectorXd d = disturbance.value_or(Eigen::VectorXd::Zero(nd));
  check("reference", reference.size(), problem.C.rows());
  check("disturbance", d.size(), nd);
  return steadyState(discretise(problem, problem.sampling_time), problem.C, d, reference);
}

void bindParts(py::module_& module) {
  py::class_<MpcProblem::Parameter>(module, "Parameter",
                                    "An entry of the parameter vector of a tracking problem.")
      .def_readonly("signal", &MpcProblem::Parameter::signal)
      .def_property_readonly("role", &roleName, "As in the file: 'error', 'previous_input', ....")
      .def_readonly("index", &MpcProblem::Parameter::index, "Of the state, input, output or disturbance.");
  py::class_<DiscreteModel>(module, "DiscreteModel", "x_{k+1} = A x_k + B u_k + Bd d_k")
      .def_readonly("A", &DiscreteModel::A)
      .def_readonly("B", &DiscreteModel::B)
      .def_readonly("Bd", &DiscreteModel::Bd)
      .def_readonly("period", &DiscreteModel::period, "[s]");
  py::class_<SteadyState>(module, "SteadyState",
                          "State and input that hold an output under a disturbance (Eq. 6).")
      .def_readonly("x", &SteadyState::x)
      .def_readonly("u", &SteadyState::u);
}

}  // namespace

void bindProblems(py::module_& module) {
  bindParts(module);
  py::class_<MpcProblem> type(module, "Problem",
                              "A tracking problem: model, weights, bounds and parameters.");
  defineSolve(type, [](const MpcProblem& problem, const SolveOptions& options, py::object progress) {
    return solveProgram(condense(problem), options, std::move(progress));
  });
  defineText(type);
  type.def_readonly("description", &MpcProblem::description)
      .def_readonly("states", &MpcProblem::states,
                    "With the bounds on x - x_ref, infinite where there are none.")
      .def_readonly("inputs", &MpcProblem::inputs, "With the bounds of u.")
      .def_readonly("disturbances", &MpcProblem::disturbances)
      .def_readonly("parameters", &MpcProblem::parameters)
      .def_readonly("fixed_parameters", &MpcProblem::fixed_parameters,
                    "Parameters with a value (lower = upper) in place of a range: no entries of theta.")
      .def_property_readonly("bounded_states", &boundedStates,
                             "Indices of the states that a bound on x itself concerns.")
      .def_readonly("discrete", &MpcProblem::discrete, "True: the model is in discrete time.")
      .def_readonly("A", &MpcProblem::A_c,
                    "Continuous time: x' = A x + B u + Bd d; with `discrete`, x_{k+1} = A x_k + ....")
      .def_readonly("B", &MpcProblem::B_c)
      .def_readonly("Bd", &MpcProblem::Bd_c)
      .def_readonly("C", &MpcProblem::C, "Tracked output y = C x.")
      .def_readonly("Q", &MpcProblem::Q)
      .def_readonly("R", &MpcProblem::R)
      .def_readonly("R_delta", &MpcProblem::R_delta)
      .def_readonly("sampling_time", &MpcProblem::sampling_time, "Ts [s]")
      .def_readonly("horizon", &MpcProblem::horizon, "N")
      .def(
          "discretise",
          [](const MpcProblem& problem, std::optional<double> period) {
            return discretise(problem, period.value_or(problem.sampling_time));
          },
          py::arg("period") = py::none(),
          "Zero-order hold over `period` seconds; by default the sampling time.")
      .def("steady_state", &steadyStateOf, py::arg("reference"), py::arg("disturbance") = py::none(),
           "State and input that hold the output at `reference` under a disturbance.")
      .def(
          "condense", [](const MpcProblem& problem) { return condense(problem); },
          "The Program in the inputs over the horizon (states eliminated).")
      .def(
          "online",
          [](const MpcProblem& problem) { return std::make_unique<OnlineProgram>(condense(problem)); },
          "The problem for solutions at single parameters.");
  module.def(
      "load_problem", [](const Path& path) { return loadProblem(path.string()); }, py::arg("path"),
      "Tracking problem of a .yaml file.");
  module.def("parse_problem", &parseProblem, py::arg("text"), py::arg("source"),
             "Tracking problem of a YAML text; `source` is used in errors.");
}

}  // namespace polyfly::python
