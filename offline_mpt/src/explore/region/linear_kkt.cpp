#include "explore/region/linear_kkt.hpp"

#include <algorithm>
#include <cmath>

#include "explore/region/tolerances.hpp"
#include "mpc_core/decompositions.hpp"

namespace polyfly {

LinearKktSolver::LinearKktSolver(const NormalisedProgram& program, const RowTables& tables,
                                 const RowFactor& factor)
    : ConvexKktSolver(program, tables, factor),
      scale_(program.cost.lpNorm<Eigen::Infinity>()),
      constant_costs_(program.constantCost()) {}

KktSolver::Outcome LinearKktSolver::solve(const ActiveSet& active) {
  ConvexKktSolver::solve(active);
  const std::size_t width = tables_.width;
  const Eigen::MatrixXd& cost = program_.cost;
  cost_multipliers_.resize(active.size() * width);
  for (std::size_t r = 0; r < active.size(); ++r) {
    for (std::size_t j = 0; j < width; ++j)
      cost_multipliers_[r * width + j] =
          -program_.M.row(active[r]).dot(cost.col(static_cast<Eigen::Index>(j)));
  }
  factor_.solve(cost_multipliers_.data(), width);
  Eigen::MatrixXd rest = cost;
  const double zero = tolerance::kCostResidual * scale_;
  double greatest = 0.0;
  is_open_ = static_cast<int>(active.size()) < program_.n;
  for (std::size_t r = 0; r < active.size(); ++r) {
    double largest = 0.0;
    for (std::size_t j = 0; j < width; ++j) {
      const double cost_multiplier = cost_multipliers_[r * width + j];
      rest.col(static_cast<Eigen::Index>(j)) += cost_multiplier * program_.M.row(active[r]).transpose();
      largest = std::max(largest, std::abs(cost_multiplier));
    }
    greatest = std::max(greatest, largest);
    is_open_ = is_open_ || largest <= zero;
  }
  doubtful_ = tolerance::kErrorMargin * noise() * greatest > zero;
  return rest.lpNorm<Eigen::Infinity>() <= zero ? Outcome::kSolved : Outcome::kNoOptimum;
}

void LinearKktSolver::costMultiplier(std::size_t place, double* affine) const {
  std::copy_n(cost_multipliers_.data() + place * tables_.width, tables_.width, affine);
}

CostScale LinearKktSolver::costScale() const { return {scale_, tolerance::kCostResidual * scale_}; }

bool LinearKktSolver::crossCostFacet(const ActiveSet& active, int leaving, ActiveSetList& sets) const {
  ActiveSet kept = active;
  kept.erase(std::remove(kept.begin(), kept.end(), leaving), kept.end());
  Eigen::VectorXd direction = -program_.M.row(leaving);
  Eigen::MatrixXd basis(program_.n, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t r = 0; r < kept.size(); ++r)
    basis.col(static_cast<Eigen::Index>(r)) = program_.M.row(kept[r]);
  if (!kept.empty()) direction -= basis * PivotedQr(basis).solve(direction);
  const std::size_t before = sets.size();
  for (int i = 0; i < program_.m; ++i) {
    if (program_.M.row(i).dot(direction) > tolerance::kExchangeWeight)
      sets.push({kept.data(), kept.size()}, ActiveSetList::kNone, i);
  }
  return sets.size() > before;
}

}  // namespace polyfly
