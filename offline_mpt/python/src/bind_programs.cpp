#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "arrays.hpp"
#include "bindings.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/online_program.hpp"
#include "outside_error.hpp"
#include "path_caster.hpp"
#include "solve.hpp"

namespace polyfly::python {
namespace {

namespace py = pybind11;
using Path = std::filesystem::path;

py::array_t<double> solveOnline(OnlineProgram& online, const Numbers& theta) {
  const ParametricProgram& program = online.program();
  const double* numbers = parameterOf(theta, program.parameters.size(), program.name);
  py::array_t<double> u(program.inputCount());
  const char* rule = "";
  switch (online.solve(numbers, u.mutable_data())) {
    case QpStatus::kOptimal:
      return u;
    case QpStatus::kInfeasible:
      throw OutsideError(program.name + ": theta: the constraints contradict each other");
    case QpStatus::kIterationLimit:
      rule = "the solver reached its bound of iterations";
      break;
    case QpStatus::kNotFinite:
      rule = "must hold finite numbers only";
      break;
    case QpStatus::kNotConvex:
      rule = "the Hessian is not positive definite";
      break;
  }
  throw Error(program.name + ": theta: " + rule);
}

void bindOnline(py::module_& module) {
  py::class_<OnlineProgram>(
      module, "OnlineProgram",
      "A program solved at one parameter after the other, as in flight. Each solution starts from "
      "the active set of the one before.")
      .def("__call__", &solveOnline, py::arg("theta"),
           "Input u at theta. Raises OutsideError where it is infeasible.")
      .def("reset", &OnlineProgram::reset, "Forgets the active set.")
      .def_property_readonly(
          "iterations", [](const OnlineProgram& online) { return online.solver().iterations(); },
          "Working sets that the last solution tried.")
      .def_property_readonly(
          "kkt_residual", [](const OnlineProgram& online) { return online.solver().kktResidual(); },
          "Greatest violation of the KKT conditions at the last solution.");
}

}  // namespace

void bindPrograms(py::module_& module) {
  bindOnline(module);
  using Program = ParametricProgram;
  py::class_<Program> type(
      module, "Program",
      "min_z 1/2 z'Hz + (f + F theta)'z  s.t.  A z <= b + B theta, with u = E z + C theta + c.");
  defineSolve(type, &solveProgram);
  defineText(type);
  type.def_readonly("text_kind", &Program::text_kind, "'yaml' or 'json'.")
      .def_readonly("period", &Program::period, "Sampling time [s]. 0: none.")
      .def_readonly("H", &Program::H)
      .def_readonly("f", &Program::f)
      .def_readonly("F", &Program::F)
      .def_readonly("A", &Program::A)
      .def_readonly("b", &Program::b)
      .def_readonly("B", &Program::S)
      .def_readonly("E", &Program::E)
      .def_readonly("C", &Program::C)
      .def_readonly("c", &Program::c)
      .def_readonly("A_theta", &Program::A_theta)
      .def_readonly("b_theta", &Program::b_theta)
      .def_readonly("equalities", &Program::equalities, "Rows that hold with '='.")
      .def_readonly("parameters", &Program::parameters)
      .def_readonly("inputs", &Program::inputs)
      .def_readonly("remarks", &Program::remarks, "What the author of the problem may not have meant.")
      .def(
          "online", [](const Program& program) { return std::make_unique<OnlineProgram>(program); },
          "The program for solutions at single parameters. H must be positive definite.");
  module.def(
      "parse_program",
      [](const std::string& text, const std::string& source) {
        // The map carries the text: numbers as all tools write them.
        const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
        return parseProgramJson(json.is_discarded() ? text : json.dump() + "\n", source);
      },
      py::arg("text"), py::arg("source"), "Program of a JSON text; `source` is used in errors.");
  module.def(
      "load_program", [](const Path& path) { return loadProgram(path.string()); }, py::arg("path"),
      "Program of a .json file, or condensed from a .yaml file.");
}

}  // namespace polyfly::python
