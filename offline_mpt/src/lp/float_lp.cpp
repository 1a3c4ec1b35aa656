#include "lp/float_lp.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "lp/tolerances.hpp"

namespace polyfly {
namespace {

// Beyond it, what is exact must do without a guess. Programs that are explored need far fewer (kMostParameters).
constexpr int kMaxDimension = 32;

using Square =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxDimension, kMaxDimension>;
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxDimension, 1>;

}  // namespace

void FloatLp::add(const std::vector<double>& a_b) { rows_.insert(rows_.end(), a_b.begin(), a_b.end()); }

void FloatLp::coefficients(int row, double* a, double& b) const {
  if (row < count()) {
    const double* source = rows_.data() + static_cast<std::ptrdiff_t>(row) * (dimension_ + 1);
    std::copy_n(source, dimension_, a);
    b = source[dimension_];
    return;
  }
  std::fill(a, a + dimension_, 0.0);
  a[(row - count()) / 2] = (row - count()) % 2 == 0 ? 1.0 : -1.0;
  b = 1.0;
}

int FloatLp::mostViolated() const {
  int worst_row = -1;
  double worst = tolerance::kEnteringViolation;
  const auto consider = [&](int row, double violation) {
    if (violation <= worst || std::find(basis_.begin(), basis_.end(), row) != basis_.end()) return;
    worst = violation;
    worst_row = row;
  };
  for (int i = 0; i < count(); ++i) {
    const double* row = rows_.data() + static_cast<std::ptrdiff_t>(i) * (dimension_ + 1);
    double violation = -row[dimension_];
    for (int j = 0; j < dimension_; ++j) violation += row[j] * x_[j];
    consider(i, violation);
  }
  for (int j = 0; j < dimension_; ++j) {
    consider(boxIndex(2 * j), x_[j] - 1.0);
    consider(boxIndex(2 * j + 1), -x_[j] - 1.0);
  }
  return worst_row;
}

// Dual simplex: a basis of as many rows as dimensions, first the box's corner farthest along c. The most
// violated row enters; the one whose weight vanishes first leaves.
FloatLp::Status FloatLp::maximise(const std::vector<double>& c) {
  const int d = dimension_;
  basis_.clear();
  weights_.clear();
  if (d > kMaxDimension) return Status::kFailed;
  Square rows(d, d);  // one basic row per column
  Column bounds(d), weights(d), entering(d);
  for (int j = 0; j < d; ++j) {
    basis_.push_back(boxIndex(c[j] >= 0.0 ? 2 * j : 2 * j + 1));
    coefficients(basis_[j], rows.col(j).data(), bounds(j));
    weights(j) = std::abs(c[j]);
  }
  const Column direction = Eigen::Map<const Eigen::VectorXd>(c.data(), d);
  const int limit = 50 + 10 * (count() + d);
  for (int iteration = 0; iteration < limit; ++iteration) {
    const Eigen::PartialPivLU<Square> factor(rows);
    const Column x = factor.transpose().solve(bounds);
    weights = factor.solve(direction);
    x_.assign(x.data(), x.data() + d);
    if (!x.allFinite()) return Status::kFailed;  // a basis that is singular in doubles
    const int row = mostViolated();
    weights_.clear();
    if (row < 0) {
      for (int j = 0; j < d; ++j) {
        if (weights(j) > 0.0) weights_.emplace_back(basis_[j], weights(j));
      }
      objective_ = direction.dot(x);
      return Status::kOptimal;
    }
    double bound = 0.0;
    coefficients(row, entering.data(), bound);
    const Column share = factor.solve(entering);
    int leaving = -1;
    double least = 0.0;
    for (int j = 0; j < d; ++j) {
      if (share(j) <= tolerance::kLeavingWeight) continue;
      const double ratio = std::max(weights(j), 0.0) / share(j);
      if (leaving >= 0 && (ratio > least || (ratio == least && share(j) <= share(leaving)))) continue;
      leaving = j;
      least = ratio;
    }
    if (leaving < 0) {
      weights_.emplace_back(row, 1.0);
      for (int j = 0; j < d; ++j) {
        if (share(j) < 0.0) weights_.emplace_back(basis_[j], -share(j));
      }
      return Status::kInfeasible;
    }
    ++pivots_;
    basis_[leaving] = row;
    rows.col(leaving) = entering;
    bounds(leaving) = bound;
  }
  return Status::kFailed;
}

}  // namespace polyfly
