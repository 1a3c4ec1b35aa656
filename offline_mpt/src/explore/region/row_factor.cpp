#include "explore/region/row_factor.hpp"

#include <algorithm>
#include <cmath>

#include "explore/region/tolerances.hpp"
#include "mpc_core/decompositions.hpp"

namespace polyfly {

RowTables::RowTables(const NormalisedProgram& program)
    : m(static_cast<std::size_t>(program.m)),
      n(static_cast<std::size_t>(program.n)),
      width(static_cast<std::size_t>(program.p) + 1) {
  for (int i = 0; i < program.m; ++i) {
    for (int j = 0; j < program.m; ++j) gram.push_back(program.gram(i, j));
    for (int j = 0; j <= program.p; ++j) D.push_back(program.D(i, j));
    for (int j = 0; j < program.n; ++j) M.push_back(program.M(i, j));
    D_size.push_back(program.D.row(i).cwiseAbs().maxCoeff());
  }
}

bool RowFactor::factorise(const ActiveSet& active) {
  const std::size_t k = active.size();
  pivot_ = 1.0;
  if (k > tables_.n) return false;
  factor_.resize(k * k);
  inverse_.resize(k);
  for (std::size_t r = 0; r < k; ++r) {
    const double* source = tables_.products(active[r]);
    double* row = factor_.data() + r * k;
    for (std::size_t c = 0; c <= r; ++c) {
      const double* other = factor_.data() + c * k;
      double value = source[active[c]];
      for (std::size_t i = 0; i < c; ++i) value -= row[i] * other[i];
      if (c < r) {
        row[c] = value / other[c];
      } else if (value > tolerance::kSafePivot) {
        row[c] = std::sqrt(value);
        inverse_[c] = 1.0 / row[c];
      } else {
        return factoriseRows(active);
      }
    }
    pivot_ = std::min(pivot_, row[r]);
  }
  return true;
}

// The same factor from the rows themselves, orthogonalised twice: distances come out with full accuracy,
// where products of rows only keep their squares. Few sets need it.
bool RowFactor::factoriseRows(const ActiveSet& active) {
  const auto k = static_cast<Eigen::Index>(active.size());
  Eigen::MatrixXd basis(program_.n, k);
  pivot_ = 1.0;
  for (Eigen::Index r = 0; r < k; ++r) {
    const auto at = static_cast<std::size_t>(r);
    Eigen::VectorXd row = program_.M.row(active[at]);
    double* out = factor_.data() + at * active.size();
    std::fill(out, out + r, 0.0);
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index c = 0; c < r; ++c) {
        const double weight = basis.col(c).dot(row);
        out[c] += weight;
        row -= weight * basis.col(c);
      }
    }
    out[r] = row.norm();
    if (out[r] <= tolerance::kIndependent) return false;
    basis.col(r) = row / out[r];
    inverse_[at] = 1.0 / out[r];
    pivot_ = std::min(pivot_, out[r]);
  }
  return true;
}

void RowFactor::solve(double* x, std::size_t width) const {
  const std::size_t rows = inverse_.size();
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

// Into weights_, with the squared distance of `row` from the span, which is inaccurate if it is small.
void RowFactor::findWeights(const ActiveSet& active, int row, double& squared) {
  const std::size_t k = active.size();
  const double* products = tables_.products(row);
  weights_.resize(k);
  squared = products[row];
  for (std::size_t r = 0; r < k; ++r) {
    double value = products[active[r]];
    for (std::size_t c = 0; c < r; ++c) value -= factor_[r * k + c] * weights_[c];
    weights_[r] = value * inverse_[r];
    squared -= weights_[r] * weights_[r];
  }
  for (std::size_t r = k; r-- > 0;) {
    double value = weights_[r];
    for (std::size_t c = r + 1; c < k; ++c) value -= factor_[c * k + r] * weights_[c];
    weights_[r] = value * inverse_[r];
  }
}

// From the rows themselves: products of rows only keep the squares of their distances.
void RowFactor::refineWeights(const ActiveSet& active, int row) {
  Eigen::MatrixXd rows(program_.n, static_cast<Eigen::Index>(active.size()));
  for (std::size_t r = 0; r < active.size(); ++r)
    rows.col(static_cast<Eigen::Index>(r)) = program_.M.row(active[r]);
  const Eigen::VectorXd weights = PivotedQr(rows, 0.0).solve(Eigen::VectorXd(program_.M.row(row)));
  weights_.assign(weights.data(), weights.data() + weights.size());
}

bool RowFactor::depends(const ActiveSet& active, int row, bool is_sound) {
  const std::size_t k = active.size(), n = tables_.n;
  double squared = 0.0;
  findWeights(active, row, squared);
  // As many independent rows as variables span all there is, whatever rounding says.
  if (k == n) {
    if (!is_sound || pivot_ < tolerance::kSoundPivot) refineWeights(active, row);
    return true;
  }
  if (squared > tolerance::kSafePivot) return false;
  column_.assign(tables_.normal(row), tables_.normal(row) + n);
  for (std::size_t r = 0; r < k; ++r) {
    const double* other = tables_.normal(active[r]);
    for (std::size_t j = 0; j < n; ++j) column_[j] -= weights_[r] * other[j];
  }
  double left = 0.0;
  for (const double entry : column_) left += entry * entry;
  return left <= tolerance::kIndependent * tolerance::kIndependent;
}

}  // namespace polyfly
