// The KKT system of an active set: multipliers of its rows as functions of the parameters.
#include <algorithm>
#include <cmath>

#include "explore/region/region_builder.hpp"
#include "explore/region/tolerances.hpp"

namespace polyfly {

bool RegionBuilder::factorise(const ActiveSet& active) {
  const int k = static_cast<int>(active.size());
  if (k > program_.n) return false;
  factor_.resize(static_cast<std::size_t>(k) * k);
  inverse_.resize(k);
  for (int r = 0; r < k; ++r) {
    const double* source = gram_.data() + static_cast<std::size_t>(active[r]) * program_.m;
    double* row = factor_.data() + static_cast<std::size_t>(r) * k;
    for (int c = 0; c <= r; ++c) {
      const double* other = factor_.data() + static_cast<std::size_t>(c) * k;
      double value = source[active[c]];
      for (int i = 0; i < c; ++i) value -= row[i] * other[i];
      if (c < r) {
        row[c] = value / other[c];
      } else if (value > tolerance::kSafePivot) {
        row[c] = std::sqrt(value);
        inverse_[c] = 1.0 / row[c];
      } else {
        return factoriseAccurately(active);
      }
    }
  }
  return true;
}

// The same factor from the rows themselves, orthogonalised twice: distances come out with full accuracy,
// where products of rows only keep their squares. Few sets need it.
bool RegionBuilder::factoriseAccurately(const ActiveSet& active) {
  const int k = static_cast<int>(active.size());
  Eigen::MatrixXd basis(program_.n, k);
  for (int r = 0; r < k; ++r) {
    Eigen::VectorXd row = program_.M.row(active[r]);
    double* out = factor_.data() + static_cast<std::size_t>(r) * k;
    std::fill(out, out + r, 0.0);
    for (int pass = 0; pass < 2; ++pass) {
      for (int c = 0; c < r; ++c) {
        const double weight = basis.col(c).dot(row);
        out[c] += weight;
        row -= weight * basis.col(c);
      }
    }
    out[r] = row.norm();
    if (out[r] <= tolerance::kIndependent) return false;
    basis.col(r) = row / out[r];
    inverse_[r] = 1.0 / out[r];
  }
  return true;
}

// Solves factor factor' X = X in place for `width` right-hand sides lying side by side.
void RegionBuilder::solveFactor(double* x, std::size_t rows, std::size_t width) const {
  for (std::size_t r = 0; r < rows; ++r) {
    double* row = x + r * width;
    for (std::size_t c = 0; c < r; ++c) {
      const double weight = factor_[r * rows + c];
      for (std::size_t j = 0; j < width; ++j) row[j] -= weight * x[c * width + j];
    }
    for (std::size_t j = 0; j < width; ++j) row[j] *= inverse_[r];
  }
  for (std::size_t r = rows; r-- > 0;) {
    double* row = x + r * width;
    for (std::size_t c = r + 1; c < rows; ++c) {
      const double weight = factor_[c * rows + r];
      for (std::size_t j = 0; j < width; ++j) row[j] -= weight * x[c * width + j];
    }
    for (std::size_t j = 0; j < width; ++j) row[j] *= inverse_[r];
  }
}

// Multipliers of the active rows as functions of (t, 1), and the size of their constants and slopes. False
// where the rows are dependent.
bool RegionBuilder::findMultipliers(const ActiveSet& active, double& scale) {
  multipliers_.resize(active.size() * width_);
  pivot_ = 1.0;
  if (!is_accurate_ && !factorise(active)) return false;
  scale = 1.0;
  for (std::size_t r = 0; r < active.size(); ++r) {
    for (int j = 0; j < width_; ++j) {
      const double value = -D_[static_cast<std::size_t>(active[r]) * width_ + j];
      multipliers_[r * width_ + j] = value;
      scale = std::max(scale, std::abs(value));
    }
  }
  if (is_accurate_) {
    for (std::size_t r = 0; r < active.size(); ++r) accurate_.multiplier(r, multipliers_.data() + r * width_);
    return true;
  }
  if (program_.semidefinite) {
    if (!findShortest(active)) return false;
  } else {
    solveFactor(multipliers_.data(), active.size(), width_);
  }
  size_ = 0.0;
  for (const double value : multipliers_) size_ = std::max(size_, std::abs(value));
  for (std::size_t r = 0; r < active.size(); ++r) pivot_ = std::min(pivot_, factor_[r * active.size() + r]);
  return true;
}

// The same where H is singular and not zero.
bool RegionBuilder::findShortest(const ActiveSet& active) {
  const ShortestOptimum::Outcome outcome = shortest_.solve(active);
  doubtful_ = doubtful_ || shortest_.doubtful();
  cost_spanned_ = outcome != ShortestOptimum::Outcome::kCostNotSpanned;
  if (outcome == ShortestOptimum::Outcome::kDependent) return false;
  for (std::size_t r = 0; cost_spanned_ && r < active.size(); ++r)
    shortest_.multiplier(r, multipliers_.data() + r * width_);
  return true;
}

// What rounding does to multipliers and cost multipliers, relative to their size.
double RegionBuilder::growth() const {
  return program_.semidefinite ? shortest_.noise() : program_.rounding / pivot_;
}

// Cost multipliers of the active rows, -gram^-1 M cost. False unless the cost is in their span and none is negative
// everywhere.
bool RegionBuilder::findCostMultipliers(const ActiveSet& active) {
  const auto k = static_cast<Eigen::Index>(active.size());
  cost_multipliers_.resize(multipliers_.size());
  if (is_accurate_) {
    for (std::size_t r = 0; r < active.size(); ++r)
      accurate_.costMultiplier(r, cost_multipliers_.data() + r * width_);
    return true;
  }
  if (program_.semidefinite) {
    for (std::size_t r = 0; cost_spanned_ && r < active.size(); ++r)
      shortest_.costMultiplier(r, cost_multipliers_.data() + r * width_);
    return cost_spanned_;
  }
  for (Eigen::Index r = 0; r < k; ++r) {
    for (int j = 0; j < width_; ++j)
      cost_multipliers_[r * width_ + j] = -program_.M.row(active[r]).dot(program_.cost.col(j));
  }
  solveFactor(cost_multipliers_.data(), active.size(), width_);
  const double scale = program_.cost.cwiseAbs().maxCoeff();
  Eigen::MatrixXd rest = program_.cost;
  for (Eigen::Index r = 0; r < k; ++r) {
    for (int j = 0; j < width_; ++j)
      rest.col(j) += cost_multipliers_[r * width_ + j] * program_.M.row(active[r]).transpose();
  }
  double greatest = 0.0;
  for (const double cost_multiplier : cost_multipliers_)
    greatest = std::max(greatest, std::abs(cost_multiplier));
  if (tolerance::kErrorMargin * growth() * greatest > tolerance::kCostResidual * scale) doubtful_ = true;
  return rest.cwiseAbs().maxCoeff() <= tolerance::kCostResidual * scale;
}

}  // namespace polyfly
