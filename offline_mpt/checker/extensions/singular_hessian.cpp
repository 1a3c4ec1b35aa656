// Of several optima the shortest: linear programs, and programs whose H is singular.
#include <algorithm>

#include "core/linear_system.hpp"
#include "core/tags.hpp"
#include "extensions/extended_certificate.hpp"

namespace checker {

/// H = I without cost gives the shortest z. The cost alone, in a second group of right-hand sides, gives the cost
/// multipliers.
std::vector<Row> ExtendedCertificate::linearSystem(const std::vector<std::size_t>& rows) const {
  const std::size_t size = n_ + rows.size(), width = p_ + 1;
  std::vector<Row> system;
  for (std::size_t i = 0; i < size; ++i) {
    Vector equation(size + 2 * width);
    if (i < n_) {
      equation[i] = 1;
      for (std::size_t r = 0; r < rows.size(); ++r) equation[n_ + r] = data("A").at(rows[r], i);
      const Vector cost = affine("F", "f", i, 1);
      for (std::size_t j = 0; j < width; ++j) equation[size + width + j] = -cost[j];
    } else {
      for (std::size_t j = 0; j < n_; ++j) equation[j] = data("A").at(rows[i - n_], j);
      const Vector own = bound(rows[i - n_]);
      std::copy(own.begin(), own.end(), equation.begin() + static_cast<std::ptrdiff_t>(size));
    }
    system.push_back(primitive(equation));
  }
  return system;
}

/// Of a singular H, unknowns z, cost multipliers, multipliers, y:
/// H z + A'mu = -cost, A z = bound, H y + z + A'multiplier = 0, A y = 0.
std::vector<Row> ExtendedCertificate::limitSystem(const std::vector<std::size_t>& rows) const {
  const std::size_t k = rows.size(), size = 2 * (n_ + k), y = n_ + 2 * k;
  std::vector<Row> system;
  for (std::size_t i = 0; i < size; ++i) {
    Vector equation(size + p_ + 1);
    if (i < n_) {
      const Vector cost = affine("F", "f", i, 1);
      for (std::size_t j = 0; j < n_; ++j) equation[j] = hessian(i, j);
      for (std::size_t r = 0; r < k; ++r) equation[n_ + r] = data("A").at(rows[r], i);
      for (std::size_t j = 0; j <= p_; ++j) equation[size + j] = -cost[j];
    } else if (i < n_ + k) {
      for (std::size_t j = 0; j < n_; ++j) equation[j] = data("A").at(rows[i - n_], j);
      const Vector own = bound(rows[i - n_]);
      std::copy(own.begin(), own.end(), equation.begin() + static_cast<std::ptrdiff_t>(size));
    } else if (i < 2 * n_ + k) {
      const std::size_t own = i - n_ - k;
      equation[own] = 1;
      for (std::size_t r = 0; r < k; ++r) equation[n_ + k + r] = data("A").at(rows[r], own);
      for (std::size_t j = 0; j < n_; ++j) equation[y + j] = hessian(own, j);
    } else {
      for (std::size_t j = 0; j < n_; ++j) equation[y + j] = data("A").at(rows[i - 2 * n_ - k], j);
    }
    system.push_back(primitive(equation));
  }
  return system;
}

Optimum ExtendedCertificate::optimum(const std::vector<std::size_t>& rows) const {
  if (!isLinear() && !isSingular()) return Certificate::optimum(rows);
  const std::size_t count = rows.size(), width = p_ + 1;
  std::vector<Row> system = isLinear() ? linearSystem(rows) : limitSystem(rows);
  const std::size_t size = system.size();
  Optimum result;
  result.determinant = solveSystem(system, isLinear() ? size : n_ + 2 * count);
  const auto part = [&](std::size_t unknown, std::size_t group) {
    const auto first = system[unknown].begin() + static_cast<std::ptrdiff_t>(size + group * width);
    return Row(first, first + static_cast<std::ptrdiff_t>(width));
  };
  const auto is_zero = [](const Row& row) {
    return std::all_of(row.begin(), row.end(), [](const Integer& value) { return value == 0; });
  };
  for (std::size_t i = 0; i < n_; ++i) {
    result.z.push_back(part(i, 0));
    require(!isLinear() || is_zero(part(i, 1)), "the cost is not in the span of the active rows");
  }
  // Where the cost multiplier of a row is identically zero, the other one decides.
  for (std::size_t r = basis_.size(); r < count; ++r) {
    const Row of_cost = isLinear() ? part(n_ + r, 1) : part(n_ + r, 0);
    const Row of_length = isLinear() ? part(n_ + r, 0) : part(n_ + count + r, 0);
    const bool by_cost = !is_zero(of_cost);
    result.multipliers[tag::origin(by_cost ? tag::kCostMultiplier : tag::kMultiplier, rows[r])] =
        primitive(by_cost ? of_cost : of_length);
  }
  return result;
}

}  // namespace checker
