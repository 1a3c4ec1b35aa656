// Linear programs: of several optima the shortest.
#include <algorithm>

#include "core/linear_system.hpp"
#include "core/tags.hpp"
#include "extensions/extended_certificate.hpp"

namespace checker {

/// H of the weights without cost gives the shortest z. The cost alone, in a second group of right-hand sides, gives the cost
/// multipliers.
std::vector<Row> ExtendedCertificate::linearSystem(const std::vector<std::size_t>& rows) const {
  const std::size_t size = n_ + rows.size(), width = p_ + 1;
  std::vector<Row> system;
  for (std::size_t i = 0; i < size; ++i) {
    Vector equation(size + 2 * width);
    if (i < n_) {
      equation[i] = weights_.empty() ? Integer(1) : Integer(1) << weights_[i];
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

Optimum ExtendedCertificate::optimum(const std::vector<std::size_t>& rows) const {
  if (!isLinear()) return Certificate::optimum(rows);
  const std::size_t count = rows.size(), width = p_ + 1;
  std::vector<Row> system = linearSystem(rows);
  const std::size_t size = system.size();
  Optimum result;
  result.determinant = solveSystem(system, size);
  const auto part = [&](std::size_t unknown, std::size_t group) {
    const auto first = system[unknown].begin() + static_cast<std::ptrdiff_t>(size + group * width);
    return Row(first, first + static_cast<std::ptrdiff_t>(width));
  };
  const auto is_zero = [](const Row& row) {
    return std::all_of(row.begin(), row.end(), [](const Integer& value) { return value == 0; });
  };
  for (std::size_t i = 0; i < n_; ++i) {
    result.z.push_back(part(i, 0));
    require(is_zero(part(i, 1)), "the cost is not in the span of the active rows");
  }
  // Where the cost multiplier of a row is identically zero, the other one decides.
  for (std::size_t r = basis_.size(); r < count; ++r) {
    const Row of_cost = part(n_ + r, 1);
    const Row of_length = part(n_ + r, 0);
    const bool by_cost = !is_zero(of_cost);
    result.multipliers[tag::origin(by_cost ? tag::kCostMultiplier : tag::kMultiplier, rows[r])] =
        primitive(by_cost ? of_cost : of_length);
  }
  return result;
}

}  // namespace checker
