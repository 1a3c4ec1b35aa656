#include "explore/region/double_double_region.hpp"

#include <algorithm>
#include <limits>

#include "arithmetic/tolerances.hpp"
#include "explore/region/tolerances.hpp"

namespace polyfly {
namespace {

DoubleDouble dot(const DoubleDouble* a, const DoubleDouble* b, std::size_t count) {
  DoubleDouble sum;
  for (std::size_t i = 0; i < count; ++i) sum += a[i] * b[i];
  return sum;
}

/// target += weight * source
void addMultiple(const DoubleDouble& weight, const DoubleDouble* source, std::size_t count,
                 DoubleDouble* target) {
  for (std::size_t j = 0; j < count; ++j) target[j] += weight * source[j];
}

void divide(const DoubleDouble& divisor, std::size_t count, DoubleDouble* target) {
  for (std::size_t j = 0; j < count; ++j) target[j] = target[j] / divisor;
}

void round(const DoubleDouble* numbers, std::size_t count, double* out) {
  for (std::size_t j = 0; j < count; ++j) out[j] = numbers[j].high;
}

/// x := L^-1 x of `width` right-hand sides that lie side by side.
void solveLower(const std::vector<DoubleDouble>& L, std::size_t size, std::size_t width, DoubleDouble* x) {
  for (std::size_t r = 0; r < size; ++r) {
    DoubleDouble* row = x + r * width;
    for (std::size_t c = 0; c < r; ++c) addMultiple(-L[r * size + c], x + c * width, width, row);
    divide(L[r * size + r], width, row);
  }
}

}  // namespace

DoubleDoubleRegionSolver::DoubleDoubleRegionSolver(const NormalisedProgram& reduced)
    : n_(static_cast<std::size_t>(reduced.source.variableCount())),
      width_(static_cast<std::size_t>(reduced.p) + 1) {
  if (reduced.linear || !reduced.source.equalities.empty()) return;
  form_ = identityForm(affineInBox(reduced.source));
  for (int i = 0; form_ && i < reduced.m; ++i) {
    const Eigen::Index id = reduced.row_ids[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < form_->rows.cols(); ++j) rows_.push_back(form_->rows(id, j));
    for (Eigen::Index j = 0; j < form_->slack.cols(); ++j) bounds_.push_back(form_->slack(id, j));
  }
}

bool DoubleDoubleRegionSolver::solve(const std::vector<std::uint16_t>& active) {
  if (!form_ || active.size() > n_ || !factorise(active)) return false;
  solveFactor(active);
  point_.assign(n_ * width_, {});
  for (std::size_t r = 0; r < active.size(); ++r) {
    const DoubleDouble* row = rows_.data() + active[r] * n_;
    for (std::size_t i = 0; i < n_; ++i)
      addMultiple(row[i], multipliers_.data() + r * width_, width_, point_.data() + i * width_);
  }
  return true;
}

bool DoubleDoubleRegionSolver::factorise(const std::vector<std::uint16_t>& active) {
  const std::size_t k = active.size();
  factor_.assign(k * k, {});
  double least = 1.0;
  for (std::size_t r = 0; r < k; ++r) {
    DoubleDouble* row = factor_.data() + r * k;
    for (std::size_t c = 0; c <= r; ++c) {
      const DoubleDouble* other = factor_.data() + c * k;
      const DoubleDouble product = dot(rows_.data() + active[r] * n_, rows_.data() + active[c] * n_, n_);
      const DoubleDouble value = product - dot(row, other, c);
      if (c == r) least = std::min(least, value.high);
      row[c] = c < r ? value / other[c] : sqrt(value);
    }
    const double error = tolerance::kErrorOfSums * static_cast<double>(n_) * form_->root_condition *
                         tolerance::kDoubleDoubleRounding;
    if (error > tolerance::kTrustedMultipliers * least) return false;
  }
  return true;
}

// Multipliers: products lambda = -D_active.
void DoubleDoubleRegionSolver::solveFactor(const std::vector<std::uint16_t>& active) {
  const std::size_t k = active.size();
  multipliers_.resize(k * width_);
  for (std::size_t r = 0; r < k; ++r) {
    DoubleDouble* row = multipliers_.data() + r * width_;
    std::copy_n(bounds_.data() + active[r] * width_, width_, row);
    for (std::size_t j = 0; j < width_; ++j) row[j] = -row[j];
  }
  solveLower(factor_, k, width_, multipliers_.data());
  for (std::size_t r = k; r-- > 0;) {
    DoubleDouble* row = multipliers_.data() + r * width_;
    for (std::size_t c = r + 1; c < k; ++c)
      addMultiple(-factor_[c * k + r], multipliers_.data() + c * width_, width_, row);
    divide(factor_[r * k + r], width_, row);
  }
}

void DoubleDoubleRegionSolver::multiplier(std::size_t place, double* affine) const {
  round(multipliers_.data() + place * width_, width_, affine);
}

void DoubleDoubleRegionSolver::slack(int row, double* affine) const {
  const auto at = static_cast<std::size_t>(row);
  Numbers value(bounds_.begin() + static_cast<std::ptrdiff_t>(at * width_),
                bounds_.begin() + static_cast<std::ptrdiff_t>((at + 1) * width_));
  for (std::size_t i = 0; i < n_; ++i)
    addMultiple(rows_[at * n_ + i], point_.data() + i * width_, width_, value.data());
  round(value.data(), width_, affine);
}

void DoubleDoubleRegionSolver::law(std::vector<double>& out) const {
  out.clear();
  Numbers value(width_);
  for (Eigen::Index r = 0; r < form_->law.rows(); ++r) {
    for (std::size_t j = 0; j < width_; ++j) value[j] = form_->law(r, static_cast<Eigen::Index>(j));
    for (std::size_t i = 0; i < n_; ++i)
      addMultiple(-form_->output(r, static_cast<Eigen::Index>(i)), point_.data() + i * width_, width_,
                  value.data());
    for (const DoubleDouble& number : value) out.push_back(number.high);
  }
}

}  // namespace polyfly
