#include "problem/polyhedron.hpp"

#include <algorithm>

#include "dual_simplex.hpp"

namespace checker {
namespace {

constexpr int kMostPivots = 10000;
// Half the width of a box in which maxima are sought. A maximum at its sides proves nothing.
const Fraction kBox(Integer(1) << 100);

DualSimplex<Fraction> simplexOf(const std::vector<HalfSpace>& rows, std::size_t size) {
  Vector normals, limits;
  for (const HalfSpace& row : rows) {
    normals.insert(normals.end(), row.a.begin(), row.a.end());
    limits.push_back(row.bound / kBox);
  }
  return DualSimplex<Fraction>(std::move(normals), std::move(limits), size);
}

Fraction productOf(const Vector& a, const Vector& x) {
  Fraction sum;
  for (std::size_t j = 0; j < a.size(); ++j) sum += a[j] * x[j];
  return sum;
}

}  // namespace

Vector timesMatrix(const Vector& v, const Matrix& M) {
  Vector result(M.columns);
  for (std::size_t i = 0; i < M.rows; ++i)
    for (std::size_t j = 0; j < M.columns; ++j) result[j] += v[i] * M.at(i, j);
  return result;
}

std::optional<Fraction> greatestOf(const Vector& a, const std::vector<HalfSpace>& rows) {
  DualSimplex<Fraction> simplex = simplexOf(rows, a.size());
  const SimplexOutcome outcome = simplex.solve(a, {0, 0, true, kMostPivots});
  if (outcome != SimplexOutcome::kOptimal) return std::nullopt;
  Vector rest = a;
  Fraction bound;
  for (const auto& [place, weight] : simplex.multipliers(outcome)) {
    require(weight >= 0, "a multiplier is negative");
    for (std::size_t j = 0; j < a.size(); ++j) rest[j] -= weight * rows[place].a[j];
    bound += weight * rows[place].bound;
  }
  const bool is_sum = std::all_of(rest.begin(), rest.end(), [](const Fraction& value) { return value == 0; });
  return is_sum ? std::optional<Fraction>(bound) : std::nullopt;
}

bool holdsWhere(const std::vector<HalfSpace>& rows, const HalfSpace& target) {
  const std::optional<Fraction> greatest = greatestOf(target.a, rows);
  return greatest && *greatest <= target.bound;
}

bool hasPoint(const std::vector<HalfSpace>& rows) {
  if (rows.empty()) return true;
  DualSimplex<Fraction> simplex = simplexOf(rows, rows[0].a.size());
  if (simplex.solve(rows[0].a, {0, 0, true, kMostPivots}) != SimplexOutcome::kOptimal) return false;
  Vector x = simplex.point();
  for (Fraction& value : x) value *= kBox;
  return std::all_of(rows.begin(), rows.end(),
                     [&](const HalfSpace& row) { return productOf(row.a, x) <= row.bound; });
}

std::vector<HalfSpace> withoutEntry(const std::vector<HalfSpace>& rows, std::size_t place) {
  std::vector<HalfSpace> result;
  for (const HalfSpace& upper : rows) {
    if (upper.a[place] == 0) result.push_back(upper);
    if (upper.a[place] <= 0) continue;
    for (const HalfSpace& lower : rows) {
      if (lower.a[place] >= 0) continue;
      const Fraction &from_upper = -lower.a[place], &from_lower = upper.a[place];
      HalfSpace both{Vector(upper.a.size()), from_upper * upper.bound + from_lower * lower.bound};
      for (std::size_t j = 0; j < both.a.size(); ++j)
        both.a[j] = from_upper * upper.a[j] + from_lower * lower.a[j];
      result.push_back(std::move(both));
    }
  }
  return result;
}

std::vector<HalfSpace> withoutImplied(std::vector<HalfSpace> rows) {
  for (std::size_t k = rows.size(); k-- > 0;) {
    HalfSpace row = std::move(rows[k]);
    rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(k));
    if (!holdsWhere(rows, row)) rows.insert(rows.begin() + static_cast<std::ptrdiff_t>(k), std::move(row));
  }
  return rows;
}

}  // namespace checker
