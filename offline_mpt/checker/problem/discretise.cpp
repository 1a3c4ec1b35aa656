#include "core/text.hpp"
#include "problem/optimal_control.hpp"

namespace checker {
namespace {

/// exp(M), by a Taylor series of M / 2^k whose rest is bounded, and k squarings.
BallMatrix exponential(const BallMatrix& M) {
  constexpr int kMostSquarings = 64;
  constexpr unsigned kTerms = 120;
  int squarings = 0;
  mpq_class scale(1);
  for (; M.norm() * scale > mpq_class(1, 2); ++squarings) {
    require(squarings < kMostSquarings, "the model is too fast for the sampling time");
    scale /= 2;
  }
  const BallMatrix small = M.scaled(scale);
  BallMatrix result = BallMatrix::identity(M.rows()), power = result;
  // The next term's norm is at most 2^-k / k!; all that follow add up to less than as much again.
  mpq_class rest(1);
  for (unsigned k = 1; k <= kTerms; ++k) {
    power = (power * small).scaled(mpq_class(1, k));
    result = result + power;
    rest /= 2 * k;
  }
  result = result.widened(rest);
  for (; squarings > 0; --squarings) result = result * result;
  return result;
}

}  // namespace

DiscreteSystem discretised(const TrackingProblem& problem) {
  if (problem.is_discrete) return {problem.A, problem.B, problem.B_d};
  const std::size_t nx = problem.A.rows(), nu = problem.B.columns(), nd = problem.B_d.columns();
  BallMatrix M(nx + nu + nd, nx + nu + nd);
  M.setBlock(0, 0, problem.A);
  M.setBlock(0, nx, problem.B);
  M.setBlock(0, nx + nu, problem.B_d);
  const BallMatrix map = exponential(M.scaled(problem.sampling_time));
  return {map.block(0, 0, nx, nx), map.block(0, nx, nx, nu), map.block(0, nx + nu, nx, nd)};
}

}  // namespace checker
