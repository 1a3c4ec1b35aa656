#include "linear_system.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <string>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Greatest number of doublings; step k spans 2^k periods.
constexpr int kMaxDoublings = 60;
// Tolerance of the last change of P, relative.
constexpr double kStepTolerance = 1e-14;
// Tolerance of the residual of the Riccati equation, relative to P.
constexpr double kResidualTolerance = 1e-9;
// Number of squarings: powers of the closed loop up to 2^36 tell its stability.
constexpr int kSquarings = 36;
// Norm of a power below which the closed loop is stable.
constexpr double kVanished = 1e-6;
// Square roots of a matrix: greatest number of iterations, and tolerance of the last change, relative.
constexpr int kRootIterations = 60;
constexpr double kRootTolerance = 1e-12;
// Entries of a logarithm below this, relative to the greatest one, are rounding.
constexpr double kLogarithmTolerance = 1e-12;
// Greatest error of the exponential of a logarithm, relative.
constexpr double kLogarithmResidual = 1e-10;
// Least reciprocal condition of Eq. 6 after scaling.
constexpr double kSingularTolerance = 1e-12;

double norm(const Eigen::MatrixXd& matrix) { return matrix.size() == 0 ? 0.0 : matrix.cwiseAbs().maxCoeff(); }

double wideNorm(const WideMatrix& matrix) { return norm(rounded(matrix)); }

/// exp(M) by scaling to a norm of at most 1/2, a Taylor series to rounding, and squaring.
template <typename Matrix>
Matrix exponential(const Matrix& matrix) {
  using Scalar = typename Matrix::Scalar;
  constexpr int kTerms = 26;  // 0.5^27 / 27! is below 1e-36
  const double length = matrix.template cast<double>().cwiseAbs().rowwise().sum().maxCoeff();
  if (!std::isfinite(length)) return Matrix::Constant(matrix.rows(), matrix.cols(), Scalar(length));
  const int squarings = length > 0.5 ? static_cast<int>(std::ceil(std::log2(length))) + 1 : 0;
  const Matrix scaled = matrix * Scalar(std::ldexp(1.0, -squarings));
  const Matrix identity = Matrix::Identity(matrix.rows(), matrix.cols());
  Matrix result = identity;
  for (int k = kTerms; k >= 1; --k) result = (identity + scaled * result / Scalar(k)).eval();
  for (int k = 0; k < squarings; ++k) result = (result * result).eval();
  return result;
}

/// exp(T [A B Bd; 0 0 0]) = [exp(A T), int exp(A s) ds [B Bd]; 0, I], which needs no inverse of A.
Eigen::MatrixXd augmentedModel(const MpcProblem& problem) {
  const Eigen::Index nx = problem.A_c.rows();
  const Eigen::Index nu = problem.B_c.cols();
  const Eigen::Index nd = problem.Bd_c.cols();
  Eigen::MatrixXd augmented = Eigen::MatrixXd::Zero(nx + nu + nd, nx + nu + nd);
  augmented.topLeftCorner(nx, nx) = problem.A_c;
  augmented.block(0, nx, nx, nu) = problem.B_c;
  augmented.block(0, nx + nu, nx, nd) = problem.Bd_c;
  return augmented;
}

/// Principal square root by the iteration of Denman and Beavers, which converges where no eigenvalue is 0 or negative;
/// not finite where it does not.
Eigen::MatrixXd squareRoot(const Eigen::MatrixXd& matrix) {
  Eigen::MatrixXd root = matrix;
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
  for (int k = 0; k < kRootIterations && root.allFinite(); ++k) {
    const Eigen::MatrixXd next = 0.5 * (root + inverse.inverse());
    inverse = (0.5 * (inverse + root.inverse())).eval();
    const bool converged = norm(next - root) <= kRootTolerance * norm(next);
    root = next;
    if (converged) return root;
  }
  return Eigen::MatrixXd::Constant(matrix.rows(), matrix.cols(), std::numeric_limits<double>::quiet_NaN());
}

/// Principal logarithm: square roots until the matrix is near the identity, then the series
/// log M = 2 (W + W^3 / 3 + W^5 / 5 + ...), W = (M - I) (M + I)^-1.
Eigen::MatrixXd logarithm(Eigen::MatrixXd matrix) {
  constexpr int kMaxRoots = 60;
  // Terms until 0.1^27 / 27 is below rounding.
  constexpr int kTerms = 14;
  constexpr double kNearIdentity = 0.2;
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
  double scale = 2.0;
  for (int k = 0; k < kMaxRoots && matrix.allFinite(); ++k) {
    if ((matrix - identity).cwiseAbs().rowwise().sum().maxCoeff() <= kNearIdentity) {
      const Eigen::MatrixXd ratio = (matrix + identity).partialPivLu().solve(matrix - identity);
      const Eigen::MatrixXd square = ratio * ratio;
      Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(matrix.rows(), matrix.cols());
      for (int term = kTerms - 1; term >= 0; --term) sum = (identity / (2 * term + 1) + square * sum).eval();
      return scale * ratio * sum;
    }
    matrix = squareRoot(matrix);
    scale *= 2.0;
  }
  return Eigen::MatrixXd::Constant(matrix.rows(), matrix.cols(), std::numeric_limits<double>::quiet_NaN());
}

/// Whether powers of the matrix vanish: by squaring, so that a spectral radius of 1 - 1e-9 still counts.
bool isStable(Eigen::MatrixXd matrix) {
  for (int k = 0; k < kSquarings && matrix.allFinite(); ++k) {
    if (norm(matrix) < kVanished) return true;
    matrix = (matrix * matrix).eval();
  }
  return false;
}

}  // namespace

WideModel wideModel(const MpcProblem& problem, double period) {
  if (!(period > 0.0)) throw Error(problem.source + ": period: must be greater than 0");
  if (problem.discrete) {
    if (period == problem.sampling_time) return {wide(problem.A_c), wide(problem.B_c), wide(problem.Bd_c)};
    return wideModel(continuousModel(problem), period);
  }
  const Eigen::Index nx = problem.A_c.rows();
  const Eigen::Index nu = problem.B_c.cols();
  const WideMatrix map = exponential<WideMatrix>(wide(augmentedModel(problem)) * DoubleDouble(period));
  if (!rounded(map).allFinite()) throw Error(problem.source + ": model.A: is too fast for the sampling time");
  return {map.topLeftCorner(nx, nx), map.block(0, nx, nx, nu),
          map.block(0, nx + nu, nx, problem.Bd_c.cols())};
}

DiscreteModel discretise(const MpcProblem& problem, double period) {
  const WideModel model = wideModel(problem, period);
  return {rounded(model.A), rounded(model.B), rounded(model.Bd), period};
}

MpcProblem continuousModel(const MpcProblem& problem) {
  if (!problem.discrete) return problem;
  const Eigen::Index nx = problem.A_c.rows();
  const Eigen::Index nu = problem.B_c.cols();
  Eigen::MatrixXd map = augmentedModel(problem);
  map.bottomRightCorner(map.rows() - nx, map.rows() - nx).setIdentity();
  Eigen::MatrixXd rates = logarithm(map);
  if (!rates.allFinite() || !(norm(exponential(rates) - map) <= kLogarithmResidual * norm(map))) {
    throw Error(
        problem.source +
        ": model.A: must have no eigenvalue that is 0 or negative, for another period than sampling_time");
  }
  rates = (rates.cwiseAbs().array() <= kLogarithmTolerance * norm(rates)).select(0.0, rates) /
          problem.sampling_time;
  MpcProblem result = problem;
  result.discrete = false;
  result.A_c = rates.topLeftCorner(nx, nx);
  result.B_c = rates.block(0, nx, nx, nu);
  result.Bd_c = rates.block(0, nx + nu, nx, problem.Bd_c.cols());
  return result;
}

WideMatrix wideRiccati(const WideMatrix& A, const WideMatrix& B, const WideMatrix& Q, const WideMatrix& R) {
  const Eigen::Index n = A.rows();
  const bool sizes = n > 0 && A.cols() == n && B.rows() == n && B.cols() > 0 && Q.rows() == n &&
                     Q.cols() == n && R.rows() == B.cols() && R.cols() == B.cols();
  if (!sizes) throw Error("Riccati equation: sizes of A, B, Q, R must agree");
  using Factors = Eigen::PartialPivLU<WideMatrix>;
  const DoubleDouble half = 0.5;
  const WideMatrix identity = WideMatrix::Identity(n, n);
  // Structured doubling: P_k is the cost of 2^k periods, so that it converges quadratically. The last change is of the
  // order of the root of what is left.
  WideMatrix A_k = A;
  WideMatrix G_k = B * Factors(R).solve(B.transpose());
  WideMatrix P = Q;
  bool converged = false;
  for (int k = 0; k < kMaxDoublings && !converged; ++k) {
    const Factors W(identity + G_k * P);
    const WideMatrix solved_a = W.solve(A_k);
    const WideMatrix solved_g = W.solve(G_k);
    const WideMatrix change = A_k.transpose() * P * solved_a;
    const WideMatrix G_change = A_k * solved_g * A_k.transpose();
    A_k = (A_k * solved_a).eval();
    G_k += half * (G_change + G_change.transpose());
    P += half * (change + change.transpose());
    if (!rounded(P).allFinite()) break;
    converged = wideNorm(change) <= kStepTolerance * wideNorm(P);
  }
  const std::string hint = "; (A, B) must be stabilisable and (A, Q) detectable";
  if (!converged) throw Error("Riccati equation: no convergence" + hint);
  const WideMatrix K = Factors(R + B.transpose() * P * B).solve(B.transpose() * P * A);
  const WideMatrix residual = A.transpose() * P * A - A.transpose() * P * B * K + Q - P;
  if (!(wideNorm(residual) <= kResidualTolerance * wideNorm(P)))
    throw Error("Riccati equation: residual too large" + hint);
  if (!isStable(rounded(A - B * K))) throw Error("Riccati equation: solution does not stabilise" + hint);
  return P;
}

Eigen::MatrixXd solveRiccati(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
                             const Eigen::MatrixXd& R) {
  return rounded(wideRiccati(wide(A), wide(B), wide(Q), wide(R)));
}

SteadyState steadyState(const DiscreteModel& model, const Eigen::MatrixXd& C, const Eigen::VectorXd& d,
                        const Eigen::VectorXd& r) {
  const WideMatrix solution = wideSteadyState({wide(model.A), wide(model.B), wide(model.Bd)}, C, d, r);
  const Eigen::Index nx = model.A.rows();
  return {rounded(solution.topRows(nx)), rounded(solution.bottomRows(solution.rows() - nx))};
}

WideMatrix wideSteadyState(const WideModel& model, const Eigen::MatrixXd& C, const Eigen::VectorXd& d,
                           const Eigen::VectorXd& r) {
  const Eigen::Index nx = model.A.rows();
  const Eigen::Index nu = model.B.cols();
  if (C.rows() != nu || C.cols() != nx || d.size() != model.Bd.cols() || r.size() != C.rows()) {
    throw Error("steady state: sizes of A, B, C, d, r must agree, with as many outputs as inputs");
  }
  WideMatrix matrix = WideMatrix::Zero(nx + nu, nx + nu);
  matrix.topLeftCorner(nx, nx) = model.A - WideMatrix::Identity(nx, nx);
  matrix.topRightCorner(nx, nu) = model.B;
  matrix.bottomLeftCorner(nu, nx) = wide(C);
  WideMatrix right(nx + nu, 1);
  right << -(model.Bd * wide(d)), wide(r);
  // Rows differ by the sampling time and by units, columns by units: scale both, so that the rank test sees the structure.
  const auto scaleOf = [](const auto& numbers) {
    const double norm = wideNorm(numbers);
    return DoubleDouble(norm > 0.0 ? 1.0 / norm : 1.0);
  };
  WideMatrix units = WideMatrix::Ones(nx + nu, 1);
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      const DoubleDouble row = scaleOf(matrix.row(i));
      matrix.row(i) *= row;
      right(i) *= row;
      const DoubleDouble column = scaleOf(matrix.col(i));
      matrix.col(i) *= column;
      units(i) *= column;
    }
  }
  Eigen::FullPivLU<WideMatrix> lu(matrix);
  lu.setThreshold(kSingularTolerance);
  if (!lu.isInvertible()) throw Error("steady state: [A-I B; C 0] (Eq. 6) must be invertible");
  return lu.solve(right).cwiseProduct(units);
}

}  // namespace polyfly
