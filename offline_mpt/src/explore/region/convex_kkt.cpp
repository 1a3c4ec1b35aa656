#include "explore/region/convex_kkt.hpp"

#include <algorithm>
#include <cmath>

#include "explore/region/tolerances.hpp"

namespace polyfly {

ConvexKktSolver::ConvexKktSolver(const NormalisedProgram& program, const RowTables& tables,
                                 const RowFactor& factor)
    : program_(program), tables_(tables), factor_(factor) {
  for (int i = 0; i < program.U.rows(); ++i) U_size_.push_back(program.U.row(i).cwiseAbs().maxCoeff());
}

KktSolver::Outcome ConvexKktSolver::solve(const ActiveSet& active) {
  active_ = active;
  multipliers_.resize(active.size() * tables_.width);
  double* multiplier = multipliers_.data();
  for (const int row : active) {
    const double* bound = tables_.bound(row);
    multiplier = std::transform(bound, bound + tables_.width, multiplier, [](double x) { return -x; });
  }
  factor_.solve(multipliers_.data(), tables_.width);
  size_ = 0.0;
  for (const double value : multipliers_) size_ = std::max(size_, std::abs(value));
  return Outcome::kSolved;
}

void ConvexKktSolver::multiplier(std::size_t place, double* affine) const {
  std::copy_n(multipliers_.data() + place * tables_.width, tables_.width, affine);
}

void ConvexKktSolver::slack(int row, double* affine) const {
  const std::size_t width = tables_.width;
  const double* products = tables_.products(row);
  std::copy_n(tables_.bound(row), width, affine);
  const double* multiplier = multipliers_.data();
  for (const int other : active_) {
    const double weight = products[other];
    for (std::size_t j = 0; j < width; ++j) affine[j] += weight * multiplier[j];
    multiplier += width;
  }
}

double ConvexKktSolver::constantSlack() const { return tolerance::kConstantRow; }

double ConvexKktSolver::law(std::vector<double>& out) const {
  const std::size_t width = tables_.width;
  double error = 0.0;
  out.resize(U_size_.size() * width);
  for (std::size_t i = 0; i < U_size_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    double* row = out.data() + i * width;
    double size = 1.0, weights = 0.0;
    for (std::size_t j = 0; j < width; ++j) row[j] = program_.U(at, static_cast<Eigen::Index>(j));
    const double* multiplier = multipliers_.data();
    for (const int other : active_) {
      const double weight = program_.V(at, other);
      weights = std::max(weights, std::abs(weight));
      for (std::size_t j = 0; j < width; ++j) row[j] += weight * multiplier[j];
      multiplier += width;
    }
    for (std::size_t j = 0; j < width; ++j) size = std::max(size, std::abs(row[j]));
    error = std::max(error, program_.rounding * (U_size_[i] + weights * size_) / size);
  }
  return error;
}

}  // namespace polyfly
