#include "verify/program_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "mpc_core/decompositions.hpp"
#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

constexpr double kOracleInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::vector<int> allEqualities(const ParametricProgram& program) {
  std::vector<int> result = program.equalities;
  const Eigen::Index m = program.A.rows(), n = program.A.cols(), p = program.S.cols();
  Eigen::MatrixXd rows(m, n + 1 + p);
  rows << program.A, program.b, program.S;
  for (Eigen::Index i = 0; i < m; ++i) {
    const double norm = program.A.row(i).norm();
    if (norm > 0.0) rows.row(i) /= norm;
  }
  for (Eigen::Index i = 0; i < m; ++i) {
    if (program.A.row(i).norm() == 0.0) continue;
    for (Eigen::Index j = i + 1; j < m; ++j) {
      if ((rows.row(i) + rows.row(j)).cwiseAbs().maxCoeff() <= tolerance::kOppositeEntries) {
        result.push_back(static_cast<int>(i));
        break;
      }
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

Eigen::VectorXd halfRange(const ParametricProgram& program) {
  Eigen::VectorXd half(program.parameterCount());
  for (Eigen::Index i = 0; i < half.size(); ++i) {
    const Signal& signal = program.parameters[static_cast<std::size_t>(i)];
    half[i] = 0.5 * (signal.upper - signal.lower);
  }
  return half;
}

// Variables (z, d, r): min r s.t. A z - S W d <= b + S theta, |d_i| <= r, theta + W d in the parameter set,
// with W the half-ranges.
InteriorPointQp distanceProgram(const ParametricProgram& program, const std::vector<int>& equalities) {
  const Eigen::Index n = program.variableCount(), p = program.parameterCount(), m = program.rowCount();
  const Eigen::Index k = program.A_theta.rows();
  const auto W = halfRange(program).asDiagonal().toDenseMatrix().eval();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(m + 4 * p + k, n + p + 1);
  A.topLeftCorner(m, n) = program.A;
  A.block(0, n, m, p) = -program.S * W;
  const auto identity = Eigen::MatrixXd::Identity(p, p);
  A.block(m, n, p, p) = identity;
  A.block(m + p, n, p, p) = -identity;
  A.block(m, n + p, 2 * p, 1).setConstant(-1.0);
  A.block(m + 2 * p, n, p, p) = identity;
  A.block(m + 3 * p, n, p, p) = -identity;
  if (k > 0) A.block(m + 4 * p, n, k, p) = program.A_theta * W;
  return InteriorPointQp(Eigen::MatrixXd::Zero(A.cols(), A.cols()), A, equalities);
}

// The rows, the equalities' other sides and, as equalities, the outputs: z may leave an equality by a slack,
// as it may any row, or outputs that are rounded would contradict it.
InteriorPointQp programWithOutput(const ParametricProgram& program, const std::vector<int>& equalities) {
  const Eigen::Index m = program.rowCount(), q = program.inputCount();
  const auto e = static_cast<Eigen::Index>(equalities.size());
  Eigen::MatrixXd A(m + e + q, program.variableCount());
  A.topRows(m) = program.A;
  for (Eigen::Index i = 0; i < e; ++i) A.row(m + i) = -program.A.row(equalities[static_cast<std::size_t>(i)]);
  A.bottomRows(q) = program.E;
  std::vector<int> outputs(static_cast<std::size_t>(q));
  std::iota(outputs.begin(), outputs.end(), static_cast<int>(m + e));
  return InteriorPointQp(program.H, A, std::move(outputs));
}

bool definiteOnNullSpace(const ParametricProgram& program, const std::vector<int>& equalities) {
  const Eigen::Index n = program.variableCount();
  Eigen::MatrixXd N = Eigen::MatrixXd::Identity(n, n);
  if (!equalities.empty()) {
    Eigen::MatrixXd transposed(n, static_cast<Eigen::Index>(equalities.size()));
    for (std::size_t i = 0; i < equalities.size(); ++i) {
      transposed.col(static_cast<Eigen::Index>(i)) = program.A.row(equalities[i]).transpose();
    }
    const PivotedQr qr(transposed, tolerance::kOracleRank);
    N = qr.Q().rightCols(n - qr.rank());
  }
  if (N.cols() == 0) return true;
  const Eigen::MatrixXd reduced = N.transpose() * program.H * N;
  const Eigen::VectorXd values = symmetricEigenvalues(reduced);
  return values.minCoeff() >
         tolerance::kLeastEigenvalue * std::max(values.maxCoeff(), std::numeric_limits<double>::min());
}

}  // namespace

ProgramOracle::ProgramOracle(const ParametricProgram& program)
    : program_(&program),
      equalities_(allEqualities(program)),
      half_range_(halfRange(program)),
      qp_(program.H, program.A, equalities_),
      distance_(distanceProgram(program, equalities_)),
      with_output_(programWithOutput(program, equalities_)),
      strictly_convex_(definiteOnNullSpace(program, equalities_)) {
  const Eigen::Index n = program.variableCount(), p = program.parameterCount();
  distance_cost_ = Eigen::VectorXd::Zero(n + p + 1);
  distance_cost_[n + p] = 1.0;
  distance_bounds_ = Eigen::VectorXd::Zero(program.rowCount() + 4 * p + program.A_theta.rows());
}

bool ProgramOracle::inParameterSet(const Eigen::VectorXd& theta) const {
  for (Eigen::Index i = 0; i < program_->A_theta.rows(); ++i) {
    const auto row = program_->A_theta.row(i);
    const double scale = row.transpose().cwiseProduct(half_range_).norm();
    if (row.dot(theta) - program_->b_theta[i] > tolerance::kParameterSet * scale) return false;
  }
  return true;
}

const OracleAnswer& ProgramOracle::solve(const Eigen::VectorXd& theta) {
  using Verdict = OracleAnswer::Verdict;
  answer_.residual = 0.0;
  answer_.iterations = 0;
  answer_.verdict = Verdict::kInfeasible;
  if (!inParameterSet(theta)) return answer_;
  g_ = program_->f;
  g_.noalias() += program_->F * theta;
  b_ = program_->b;
  b_.noalias() += program_->S * theta;
  const InteriorPointSolution& solution = qp_.solve(g_, b_);
  answer_.iterations = solution.iterations;
  switch (solution.status) {
    case InteriorPointStatus::kInfeasible:
      return answer_;
    case InteriorPointStatus::kUnbounded:  // a direction alone: there need not be a solution to start from
      if (!(distanceToFeasible(theta) > tolerance::kCertainDistance)) answer_.verdict = Verdict::kUnbounded;
      return answer_;
    case InteriorPointStatus::kOptimal:
      answer_.verdict = Verdict::kFeasible;
      break;
    case InteriorPointStatus::kInaccurate:
      answer_.verdict = Verdict::kUndecided;
      break;
  }
  answer_.residual = solution.residual;
  answer_.objective = solution.objective;
  answer_.u = program_->c;
  answer_.u.noalias() += program_->C * theta;
  answer_.u.noalias() += program_->E * solution.z;
  // Without a certificate of either kind the program may be infeasible by very little: the distance tells.
  if (answer_.verdict == Verdict::kUndecided && distanceToFeasible(theta) > tolerance::kCertainDistance) {
    answer_.verdict = Verdict::kInfeasible;
    answer_.residual = 0.0;
  }
  return answer_;
}

double ProgramOracle::distanceToFeasible(const Eigen::VectorXd& theta) {
  const Eigen::Index p = program_->parameterCount(), m = program_->rowCount();
  distance_bounds_.head(m) = program_->b;
  distance_bounds_.head(m).noalias() += program_->S * theta;
  for (Eigen::Index i = 0; i < p; ++i) {
    const Signal& signal = program_->parameters[static_cast<std::size_t>(i)];
    distance_bounds_[m + 2 * p + i] = std::max(0.0, signal.upper - theta[i]) / half_range_[i];
    distance_bounds_[m + 3 * p + i] = std::max(0.0, theta[i] - signal.lower) / half_range_[i];
  }
  if (program_->A_theta.rows() > 0) {
    distance_bounds_.tail(program_->A_theta.rows()) = program_->b_theta - program_->A_theta * theta;
  }
  const InteriorPointSolution& solution = distance_.solve(distance_cost_, distance_bounds_);
  if (solution.status == InteriorPointStatus::kInfeasible) return kOracleInfinity;
  if (!(solution.residual <= tolerance::kUsableResidual)) return kUnknown;
  return std::max(0.0, solution.objective);
}

ProgramOracle::Place ProgramOracle::place(const Eigen::VectorXd& theta, double depth) {
  using Verdict = OracleAnswer::Verdict;
  Eigen::VectorXd moved = theta;
  bool known = true;
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    const Signal& signal = program_->parameters[static_cast<std::size_t>(i)];
    for (const double side : {-1.0, 1.0}) {
      moved[i] = theta[i] + side * depth * half_range_[i];
      if (moved[i] < signal.lower || moved[i] > signal.upper) continue;
      const Verdict verdict = solve(moved).verdict;
      if (verdict == Verdict::kInfeasible) return Place::kEdge;
      known = known && verdict != Verdict::kUndecided;
    }
    moved[i] = theta[i];
  }
  return known ? Place::kDeep : Place::kUnknown;
}

double ProgramOracle::objectiveWithOutput(const Eigen::VectorXd& theta, const Eigen::VectorXd& u,
                                          double slack) {
  const Eigen::Index m = program_->rowCount(), q = program_->inputCount();
  const auto e = static_cast<Eigen::Index>(equalities_.size());
  const Eigen::VectorXd g = program_->f + program_->F * theta;
  const Eigen::VectorXd give = slack * program_->A.rowwise().norm();
  Eigen::VectorXd bounds(m + e + q);
  bounds.head(m) = program_->b + program_->S * theta;
  for (Eigen::Index i = 0; i < e; ++i) {
    const int row = equalities_[static_cast<std::size_t>(i)];
    bounds[m + i] = give[row] - bounds[row];
  }
  bounds.head(m) += give;
  bounds.tail(q) = u - program_->C * theta - program_->c;
  const InteriorPointSolution& solution = with_output_.solve(g, bounds);
  if (solution.status == InteriorPointStatus::kInfeasible) return kOracleInfinity;
  if (!(solution.residual <= tolerance::kUsableResidual)) return kUnknown;
  return solution.objective;
}

}  // namespace polyfly
