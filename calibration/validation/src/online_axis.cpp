#include "online_axis.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <string>

#include "mpc_core/dense_qp.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/parametric_program.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

std::string problemPlace(const RegionMap& map) { return map.path() + " (its problem)"; }

ParametricProgram programOf(const RegionMap& map) {
  ParametricProgram program =
      parseProgram(std::string(map.problemText()), std::string(map.problemKind()), problemPlace(map));
  if (program.parameterCount() != static_cast<int>(map.parameters().size()) || program.inputCount() < 1) {
    throw Error(map.path() + ": its problem has other parameters or inputs than the map");
  }
  return program;
}

bool isMinimumPeak(const RegionMap& map) {
  return map.problemKind() == "yaml" &&
         parseFlightModel(std::string(map.problemText()), problemPlace(map)).minimum_peak;
}

}  // namespace

class OnlineAxis::Program {
 public:
  explicit Program(const RegionMap& map)
      : program_(programOf(map)), solver_(program_.H, program_.A, program_.equalities) {}

  std::optional<double> input(const double* theta) {
    const Eigen::Map<const Eigen::VectorXd> parameters(theta, program_.parameterCount());
    gradient_ = program_.f + program_.F * parameters;
    bounds_ = program_.b + program_.S * parameters;
    if (solver_.solve(gradient_.data(), bounds_.data()) != QpStatus::kOptimal) return std::nullopt;
    return program_.E.row(0).dot(solver_.z()) + program_.C.row(0).dot(parameters) + program_.c(0);
  }

 private:
  ParametricProgram program_;
  DenseQp solver_;
  Eigen::VectorXd gradient_;
  Eigen::VectorXd bounds_;
};

OnlineAxis::OnlineAxis(const RegionMap& map) : size_(map.parameters().size()) {
  if (!isMinimumPeak(map)) program_ = std::make_unique<Program>(map);
}

OnlineAxis::~OnlineAxis() = default;

std::optional<double> OnlineAxis::input(const double* theta) {
  if (last_theta_.empty() || !std::equal(theta, theta + size_, last_theta_.begin())) {
    last_ = program_->input(theta);
    last_theta_.assign(theta, theta + size_);
  }
  return last_;
}

}  // namespace polyfly
