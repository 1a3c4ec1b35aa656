#include <algorithm>

#include "core/text.hpp"
#include "problem/optimal_control.hpp"

namespace checker {
namespace {

constexpr int kMostDoublings = 60;

const mpq_class& enough() {
  static const mpq_class kEnough(mpz_class(1), mpz_class(1) << 330);
  return kEnough;
}

/// Whether a power of the closed loop A - B K has a norm below 1.
bool isStable(BallMatrix closed_loop) {
  for (int k = 0; k < kMostDoublings && closed_loop.norm() < mpq_class(mpz_class(1) << 64); ++k) {
    if (closed_loop.norm() < 1) return true;
    closed_loop = closed_loop * closed_loop;
  }
  return false;
}

}  // namespace

TerminalWeight terminalWeight(const DiscreteSystem& system, const BallMatrix& Q, const BallMatrix& R) {
  // Doubling: P_k is the cost of 2^k periods. Its errors do not matter, as the residual decides.
  BallMatrix A = system.A.middle();
  BallMatrix G = (system.B * solved(R, system.B.transposed())).middle();
  BallMatrix P = Q;
  bool converged = false;
  for (int k = 0; k < kMostDoublings && !converged; ++k) {
    const BallMatrix W = BallMatrix::identity(A.rows()) + G * P;
    const BallMatrix by_A = solved(W, A).middle(), by_G = solved(W, G).middle();
    const BallMatrix change = (A.transposed() * P * by_A).middle();
    G = (G + A * by_G * A.transposed()).middle();
    A = (A * by_A).middle();
    P = (P + change).middle();
    converged = change.greatest() <= enough() * P.greatest();
  }
  require(converged, "the Riccati equation has no solution that is found");
  const BallMatrix& At = system.A;
  const BallMatrix B_P = system.B.transposed() * P;
  const BallMatrix K = solved(R + B_P * system.B, B_P * At);
  require(isStable(At - system.B * K), "the solution of the Riccati equation does not stabilise");
  const BallMatrix residual = At.transposed() * P * At - At.transposed() * B_P.transposed() * K + Q - P;
  return {P, residual.greatest()};
}

std::vector<BallMatrix> feedbackGains(const TrackingProblem& problem, const DiscreteSystem& system,
                                      const BallMatrix& terminal_weight) {
  const std::size_t nx = system.A.rows(), nu = system.B.columns();
  BallMatrix A(nx + nu, nx + nu), B(nx + nu, nu), P(nx + nu, nx + nu), Q(nx + nu, nx + nu),
      cross(nu, nx + nu);
  A.setBlock(0, 0, system.A);
  B.setBlock(0, 0, system.B);
  B.setBlock(nx, 0, BallMatrix::identity(nu));
  P.setBlock(0, 0, terminal_weight);
  // The cost of a change, (u~_k - u~_{k-1})'R_delta (u~_k - u~_{k-1}).
  Q.setBlock(0, 0, problem.Q);
  Q.setBlock(nx, nx, problem.R_delta);
  cross.setBlock(0, nx, BallMatrix(nu, nu) - problem.R_delta);
  std::vector<BallMatrix> gains;
  for (std::size_t k = 0; k < problem.blocks.size(); ++k) {
    const BallMatrix right = B.transposed() * P * A + cross;
    gains.push_back(solved(problem.R + problem.R_delta + B.transposed() * P * B, right).middle());
    P = (Q + A.transposed() * P * A - right.transposed() * gains.back()).middle();
  }
  std::reverse(gains.begin(), gains.end());
  return gains;
}

}  // namespace checker
