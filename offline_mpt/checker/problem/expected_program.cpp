#include "problem/optimal_control.hpp"

namespace checker {
namespace {

/// theta to the errors, the input reference, and the change u_{-1} - u_ref that the first input is compared with.
struct Selection {
  BallMatrix error, reference, before;
};

Selection selection(const TrackingProblem& problem) {
  using Role = TrackingProblem::Role;
  const std::size_t nx = problem.A.rows(), nu = problem.B.columns(), p = problem.parameters.size();
  Selection result{BallMatrix(nx, p), BallMatrix(nu, p), BallMatrix(nu, p)};
  std::vector<bool> has_previous(nu, false);
  for (std::size_t j = 0; j < p; ++j) {
    const TrackingProblem::Parameter& parameter = problem.parameters[j];
    if (parameter.role == Role::kError) result.error.at(parameter.index, j) = Ball(1);
    if (parameter.role == Role::kInputReference) result.reference.at(parameter.index, j) = Ball(1);
    if (parameter.role != Role::kPreviousInput) continue;
    result.before.at(parameter.index, j) = Ball(1);
    has_previous[parameter.index] = true;
  }
  for (std::size_t i = 0; i < nu; ++i) {
    for (std::size_t j = 0; j < p && has_previous[i]; ++j)
      result.before.at(i, j) -= result.reference.at(i, j);
  }
  return result;
}

/// The cost as z'Z z + 2 z'T theta, which grows by terms v'W v of v = on_z z + on_theta theta.
class Cost {
 public:
  Cost(std::size_t n, std::size_t p) : on_z_(n, n), on_theta_(n, p) {}

  void add(const BallMatrix& on_z, const BallMatrix& on_theta, const BallMatrix& weight) {
    const BallMatrix left = on_z.transposed() * weight;
    on_z_ = on_z_ + left * on_z;
    on_theta_ = on_theta_ + left * on_theta;
  }

  BallMatrix H() const { return on_z_ + on_z_; }
  BallMatrix F() const { return on_theta_ + on_theta_; }

 private:
  BallMatrix on_z_, on_theta_;
};

std::vector<Ball> rowOf(const BallMatrix& matrix, std::size_t i, int sign) {
  std::vector<Ball> row;
  for (std::size_t j = 0; j < matrix.columns(); ++j)
    row.push_back(sign > 0 ? matrix.at(i, j) : -matrix.at(i, j));
  return row;
}

/// lower <= on_z z + on_theta theta <= upper, row by row.
void addRange(const BallMatrix& on_z, const BallMatrix& on_theta, std::size_t i,
              const TrackingProblem::Range& range, std::vector<ExpectedRow>& rows) {
  rows.push_back({rowOf(on_z, i, 1), rowOf(on_theta, i, -1), Ball(mpq_class(range.upper))});
  rows.push_back({rowOf(on_z, i, -1), rowOf(on_theta, i, 1), Ball(mpq_class(-range.lower))});
}

}  // namespace

ExpectedProgram expectedProgram(const TrackingProblem& problem) {
  const std::size_t nx = problem.A.rows(), nu = problem.B.columns(), N = problem.horizon;
  const std::size_t n = N * nu, p = problem.parameters.size();
  const DiscreteSystem system = discretised(problem);
  const TerminalWeight terminal = terminalWeight(system, problem.Q, problem.R);
  const Selection select = selection(problem);
  ExpectedProgram result;
  result.C = select.reference;
  result.riccati_residual = terminal.residual;
  Cost cost(n, p);
  // e_k and u~_{k-1} as functions of z and theta.
  BallMatrix e_z(nx, n), e_theta = select.error, before_z(nu, n), before_theta = select.before;
  for (std::size_t k = 0; k < N; ++k) {
    BallMatrix u_z(nu, n);
    u_z.setBlock(0, k * nu, BallMatrix::identity(nu));
    const BallMatrix u_theta(nu, p);
    cost.add(e_z, e_theta, problem.Q);
    cost.add(u_z, u_theta, problem.R);
    cost.add(u_z - before_z, u_theta - before_theta, problem.R_delta);
    for (std::size_t i = 0; i < nu; ++i) addRange(u_z, select.reference, i, problem.inputs[i], result.rows);
    e_z = system.A * e_z + system.B * u_z;
    e_theta = system.A * e_theta;
    for (std::size_t i = 0; i < nx; ++i) {
      if (problem.states[i]) addRange(e_z, e_theta, i, *problem.states[i], result.rows);
    }
    before_z = u_z;
    before_theta = u_theta;
  }
  cost.add(e_z, e_theta, terminal.P);
  result.H = cost.H();
  result.F = cost.F();
  return result;
}

}  // namespace checker
