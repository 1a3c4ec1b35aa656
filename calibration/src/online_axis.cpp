#include "online_axis.hpp"

#include <string>

#include "mpc_core/mpc_problem.hpp"
#include "region_maps/error.hpp"

namespace polyfly {
namespace {

ParametricProgram programOf(const RegionMap& map) {
  ParametricProgram program = parseProgram(std::string(map.problemText()), std::string(map.problemKind()),
                                           map.path() + " (its problem)");
  if (program.parameterCount() != static_cast<int>(map.parameters().size()) || program.inputCount() < 1) {
    throw Error(map.path() + ": its problem has other parameters or inputs than the map");
  }
  return program;
}

}  // namespace

OnlineAxis::OnlineAxis(const RegionMap& map)
    : program_(programOf(map)), solver_(program_.H, program_.A, program_.equalities) {}

std::optional<double> OnlineAxis::input(const double* theta) {
  const Eigen::Map<const Eigen::VectorXd> parameters(theta, program_.parameterCount());
  gradient_ = program_.f + program_.F * parameters;
  bounds_ = program_.b + program_.S * parameters;
  if (solver_.solve(gradient_.data(), bounds_.data()) != QpStatus::kOptimal) {
    return std::nullopt;
  }
  return program_.E.row(0).dot(solver_.z()) + program_.C.row(0).dot(parameters) + program_.c(0);
}

}  // namespace polyfly
