#include <algorithm>

#include "certificate.hpp"

namespace checker {
namespace {

constexpr unsigned long kDroppedBits = 30, kForgivenBits = 40;

/// Solves the square system in place, without fractions; its last columns then are determinant * solution.
/// Unknowns from `required` on may be left free, and are zero then; the others must be unique.
Integer solve(std::vector<Row>& system, std::size_t required) {
  const std::size_t size = system.size();
  Integer previous(1);
  // The unknown that each row determines.
  std::vector<std::size_t> unknown_of;
  for (std::size_t column = 0; column < size; ++column) {
    const std::size_t k = unknown_of.size();
    std::size_t pivot = size;
    for (std::size_t i = k; i < size; ++i) {
      if (system[i][column] != 0 &&
          (pivot == size || cmp(abs(system[i][column]), abs(system[pivot][column])) < 0))
        pivot = i;
    }
    require(pivot < size || column >= required, "active rows are dependent");
    if (pivot == size) continue;
    std::swap(system[k], system[pivot]);
    unknown_of.push_back(column);
    for (std::size_t i = 0; i < size; ++i) {
      if (i == k) continue;
      const Integer factor = system[i][column];
      if (factor == 0 && system[k][column] == previous) continue;
      for (std::size_t j = column; j < system[i].size(); ++j) {
        system[i][j] *= system[k][column];
        system[i][j] -= factor * system[k][j];
        mpz_divexact(system[i][j].get_mpz_t(), system[i][j].get_mpz_t(), previous.get_mpz_t());
      }
    }
    previous = system[k][column];
  }
  for (std::size_t i = unknown_of.size(); i < size; ++i) {
    for (const Integer& value : system[i])
      require(value == 0, "the cost is not in the span of the active rows");
  }
  std::vector<Row> solution(size, Row(system.empty() ? 0 : system[0].size()));
  for (std::size_t k = 0; k < unknown_of.size(); ++k) {
    solution[unknown_of[k]] = std::move(system[k]);
    for (Integer& value : solution[unknown_of[k]]) value *= sgn(previous);
  }
  system = std::move(solution);
  return abs(previous);
}

}  // namespace

/// H z + A'lambda = -cost, A z = bound over the active rows. Of a linear program, H = I without cost gives
/// the shortest z, and the cost alone, in a second group of right-hand sides, the cost multipliers.
std::vector<Row> Certificate::optimalitySystem(const std::vector<std::size_t>& rows) const {
  const std::size_t size = n_ + rows.size(), width = p_ + 1;
  std::vector<Row> system;
  for (std::size_t i = 0; i < size; ++i) {
    Vector equation(size + (linear_ ? 2 : 1) * width);
    if (i < n_) {
      for (std::size_t j = 0; j < n_; ++j) equation[j] = linear_ ? Fraction(i == j ? 1 : 0) : hessian(i, j);
      for (std::size_t r = 0; r < rows.size(); ++r) equation[n_ + r] = data("A").at(rows[r], i);
      const Vector cost = affine("F", "f", i, 1);
      for (std::size_t j = 0; j < width; ++j) equation[size + (linear_ ? width : 0) + j] = -cost[j];
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
std::vector<Row> Certificate::limitSystem(const std::vector<std::size_t>& rows) const {
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

Region Certificate::describe(std::size_t index) const {
  Region region;
  region.active = activeSet(index);
  std::vector<std::size_t> rows = basis_;
  rows.insert(rows.end(), region.active.begin(), region.active.end());
  const std::size_t width = p_ + 1;
  std::vector<Row> system = singular_ ? limitSystem(rows) : optimalitySystem(rows);
  const std::size_t size = system.size();
  const Integer determinant = solve(system, singular_ ? n_ + 2 * rows.size() : size);
  const auto part = [&](std::size_t unknown, std::size_t group) {
    const auto first = system[unknown].begin() + static_cast<std::ptrdiff_t>(size + group * width);
    return Row(first, first + static_cast<std::ptrdiff_t>(width));
  };
  const auto is_zero = [](const Row& row) {
    return std::all_of(row.begin(), row.end(), [](const Integer& v) { return v == 0; });
  };
  std::vector<Row> z;
  for (std::size_t i = 0; i < n_; ++i) {
    z.push_back(part(i, 0));
    require(!linear_ || is_zero(part(i, 1)), "the cost is not in the span of the active rows");
  }
  for (std::size_t r = basis_.size(); r < rows.size(); ++r) {
    const Row cost_multiplier = linear_ ? part(n_ + r, 1) : singular_ ? part(n_ + r, 0) : Row(width);
    const bool by_cost = !is_zero(cost_multiplier);
    const Row own = by_cost ? cost_multiplier : part(n_ + r + (singular_ ? rows.size() : 0), 0);
    region.rows[(by_cost ? "p" : "m") + std::to_string(rows[r])] = primitive(own);
  }
  addSlacks(z, determinant, std::set<std::size_t>(rows.begin(), rows.end()), region);
  addDomain(region);
  setLaw(z, determinant, region);
  return region;
}

void Certificate::addSlacks(const std::vector<Row>& z, const Integer& determinant,
                            const std::set<std::size_t>& used, Region& region) const {
  for (std::size_t i = 0; i < m_; ++i) {
    if (used.count(i) > 0) continue;
    Vector coefficients(data("A").entries.begin() + static_cast<std::ptrdiff_t>(i * n_),
                        data("A").entries.begin() + static_cast<std::ptrdiff_t>((i + 1) * n_));
    const Vector own = bound(i);
    coefficients.insert(coefficients.end(), own.begin(), own.end());
    const Row row = primitive(coefficients);
    Row slack;
    for (std::size_t j = 0; j <= p_; ++j) {
      Integer value = determinant * row[n_ + j];
      for (std::size_t k = 0; k < n_; ++k) value -= row[k] * z[k][j];
      slack.push_back(value);
    }
    const std::string origin = "s" + std::to_string(i);
    const auto within = [&](Row relaxed, unsigned long bits) {
      Integer greatest(0);
      for (std::size_t k = 0; k < n_; ++k) greatest = std::max(greatest, Integer(abs(row[k])));
      for (Integer& value : relaxed) value <<= bits;
      relaxed.back() += determinant * greatest;
      return primitive(relaxed);
    };
    if (equalities_.count(i) > 0 && dropped_.count(i) > 0) {
      region.dropped[origin] = within(slack, kForgivenBits);
      for (Integer& value : slack) value = -value;
      region.dropped["x" + std::to_string(i)] = within(slack, kForgivenBits);
    } else if (equalities_.count(i) > 0) {
      for (const Integer& value : slack) require(value == 0, "an equality does not hold");
    } else if (dropped_.count(i) > 0) {
      region.dropped[origin] = within(slack, kDroppedBits);
    } else {
      if (widened_) region.forgiven[origin] = within(slack, kForgivenBits);
      region.rows[origin] = primitive(slack);
    }
  }
}

void Certificate::addDomain(Region& region) const {
  for (std::size_t i = 0; i < data("A_theta").rows; ++i) {
    region.rows["d" + std::to_string(i)] = primitive(affine("A_theta", "b_theta", i, -1));
  }
  for (std::size_t k = 0; k < 2 * p_; ++k) {
    Row row(p_ + 1);
    row[k / 2] = k % 2 == 0 ? -1 : 1;
    row[p_] = 1;
    region.rows["b" + std::to_string(k)] = row;
  }
}

void Certificate::setLaw(const std::vector<Row>& z, const Integer& determinant, Region& region) const {
  for (std::size_t i = 0; i < q_; ++i) {
    Vector law = affine("C", "c", i, 1);
    for (std::size_t j = 0; j <= p_; ++j) {
      Fraction sum;
      for (std::size_t k = 0; k < n_; ++k) {
        if (data("E").at(i, k) != 0) sum += data("E").at(i, k) * z[k][j];
      }
      region.law.push_back(law[j] + sum / determinant);
    }
  }
}

}  // namespace checker
