#include "explore/region/double_double_region.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "arithmetic/tolerances.hpp"
#include "explore/region/tolerances.hpp"

namespace polyfly {

DoubleDoubleRegionSolver::DoubleDoubleRegionSolver(const NormalisedProgram& reduced)
    : n_(reduced.source.variableCount()) {
  if (reduced.linear || !reduced.source.equalities.empty()) return;
  form_ = identityForm(affineInBox(reduced.source));
  if (!form_) return;
  rows_.resize(reduced.m, form_->rows.cols());
  bounds_.resize(reduced.m, form_->slack.cols());
  for (int i = 0; i < reduced.m; ++i) {
    const Eigen::Index id = reduced.row_ids[static_cast<std::size_t>(i)];
    rows_.row(i) = form_->rows.row(id);
    bounds_.row(i) = form_->slack.row(id);
  }
}

// Multipliers: products lambda = -D_active.
bool DoubleDoubleRegionSolver::solve(const std::vector<std::uint16_t>& active) {
  const auto k = static_cast<Eigen::Index>(active.size());
  if (!form_ || k > n_) return false;
  WideMatrix rows(k, rows_.cols()), right(k, bounds_.cols());
  for (Eigen::Index r = 0; r < k; ++r) {
    rows.row(r) = rows_.row(active[static_cast<std::size_t>(r)]);
    right.row(r) = -bounds_.row(active[static_cast<std::size_t>(r)]);
  }
  multipliers_ = right;
  if (k > 0) {
    const Eigen::LLT<WideMatrix> factor(rows * rows.transpose());
    const WideMatrix L = factor.matrixL();
    const double least = std::min(1.0, rounded(L).diagonal().cwiseAbs2().minCoeff());
    const double error = tolerance::kErrorOfSums * static_cast<double>(n_) * form_->root_condition *
                         tolerance::kDoubleDoubleRounding;
    if (factor.info() != Eigen::Success || error > tolerance::kTrustedMultipliers * least) return false;
    factor.solveInPlace(multipliers_);
  }
  point_ = rows.transpose() * multipliers_;
  return true;
}

void DoubleDoubleRegionSolver::multiplier(std::size_t place, double* affine) const {
  const auto row = static_cast<Eigen::Index>(place);
  Eigen::Map<Eigen::RowVectorXd>(affine, multipliers_.cols()) = multipliers_.row(row).cast<double>();
}

void DoubleDoubleRegionSolver::slack(int row, double* affine) const {
  const WideMatrix value = bounds_.row(row) + rows_.row(row) * point_;
  Eigen::Map<Eigen::RowVectorXd>(affine, value.cols()) = value.cast<double>();
}

void DoubleDoubleRegionSolver::law(std::vector<double>& out) const {
  const WideMatrix law = form_->law - form_->output * point_;
  out.resize(static_cast<std::size_t>(law.size()));
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      out.data(), law.rows(), law.cols()) = law.cast<double>();
}

}  // namespace polyfly
