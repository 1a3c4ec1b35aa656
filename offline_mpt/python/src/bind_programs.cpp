#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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
using nlohmann::ordered_json;
using Matrix = Eigen::Ref<const Eigen::MatrixXd>;
using Vector = Eigen::Ref<const Eigen::VectorXd>;

/// The arguments of MPQP, in the words of the generic JSON form.
struct Arrays {
  Eigen::MatrixXd H;
  Eigen::VectorXd f;
  Eigen::MatrixXd F;
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  Eigen::MatrixXd B;
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

struct ProgramOptions {
  std::optional<std::vector<int>> out;
  std::vector<int> equalities;
  std::optional<Eigen::MatrixXd> A_theta;
  std::optional<Eigen::VectorXd> b_theta;
  std::string name;
};

ordered_json listOf(const Vector& vector) {
  return std::vector<double>(vector.data(), vector.data() + vector.size());
}

ordered_json rowsOf(const Matrix& matrix) {
  ordered_json rows = ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    const Eigen::VectorXd row = matrix.row(i);
    rows.push_back(listOf(row));
  }
  return rows;
}

// By way of the text that the map will carry, so that program and text are the same, with all checks of a file.
ParametricProgram programOf(const Arrays& arrays, const ProgramOptions& options) {
  ordered_json json;
  json["name"] = options.name;
  json["H"] = rowsOf(arrays.H);
  json["f"] = listOf(arrays.f);
  json["F"] = rowsOf(arrays.F);
  json["A"] = rowsOf(arrays.A);
  json["b"] = listOf(arrays.b);
  json["B"] = rowsOf(arrays.B);
  json["lb"] = listOf(arrays.lower);
  json["ub"] = listOf(arrays.upper);
  if (options.out) json["out"] = *options.out;
  if (!options.equalities.empty()) json["eq_ids"] = options.equalities;
  if (options.A_theta) json["A_theta"] = rowsOf(*options.A_theta);
  if (options.b_theta) json["b_theta"] = listOf(*options.b_theta);
  return parseProgramJson(json.dump() + "\n", options.name);
}

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
      "MPQP",
      [](const Matrix& H, const Vector& f, const Matrix& F, const Matrix& A, const Vector& b, const Matrix& B,
         const Vector& lo, const Vector& hi, std::optional<std::vector<int>> out, std::vector<int> equalities,
         std::optional<Eigen::MatrixXd> A_theta, std::optional<Eigen::VectorXd> b_theta, std::string name) {
        return programOf(
            {H, f, F, A, b, B, lo, hi},
            {std::move(out), std::move(equalities), std::move(A_theta), std::move(b_theta), std::move(name)});
      },
      py::arg("H"), py::arg("f"), py::arg("F"), py::arg("A"), py::arg("b"), py::arg("B"), py::arg("lo"),
      py::arg("hi"), py::kw_only(), py::arg("out") = py::none(), py::arg("equalities") = std::vector<int>(),
      py::arg("A_theta") = py::none(), py::arg("b_theta") = py::none(), py::arg("name") = "mpqp",
      "The Program min_z 1/2 z'Hz + (f + F theta)'z s.t. A z <= b + B theta, lo <= theta <= hi, with rows in "
      "`equalities` "
      "(from 0) as '=' and A_theta theta <= b_theta. out: entries of z that are the result; all by default.");
  module.def(
      "MPLP",
      [](const Vector& f, const Matrix& F, const Matrix& A, const Vector& b, const Matrix& B,
         const Vector& lo, const Vector& hi, std::optional<std::vector<int>> out, std::vector<int> equalities,
         std::optional<Eigen::MatrixXd> A_theta, std::optional<Eigen::VectorXd> b_theta, std::string name) {
        return programOf(
            {Eigen::MatrixXd::Zero(f.size(), f.size()), f, F, A, b, B, lo, hi},
            {std::move(out), std::move(equalities), std::move(A_theta), std::move(b_theta), std::move(name)});
      },
      py::arg("f"), py::arg("F"), py::arg("A"), py::arg("b"), py::arg("B"), py::arg("lo"), py::arg("hi"),
      py::kw_only(), py::arg("out") = py::none(), py::arg("equalities") = std::vector<int>(),
      py::arg("A_theta") = py::none(), py::arg("b_theta") = py::none(), py::arg("name") = "mplp",
      "As MPQP with H = 0: a linear program.");
  module.def(
      "load_program", [](const Path& path) { return loadProgram(path.string()); }, py::arg("path"),
      "Program of a .json file, or condensed from a .yaml file.");
}

}  // namespace polyfly::python
