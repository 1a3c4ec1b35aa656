#include "polytope_sets/terminal_set.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "polyfly_base/error.hpp"
#include "polytope_sets/invariant_set.hpp"
#include "tolerances.hpp"

namespace polyfly {
namespace {

/// Bounds row e <= bound that hold for ever in the set.
class ErrorBounds {
 public:
  ErrorBounds(const MpcProblem& problem, const Eigen::MatrixXd& K) : problem_(&problem), K_(K) {}

  void add(const Eigen::RowVectorXd& row, double lower, double upper, const std::string& name) {
    addSide(row, upper, name);
    addSide(-row, -lower, name);
  }

  /// G_x x + G_u u with references anywhere in their ranges.
  void addAbsolute(const Eigen::RowVectorXd& G_x, const Eigen::RowVectorXd& G_u, const Signal& bounds) {
    double least = 0.0, greatest = 0.0;
    for (const auto* list : {&problem_->parameters, &problem_->fixed_parameters}) {
      for (const MpcProblem::Parameter& parameter : *list) {
        double factor = 0.0;
        if (parameter.role == ParameterRole::kStateReference) factor = G_x(parameter.index);
        if (parameter.role == ParameterRole::kInputReference) factor = G_u(parameter.index);
        least += std::min(factor * parameter.signal.lower, factor * parameter.signal.upper);
        greatest += std::max(factor * parameter.signal.lower, factor * parameter.signal.upper);
      }
    }
    add(G_x - G_u * K_, bounds.lower - least, bounds.upper - greatest, bounds.name);
  }

  ExactPolytope polytope() const {
    ExactPolytope set;
    set.dimension = problem_->stateCount();
    set.rows = rows_;
    return set;
  }

 private:
  void addSide(const Eigen::RowVectorXd& row, double bound, const std::string& name) {
    if (!std::isfinite(bound) || row.isZero(0.0)) return;
    if (!(bound > 0.0)) {
      throw Error(problem_->source + ": terminal set: " + name +
                  ": a reference in its range reaches the bound, so no set around it stays within");
    }
    ExactHalfSpace half_space;
    for (Eigen::Index i = 0; i < row.size(); ++i) half_space.a.push_back(Rational(row(i)));
    half_space.b = Rational(bound);
    rows_.push_back(half_space);
  }

  const MpcProblem* problem_;
  const Eigen::MatrixXd& K_;
  std::vector<ExactHalfSpace> rows_;
};

ExactPolytope hardBounds(const MpcProblem& problem, const Eigen::MatrixXd& K, const Eigen::MatrixXd& loop) {
  const Eigen::Index nx = problem.stateCount();
  const Eigen::Index nu = problem.inputCount();
  ErrorBounds bounds(problem, K);
  for (const MpcProblem::Parameter& parameter : problem.parameters) {
    if (parameter.role == ParameterRole::kError)
      bounds.add(Eigen::RowVectorXd::Unit(nx, parameter.index), parameter.signal.lower,
                 parameter.signal.upper, parameter.signal.name);
  }
  for (Eigen::Index i = 0; i < nx; ++i) {
    const Signal& state = problem.states[static_cast<std::size_t>(i)];
    bounds.add(Eigen::RowVectorXd::Unit(nx, i), state.lower, state.upper, state.name);
  }
  const Eigen::MatrixXd change = -K * (loop - Eigen::MatrixXd::Identity(nx, nx));
  for (Eigen::Index i = 0; i < nu; ++i) {
    bounds.addAbsolute(Eigen::RowVectorXd::Zero(nx), Eigen::RowVectorXd::Unit(nu, i),
                       problem.inputs[static_cast<std::size_t>(i)]);
    if (problem.changes.empty()) continue;
    const Signal& range = problem.changes[static_cast<std::size_t>(i)];
    bounds.add(change.row(i), range.lower, range.upper, range.name);
  }
  for (const StageConstraint& constraint : problem.constraints) {
    if (constraint.soft) continue;
    if (constraint.absolute) {
      bounds.addAbsolute(constraint.G_x, constraint.G_u, constraint.signal);
    } else {
      bounds.add(constraint.G_x - constraint.G_u * K, constraint.signal.lower, constraint.signal.upper,
                 constraint.signal.name);
    }
  }
  return bounds.polytope();
}

SetModel loopModel(const MpcProblem& problem, const Eigen::MatrixXd& loop, const ExactPolytope& X) {
  const int nx = problem.stateCount();
  SetModel model;
  model.name = problem.name;
  model.A = exactly(loop);
  model.B = RationalMatrix(nx, 0);
  model.A_p = RationalMatrix(nx, 0);
  model.E = RationalMatrix(nx, 0);
  model.c.assign(static_cast<std::size_t>(nx), Rational(0));
  model.X = X;
  return model;
}

void checkRoles(const MpcProblem& problem) {
  for (const auto* list : {&problem.parameters, &problem.fixed_parameters}) {
    for (const MpcProblem::Parameter& parameter : *list) {
      const bool fits = parameter.role != ParameterRole::kState &&
                        parameter.role != ParameterRole::kReference &&
                        parameter.role != ParameterRole::kDisturbance;
      if (!fits)
        throw Error(problem.source + ": parameters: " + parameter.signal.name +
                    ": a terminal set is computed for errors, without a disturbance");
      if (parameter.role == ParameterRole::kError && parameter.signal.lower == parameter.signal.upper)
        throw Error(problem.source + ": parameters: " + parameter.signal.name + ": must have a range");
    }
  }
}

}  // namespace

TerminalSet terminalSet(const MpcProblem& problem) {
  checkRoles(problem);
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  const Eigen::MatrixXd P = solveRiccati(model.A, model.B, problem.Q, problem.R);
  const Eigen::MatrixXd K =
      (problem.R + model.B.transpose() * P * model.B).ldlt().solve(model.B.transpose() * P * model.A);
  const Eigen::MatrixXd loop = model.A - model.B * K;
  const ExactPolytope X = hardBounds(problem, K, loop);
  InvariantOptions options;
  options.exact = false;
  const InvariantSet found =
      maximalInvariantSet(loopModel(problem, tolerance::kLoopGrowth * loop, X), options);
  if (found.status != InvariantSet::Status::kMaximal)
    throw Error(problem.source + ": terminal set: the recursion did not end within " +
                std::to_string(found.iterations) + " steps");
  const auto rows = static_cast<Eigen::Index>(found.set.rows.size());
  TerminalSet result;
  result.iterations = found.iterations;
  result.T.resize(rows, problem.stateCount());
  result.t = Eigen::VectorXd::Constant(rows, tolerance::kSetShrink);
  ExactPolytope rounded;
  rounded.dimension = problem.stateCount();
  for (Eigen::Index i = 0; i < rows; ++i) {
    const ExactHalfSpace& row = found.set.rows[static_cast<std::size_t>(i)];
    ExactHalfSpace written;
    for (Eigen::Index j = 0; j < result.T.cols(); ++j) {
      result.T(i, j) = Rational(row.a[static_cast<std::size_t>(j)] / row.b).get_d();
      written.a.push_back(Rational(result.T(i, j)));
    }
    written.b = Rational(result.t(i));
    rounded.rows.push_back(written);
  }
  if (!proveInvariant(loopModel(problem, loop, X), rounded).holds)
    throw Error(problem.source + ": terminal set: the set that was found is not proven invariant");
  return result;
}

}  // namespace polyfly
