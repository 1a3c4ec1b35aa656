#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <vector>

#include "glpk_lp.hpp"
#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// Critical regions of a small strictly convex program, found by trying all active sets: no facets, no steps,
/// no tree. Sets that cannot be active anywhere take their supersets with them.
class BruteForce {
 public:
  struct Region {
    /// All rows that hold with equality throughout the region.
    std::vector<int> rows;
    /// An interior parameter.
    Eigen::VectorXd centre;
    /// Radius of the largest ball around the centre.
    double radius = 0.0;  ///< [half ranges]
    Eigen::MatrixXd K;    ///< z = K theta + k
    Eigen::VectorXd k;
  };

  explicit BruteForce(const ParametricProgram& program, double least_radius = 1e-7)
      : program_(program), least_radius_(least_radius), active_(program.equalities) {
    const int p = program.parameterCount();
    half_.resize(p);
    middle_.resize(p);
    for (int i = 0; i < p; ++i) {
      const Signal& signal = program.parameters[static_cast<std::size_t>(i)];
      half_[i] = 0.5 * (signal.upper - signal.lower);
      middle_[i] = 0.5 * (signal.upper + signal.lower);
    }
    extend(0);
  }

  /// One entry for each set of rows.
  const std::map<std::vector<int>, Region>& regions() const { return regions_; }

 private:
  void extend(int next) {
    if (!canBeActive()) return;
    examine();
    if (static_cast<int>(active_.size()) == program_.variableCount()) return;
    for (int row = next; row < program_.rowCount(); ++row) {
      if (isEquality(row)) continue;
      active_.push_back(row);
      extend(row + 1);
      active_.pop_back();
    }
  }

  bool isEquality(int row) const {
    for (const int equality : program_.equalities) {
      if (equality == row) return true;
    }
    return false;
  }

  // Some (z, t) is feasible with these rows as equalities; theta = middle + half .* t.
  bool canBeActive() const {
    const Eigen::Index n = program_.A.cols(), p = half_.size(), m = program_.A.rows(),
                       k = program_.A_theta.rows();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(m + 2 * p + k, n + p);
    Eigen::VectorXd b = Eigen::VectorXd::Ones(A.rows());
    A.topLeftCorner(m, n) = program_.A;
    A.block(0, n, m, p) = -program_.S * half_.asDiagonal();
    b.head(m) = program_.b + program_.S * middle_;
    A.block(m, n, p, p).setIdentity();
    A.block(m + p, n, p, p) = -Eigen::MatrixXd::Identity(p, p);
    if (k > 0) {
      A.block(m + 2 * p, n, k, p) = program_.A_theta * half_.asDiagonal();
      b.tail(k) = program_.b_theta - program_.A_theta * middle_;
    }
    return solveByGlpk(Eigen::VectorXd::Zero(n + p), A, b, active_).status == GLP_OPT;
  }

  void examine() {
    const Eigen::Index n = program_.H.rows(), p = half_.size(), k = static_cast<Eigen::Index>(active_.size());
    Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + k, n + k), right(n + k, p + 1);
    kkt.topLeftCorner(n, n) = program_.H;
    right.topRows(n) << -program_.F, -program_.f;
    for (Eigen::Index i = 0; i < k; ++i) {
      const int row = active_[static_cast<std::size_t>(i)];
      kkt.block(n + i, 0, 1, n) = program_.A.row(row);
      kkt.block(0, n + i, n, 1) = program_.A.row(row).transpose();
      right.row(n + i) << program_.S.row(row), program_.b[row];
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> factor(kkt);
    if (!factor.isInvertible()) return;  // dependent rows: another set of them describes the region
    const Eigen::MatrixXd solution = factor.solve(right);

    Region region;
    region.K = solution.topLeftCorner(n, p);
    region.k = solution.col(p).head(n);
    // Rows a . theta <= c: signs of multipliers, then the rows of the program, then the parameters' set.
    std::vector<Eigen::VectorXd> rows;
    std::vector<double> bounds;
    for (Eigen::Index i = static_cast<Eigen::Index>(program_.equalities.size()); i < k; ++i) {
      rows.emplace_back(-solution.row(n + i).head(p).transpose());
      bounds.push_back(solution(n + i, p));
    }
    for (int row = 0; row < program_.rowCount(); ++row) {
      const Eigen::VectorXd slope = (program_.A.row(row) * region.K - program_.S.row(row)).transpose();
      const double bound = program_.b[row] - program_.A.row(row).dot(region.k);
      if (slope.cwiseProduct(half_).norm() < kLowerDimensional &&
          std::abs(bound - slope.dot(middle_)) < kLowerDimensional) {
        region.rows.push_back(row);
      } else {
        rows.push_back(slope);
        bounds.push_back(bound);
      }
    }
    for (Eigen::Index i = 0; i < program_.A_theta.rows(); ++i) {
      rows.emplace_back(program_.A_theta.row(i).transpose());
      bounds.push_back(program_.b_theta[i]);
    }
    if (!findCentre(rows, bounds, region)) return;
    regions_.emplace(region.rows, region);
  }

  // Chebyshev centre in t. False when the region is flatter than the least radius.
  bool findCentre(const std::vector<Eigen::VectorXd>& rows, const std::vector<double>& bounds,
                  Region& region) const {
    const Eigen::Index p = half_.size(), count = static_cast<Eigen::Index>(rows.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(count + 2 * p, p + 1);
    Eigen::VectorXd b = Eigen::VectorXd::Ones(A.rows());
    A.col(p).setOnes();
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::VectorXd& row = rows[static_cast<std::size_t>(i)];
      const Eigen::VectorXd scaled = row.cwiseProduct(half_);
      const double bound = bounds[static_cast<std::size_t>(i)] - row.dot(middle_);
      const double norm = scaled.norm();
      if (norm < kLowerDimensional) {  // does not depend on theta
        if (bound < -kLowerDimensional) return false;
        A.row(i).setZero();
        continue;
      }
      A.row(i).head(p) = scaled.transpose() / norm;
      b[i] = bound / norm;
    }
    A.block(count, 0, p, p).setIdentity();
    A.block(count + p, 0, p, p) = -Eigen::MatrixXd::Identity(p, p);
    Eigen::VectorXd cost = Eigen::VectorXd::Zero(p + 1);
    cost[p] = -1.0;
    const LpAnswer answer = solveByGlpk(cost, A, b);
    if (answer.status != GLP_OPT || answer.z[p] < least_radius_) return false;
    region.radius = answer.z[p];
    region.centre = middle_ + half_.cwiseProduct(answer.z.head(p));
    return true;
  }

  static constexpr double kLowerDimensional = 1e-10;  // numbers below this are zero

  const ParametricProgram& program_;
  const double least_radius_;
  std::vector<int> active_;
  Eigen::VectorXd half_, middle_;
  std::map<std::vector<int>, Region> regions_;
};

}  // namespace polyfly
