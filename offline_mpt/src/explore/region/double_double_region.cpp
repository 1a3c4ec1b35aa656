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

/// M theta + v of one row, in t: M half .* t + (M centre + v), over `unit`.
void layAffine(const Eigen::MatrixXd& M, const Eigen::VectorXd& v, Eigen::Index row, double unit,
               const std::vector<DoubleDouble>& centre, const std::vector<DoubleDouble>& half,
               DoubleDouble* out) {
  DoubleDouble constant = v(row);
  for (std::size_t j = 0; j < half.size(); ++j) {
    const DoubleDouble entry = M(row, static_cast<Eigen::Index>(j));
    out[j] = entry * half[j];
    constant += entry * centre[j];
  }
  out[half.size()] = constant;
  divide(unit, half.size() + 1, out);
}

}  // namespace

DoubleDoubleRegionSolver::DoubleDoubleRegionSolver(const NormalisedProgram& reduced)
    : reduced_(reduced),
      n_(static_cast<std::size_t>(reduced.source.variableCount())),
      width_(static_cast<std::size_t>(reduced.p) + 1) {
  if (reduced.linear || reduced.semidefinite || !reduced.source.equalities.empty()) return;
  usable_ = factoriseHessian();
  if (!usable_) return;
  Numbers centre, half;
  for (const Signal& parameter : reduced.source.parameters) {
    centre.push_back(exactSum(parameter.upper, parameter.lower) * 0.5);
    half.push_back(exactSum(parameter.upper, -parameter.lower) * 0.5);
  }
  layCost(centre, half);
  layRows(centre, half);
  layOutputs(centre, half);
}

bool DoubleDoubleRegionSolver::factoriseHessian() {
  const Eigen::MatrixXd& H = reduced_.source.H;
  root_.assign(n_ * n_, {});
  double least = std::numeric_limits<double>::infinity(), greatest = 0.0;
  for (std::size_t r = 0; r < n_; ++r) {
    DoubleDouble* row = root_.data() + r * n_;
    for (std::size_t c = 0; c <= r; ++c) {
      const auto i = static_cast<Eigen::Index>(r), j = static_cast<Eigen::Index>(c);
      const DoubleDouble* other = root_.data() + c * n_;
      const DoubleDouble value = exactSum(0.5 * H(i, j), 0.5 * H(j, i)) - dot(row, other, c);
      row[c] = c < r ? value / other[c] : sqrt(value);
    }
    if (row[r].high <= 0.0) return false;
    least = std::min(least, row[r].high);
    greatest = std::max(greatest, row[r].high);
  }
  root_condition_ = greatest / least;
  return true;
}

void DoubleDoubleRegionSolver::layCost(const Numbers& centre, const Numbers& half) {
  const ParametricProgram& program = reduced_.source;
  free_.resize(n_ * width_);
  for (std::size_t i = 0; i < n_; ++i)
    layAffine(program.F, program.f, static_cast<Eigen::Index>(i), 1.0, centre, half,
              free_.data() + i * width_);
  solveLower(root_, n_, width_, free_.data());
}

void DoubleDoubleRegionSolver::layRows(const Numbers& centre, const Numbers& half) {
  const ParametricProgram& program = reduced_.source;
  const auto m = static_cast<std::size_t>(reduced_.m);
  rows_.resize(m * n_);
  bounds_.resize(m * width_);
  for (std::size_t i = 0; i < m; ++i) {
    const Eigen::Index id = reduced_.row_ids[i];
    const double length = reduced_.length(static_cast<Eigen::Index>(i));
    DoubleDouble* row = rows_.data() + i * n_;
    for (std::size_t j = 0; j < n_; ++j) row[j] = program.A(id, static_cast<Eigen::Index>(j));
    divide(length, n_, row);
    solveLower(root_, n_, 1, row);
    layAffine(program.S, program.b, id, length, centre, half, bounds_.data() + i * width_);
  }
}

void DoubleDoubleRegionSolver::layOutputs(const Numbers& centre, const Numbers& half) {
  const ParametricProgram& program = reduced_.source;
  const auto q = static_cast<std::size_t>(program.inputCount());
  outputs_.resize(q * n_);
  offsets_.resize(q * width_);
  for (std::size_t i = 0; i < q; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    DoubleDouble* output = outputs_.data() + i * n_;
    for (std::size_t j = 0; j < n_; ++j) output[j] = program.E(row, static_cast<Eigen::Index>(j));
    solveLower(root_, n_, 1, output);
    layAffine(program.C, program.c, row, 1.0, centre, half, offsets_.data() + i * width_);
  }
}

bool DoubleDoubleRegionSolver::solve(const std::vector<std::uint16_t>& active) {
  if (!usable_ || active.size() > n_ || !factorise(active)) return false;
  solveFactor(active);
  point_ = free_;
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
    const double error = tolerance::kErrorOfSums * static_cast<double>(n_) * root_condition_ *
                         tolerance::kDoubleDoubleRounding;
    if (error > tolerance::kTrustedMultipliers * least) return false;
  }
  return true;
}

// Multipliers: products lambda = -(s + m_active L^-1 cost).
void DoubleDoubleRegionSolver::solveFactor(const std::vector<std::uint16_t>& active) {
  const std::size_t k = active.size();
  multipliers_.resize(k * width_);
  for (std::size_t r = 0; r < k; ++r) {
    DoubleDouble* row = multipliers_.data() + r * width_;
    std::copy_n(bounds_.data() + active[r] * width_, width_, row);
    for (std::size_t i = 0; i < n_; ++i)
      addMultiple(rows_[active[r] * n_ + i], free_.data() + i * width_, width_, row);
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
  Numbers value = offsets_;
  const std::size_t q = offsets_.size() / width_;
  for (std::size_t r = 0; r < q; ++r) {
    for (std::size_t i = 0; i < n_; ++i)
      addMultiple(-outputs_[r * n_ + i], point_.data() + i * width_, width_, value.data() + r * width_);
  }
  out.resize(value.size());
  round(value.data(), value.size(), out.data());
}

}  // namespace polyfly
