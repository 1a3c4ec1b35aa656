// Statement 1: the program is convex, and each region has the solution of its optimality conditions.
#include <algorithm>

#include "core/certificate.hpp"
#include "core/linear_system.hpp"
#include "core/tags.hpp"

namespace checker {

void Certificate::checkProgram() const {
  for (const std::size_t row : basis_) require(equalities_.count(row) > 0, "a row is no equality");
  checkConvexity();
  checkUniqueness();
}

/// Of a convex program: the system of the equalities alone is regular, so H is positive definite where they leave z free.
/// For if H v = 0 were possible along them, v would solve that system without right-hand side.
void Certificate::checkUniqueness() const { Certificate::optimum(basis_); }

/// H counts as symmetric.
Fraction Certificate::hessian(std::size_t i, std::size_t j) const {
  return (data("H").at(i, j) + data("H").at(j, i)) / 2;
}

/// Elimination shows that H is positive semidefinite, with the penalty on the equalities.
void Certificate::checkConvexity() const {
  require(penalty_ >= 0, "convexity: negative");
  Matrix H = data("H");
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t j = 0; j < n_; ++j) {
      H.entries[i * n_ + j] = hessian(i, j);
      for (const std::size_t row : basis_)
        H.entries[i * n_ + j] += penalty_ * data("A").at(row, i) * data("A").at(row, j);
    }
  }
  std::vector<char> done(n_, 0);
  for (std::size_t round = 0; round < n_; ++round) {
    std::size_t k = n_;
    for (std::size_t i = 0; i < n_; ++i) {
      require(done[i] || H.at(i, i) >= 0, "H is not positive semidefinite");
      if (!done[i] && H.at(i, i) > 0) k = i;
    }
    for (std::size_t i = 0; k == n_ && i < n_ * n_; ++i)
      require(done[i / n_] || done[i % n_] || H.entries[i] == 0, "H is not positive semidefinite");
    if (k == n_) return;
    done[k] = 1;
    for (std::size_t i = 0; i < n_; ++i) {
      if (done[i]) continue;
      const Fraction factor = H.at(i, k) / H.at(k, k);
      for (std::size_t j = 0; j < n_; ++j) H.entries[i * n_ + j] -= factor * H.at(k, j);
    }
  }
}

/// The map's active set without the equalities.
std::set<std::size_t> Certificate::activeSet(std::size_t index) const {
  const Map::Region& region = map_.regions[index];
  std::set<std::size_t> active;
  for (std::size_t k = region.first_active; k < std::size_t{region.first_active} + region.active_count; ++k)
    addActive(map_.active[k], active);
  return active;
}

void Certificate::addActive(std::int64_t row, std::set<std::size_t>& active) const {
  require(row >= 0 && static_cast<std::size_t>(row) < m_, "an active set names a row that is not there");
  const auto i = static_cast<std::size_t>(row);
  if (equalities_.count(i) > 0 || isInBasis(i)) return;
  require(!isLeftOut(i), "an active set names a dropped row");
  require(active.insert(i).second, "an active set repeats a row");
}

/// Row of (sign * matrix theta + vector) in t.
Vector Certificate::affine(const std::string& matrix, const std::string& vector, std::size_t row,
                           int sign) const {
  return scaling_.inBox(data(matrix).entries.data() + row * p_, sign, data(vector).at(row, 0));
}

/// The solution of the active set, and all conditions under which it is optimal.
Region Certificate::describe(std::size_t index) const {
  Region region;
  region.active = activeSet(index);
  std::vector<std::size_t> rows = basis_;
  rows.insert(rows.end(), region.active.begin(), region.active.end());
  const Optimum solution = optimum(rows);
  region.rows = solution.multipliers;
  for (std::size_t i = 0; i < m_; ++i) {
    if (!contains(rows, i)) addSlackOf(i, solution, region);
  }
  addDomain(region);
  for (std::size_t i = 0; i < q_; ++i) {
    const Vector law = affine("C", "c", i, 1);
    for (std::size_t j = 0; j <= p_; ++j) {
      Fraction sum;
      for (std::size_t k = 0; k < n_; ++k) sum += data("E").at(i, k) * solution.z[k][j];
      region.law.push_back(law[j] + sum / solution.determinant);
    }
  }
  return region;
}

/// H z + A'lambda = -cost and A z = bound, with A and bound of the active rows. Multipliers of the basis have any sign.
Optimum Certificate::optimum(const std::vector<std::size_t>& rows) const {
  const std::size_t size = n_ + rows.size();
  std::vector<Row> system;
  for (std::size_t i = 0; i < size; ++i) {
    Vector equation(size);
    Vector right;
    if (i < n_) {
      for (std::size_t j = 0; j < n_; ++j) equation[j] = hessian(i, j);
      for (std::size_t r = 0; r < rows.size(); ++r) equation[n_ + r] = data("A").at(rows[r], i);
      right = affine("F", "f", i, 1);
      for (Fraction& value : right) value = -value;
    } else {
      for (std::size_t j = 0; j < n_; ++j) equation[j] = data("A").at(rows[i - n_], j);
      right = bound(rows[i - n_]);
    }
    equation.insert(equation.end(), right.begin(), right.end());
    system.push_back(primitive(equation));
  }
  Optimum result;
  result.determinant = solveSystem(system, size);
  for (std::size_t i = 0; i < size; ++i) {
    const Row unknown(system[i].begin() + static_cast<std::ptrdiff_t>(size), system[i].end());
    if (i < n_) result.z.push_back(unknown);
    if (i < n_ + basis_.size()) continue;
    const std::string origin = tag::origin(tag::kMultiplier, rows[i - n_]);
    result.multipliers[origin] = primitive(unknown);
  }
  return result;
}

/// bound - a z, which must be >= 0.
void Certificate::addSlackOf(std::size_t i, const Optimum& solution, Region& region) const {
  Vector coefficients;
  for (std::size_t k = 0; k < n_; ++k) coefficients.push_back(data("A").at(i, k));
  const Vector own = bound(i);
  coefficients.insert(coefficients.end(), own.begin(), own.end());
  const Row row = primitive(coefficients);
  Slack slack;
  for (std::size_t j = 0; j <= p_; ++j) {
    slack.value.push_back(solution.determinant * row[n_ + j]);
    for (std::size_t k = 0; k < n_; ++k) slack.value.back() -= row[k] * solution.z[k][j];
  }
  for (std::size_t k = 0; k < n_; ++k) slack.size = std::max(slack.size, Integer(abs(row[k])));
  slack.size *= solution.determinant;
  addSlack(i, slack, region);
}

void Certificate::addSlack(std::size_t i, const Slack& slack, Region& region) const {
  if (equalities_.count(i) == 0) {
    region.rows[tag::origin(tag::kSlack, i)] = primitive(slack.value);
    return;
  }
  for (const Integer& value : slack.value) require(value == 0, "an equality does not hold");
}

void Certificate::addDomain(Region& region) const {
  for (std::size_t i = 0; i < data("A_theta").rows; ++i)
    region.rows[tag::origin(tag::kDomain, i)] = primitive(affine("A_theta", "b_theta", i, -1));
  for (std::size_t k = 0; k < 2 * p_; ++k) {
    Row side(p_ + 1);
    side[k / 2] = k % 2 == 0 ? -1 : 1;
    side[p_] = 1;
    region.rows[tag::origin(tag::kSideOfBox, k)] = side;
  }
}

}  // namespace checker
