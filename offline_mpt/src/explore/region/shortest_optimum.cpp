#include "explore/region/shortest_optimum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "explore/region/tolerances.hpp"
#include "mpc_core/decompositions.hpp"

namespace polyfly {
ShortestOptimum::ShortestOptimum(const NormalisedProgram& program) : program_(program) {
  if (!program.semidefinite) return;
  greatest_ = symmetricEigenvalues(program.curvature)(program.n - 1);
}

bool ShortestOptimum::isZero(double part, double whole) {
  if (part > tolerance::kShortestZero * whole / tolerance::kShortestDoubt &&
      part < tolerance::kShortestZero * whole * tolerance::kShortestDoubt)
    doubtful_ = true;
  return part <= tolerance::kShortestZero * whole;
}

// With A' = Y T and Z an orthonormal basis of what A leaves free, z = Y T^-1' bound + Z v; v is the shortest
// that solves (Z'HZ) v = -Z'(cost + H z).
KktSolver::Outcome ShortestOptimum::solve(const ActiveSet& active) {
  const auto k = static_cast<Eigen::Index>(active.size());
  const Eigen::Index n = program_.n;
  doubtful_ = false;
  noise_ = program_.rounding;
  if (k > n) return Outcome::kDependent;
  Eigen::MatrixXd A(n, k), bound(k, program_.p + 1);
  for (Eigen::Index r = 0; r < k; ++r) {
    A.col(r) = program_.M.row(active[static_cast<std::size_t>(r)]);
    bound.row(r) = program_.D.row(active[static_cast<std::size_t>(r)]);
  }
  Eigen::MatrixXd Q = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd T(k, k);
  if (k > 0) {
    OrthogonalFactors factors = orthogonalFactors(A);
    Q = std::move(factors.Q);
    T = std::move(factors.R);
    const double least = T.diagonal().cwiseAbs().minCoeff();
    if (least <= tolerance::kIndependent) return Outcome::kDependent;
    noise_ /= least;
  }
  const Eigen::MatrixXd& factor = T;
  const auto upper = factor.triangularView<Eigen::Upper>();
  const Eigen::MatrixXd Y = Q.leftCols(k), Z = Q.rightCols(n - k);
  z_ = Eigen::MatrixXd::Zero(n, program_.p + 1);
  if (k > 0) z_ = Y * factor.transpose().triangularView<Eigen::Lower>().solve(bound);
  const Eigen::MatrixXd gradient = program_.cost + program_.curvature * z_;
  const double size = program_.cost.cwiseAbs().maxCoeff() + greatest_ * z_.cwiseAbs().maxCoeff();
  Eigen::MatrixXd v = Eigen::MatrixXd::Zero(n - k, program_.p + 1), w = v;
  if (n > k) {
    const SymmetricEigen eigen = symmetricEigen(Z.transpose() * program_.curvature * Z);
    const Eigen::MatrixXd slopes = eigen.vectors.transpose() * Z.transpose() * gradient;
    for (Eigen::Index i = 0; i < n - k; ++i) {
      const double curvature = eigen.values(i);
      if (isZero(curvature, greatest_)) {
        if (!isZero(slopes.row(i).cwiseAbs().maxCoeff(), size)) return Outcome::kNoOptimum;
        continue;
      }
      noise_ = std::max(noise_, program_.rounding * greatest_ / curvature);
      v += eigen.vectors.col(i) * (-1.0 / curvature * slopes.row(i));
      w += eigen.vectors.col(i) * (1.0 / curvature / curvature * slopes.row(i));
    }
    z_ += Z * v;
  }
  if (k == 0) return Outcome::kSolved;
  cost_multipliers_ = -upper.solve(Y.transpose() * (program_.curvature * z_ + program_.cost));
  multipliers_ = -upper.solve(Y.transpose() * (program_.curvature * Z * w + z_));
  for (Eigen::Index r = 0; r < k; ++r) {
    if (isZero(cost_multipliers_.row(r).cwiseAbs().maxCoeff(), size)) cost_multipliers_.row(r).setZero();
  }
  return Outcome::kSolved;
}

void ShortestOptimum::multiplier(std::size_t place, double* affine) const {
  for (int j = 0; j <= program_.p; ++j) affine[j] = multipliers_(static_cast<Eigen::Index>(place), j);
}

void ShortestOptimum::costMultiplier(std::size_t place, double* affine) const {
  for (int j = 0; j <= program_.p; ++j) affine[j] = cost_multipliers_(static_cast<Eigen::Index>(place), j);
}

void ShortestOptimum::slack(int row, double* affine) const {
  for (int j = 0; j <= program_.p; ++j) affine[j] = program_.D(row, j) - program_.M.row(row).dot(z_.col(j));
}

double ShortestOptimum::constantSlack() const { return tolerance::kConstantRow; }

double ShortestOptimum::law(std::vector<double>& out) const {
  const Eigen::MatrixXd law = program_.U + program_.output * z_;
  out.clear();
  for (Eigen::Index i = 0; i < law.rows(); ++i) {
    for (int j = 0; j <= program_.p; ++j) out.push_back(law(i, j));
  }
  return noise_;
}

CostScale ShortestOptimum::costScale(const std::vector<double>& cost_multipliers) const {
  CostScale result;
  for (const double cost_multiplier : cost_multipliers)
    result.scale = std::max(result.scale, std::abs(cost_multiplier));
  return result;
}

bool ShortestOptimum::crossCostFacet(const ActiveSet& active, int leaving, ActiveSetList& sets) const {
  sets.push({active.data(), active.size()}, leaving);
  return true;
}

}  // namespace polyfly
