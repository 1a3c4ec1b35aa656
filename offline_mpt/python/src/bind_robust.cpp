#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "outside_error.hpp"
#include "path_caster.hpp"
#include "polyfly_base/read_text.hpp"
#include "polytope_sets/rational.hpp"
#include "robust_mpc/online_lp.hpp"
#include "robust_mpc/robust_problem.hpp"
#include "solve.hpp"

namespace polyfly::python {
namespace {

namespace py = pybind11;
using Path = std::filesystem::path;

/// The law of a robust problem by linear programs, with what its errors name.
class OnlineRobust {
 public:
  explicit OnlineRobust(const RobustProblem& problem)
      : name_(problem.name), size_(problem.parameters.size()), law_(problem) {}

  double input(const Numbers& theta) {
    const double* numbers = parameterOf(theta, size_, name_);
    const std::optional<double> u = law_.input(numbers);
    if (!u) throw OutsideError(name_ + ": theta: no plan meets all bounds");
    return *u;
  }

 private:
  std::string name_;
  std::size_t size_;
  OnlineLp law_;
};

std::vector<Signal> parameterSignals(const RobustProblem& problem) {
  std::vector<Signal> signals;
  for (const RobustProblem::Parameter& parameter : problem.parameters) signals.push_back(parameter.signal);
  return signals;
}

/// In the disturbances' own units, which the problem scales to [-1, 1].
DiscreteModel modelOf(const RobustProblem& problem) {
  DiscreteModel model;
  model.A = toDoubles(problem.A);
  model.B = toDoubles(problem.B);
  model.Bd = toDoubles(problem.G);
  for (Eigen::Index j = 0; j < model.Bd.cols(); ++j) {
    const Signal& disturbance = problem.disturbances[static_cast<std::size_t>(j)];
    model.Bd.col(j) *= 2.0 / (disturbance.upper - disturbance.lower);
  }
  model.period = problem.sampling_time;
  return model;
}

/// A column for each parameter: what it adds to x, or to u, besides the error.
Eigen::MatrixXd shiftsOf(const RobustProblem& problem, RationalVector RobustProblem::Parameter::*shift,
                         int size) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, problem.parameterCount());
  for (int j = 0; j < problem.parameterCount(); ++j) {
    const RationalVector& values = problem.parameters[static_cast<std::size_t>(j)].*shift;
    for (std::size_t i = 0; i < values.size(); ++i)
      result(static_cast<Eigen::Index>(i), j) = nearestDouble(values[i]);
  }
  return result;
}

}  // namespace

void bindRobust(py::module_& module) {
  py::class_<OnlineRobust>(module, "OnlineRobust",
                           "A robust problem solved by linear programs at single parameters.")
      .def("__call__", &OnlineRobust::input, py::arg("theta"),
           "The first input. Raises OutsideError where no plan meets all bounds.");
  py::class_<RobustProblem> type(
      module, "RobustProblem",
      "Minimum-peak robust MPC: the least guaranteed peak for all disturbances in a box.");
  defineSolve(type, &solveRobust);
  defineText(type);
  type.def_readonly("description", &RobustProblem::description)
      .def_readonly("states", &RobustProblem::states)
      .def_readonly("inputs", &RobustProblem::inputs)
      .def_readonly("disturbances", &RobustProblem::disturbances)
      .def_property_readonly("parameters", &parameterSignals)
      .def_readonly("sampling_time", &RobustProblem::sampling_time, "[s]")
      .def_readonly("horizon", &RobustProblem::horizon, "N")
      .def_property_readonly(
          "C", [](const RobustProblem& problem) { return toDoubles(problem.C); },
          "Outputs whose greatest peak is minimised.")
      .def("discretise", &modelOf, "The model of a sampling time; Bd is the effect of the disturbances w.")
      .def_property_readonly("error_parameters", &RobustProblem::errorParameters,
                             "Place in theta of the error of each state.")
      .def_property_readonly(
          "state_shifts",
          [](const RobustProblem& problem) {
            return shiftsOf(problem, &RobustProblem::Parameter::state_shift, problem.stateCount());
          },
          "A column for each parameter: x = e + state_shifts theta.")
      .def(
          "online", [](const RobustProblem& problem) { return std::make_unique<OnlineRobust>(problem); },
          "The law by linear programs, for single parameters.");
  module.def(
      "load_robust_problem", [](const Path& path) { return loadRobustProblem(path.string()); },
      py::arg("path"), "Robust problem of a .yaml file.");
  module.def("parse_robust_problem", &parseRobustProblem, py::arg("text"), py::arg("source"),
             "Robust problem of a YAML text; `source` is used in errors.");
  module.def(
      "is_robust_file",
      [](const Path& path) { return isRobustProblem(readText(path.string()), path.string()); },
      py::arg("path"), "Whether a .yaml file's type is robust_mpc.");
}

}  // namespace polyfly::python
