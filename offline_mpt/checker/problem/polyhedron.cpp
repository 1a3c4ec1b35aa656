#include "problem/polyhedron.hpp"

#include <algorithm>
#include <type_traits>

namespace checker {
namespace {

// With the most violated row; then with Bland's rule, which ends.
constexpr int kMostPivots = 1000;
constexpr int kMostBlandPivots = 100000;
// Half the width of a box in which maxima are sought. A maximum at its sides proves nothing.
constexpr double kBox = 0x1p100;
// Of the method in doubles. Its result is checked.
constexpr double kQuickFeasible = 1e-13 / kBox;
constexpr double kQuickPivot = 1e-13;

std::size_t sizeOf(const std::vector<ExactHalfSpace>& rows) {
  require(!rows.empty(), "a set without half-spaces");
  return rows[0].a.size();
}

template <class Number>
Number numberAs(const Fraction& value) {
  if constexpr (std::is_same_v<Number, double>)
    return value.get_d();
  else
    return value;
}

template <class Number>
DualSimplex<Number> simplexOf(const std::vector<ExactHalfSpace>& rows) {
  std::vector<Number> normals, limits;
  for (const ExactHalfSpace& row : rows) {
    for (const Fraction& value : row.a) normals.push_back(numberAs<Number>(value));
    limits.push_back(numberAs<Number>(row.bound / Fraction(kBox)));
  }
  return DualSimplex<Number>(std::move(normals), std::move(limits), sizeOf(rows));
}

template <class Number>
std::vector<std::size_t> placesOf(const DualSimplex<Number>& simplex) {
  std::vector<std::size_t> places;
  for (const auto& entry : simplex.multipliers(SimplexOutcome::kOptimal)) places.push_back(entry.first);
  return places;
}

bool isZero(const Vector& values) {
  return std::all_of(values.begin(), values.end(), [](const Fraction& value) { return value == 0; });
}

Fraction productOf(const Vector& a, const Vector& x) {
  Fraction sum;
  for (std::size_t j = 0; j < a.size(); ++j) sum += a[j] * x[j];
  return sum;
}

/// The same half-space in whole numbers without a common factor. Without that, numbers would grow from step to step.
ExactHalfSpace shortest(ExactHalfSpace row) {
  row.a.push_back(row.bound);
  const Row whole = primitive(row.a);
  row.a.assign(whole.begin(), whole.end() - 1);
  row.bound = whole.back();
  return row;
}

}  // namespace

Vector timesMatrix(const Vector& v, const Matrix& M) {
  Vector result(M.columns);
  for (std::size_t i = 0; i < M.rows; ++i)
    for (std::size_t j = 0; j < M.columns; ++j) result[j] += v[i] * M.at(i, j);
  return result;
}

std::optional<Vector> weightsOf(const std::vector<Vector>& rows, const Vector& target) {
  const std::size_t count = rows.size(), size = target.size();
  std::vector<Vector> system(size);  // one equation for each entry of the target
  for (std::size_t i = 0; i < size; ++i) {
    for (const Vector& row : rows) system[i].push_back(row[i]);
    system[i].push_back(target[i]);
  }
  Vector weights(count);
  std::size_t used = 0;
  std::vector<std::size_t> unknowns;
  for (std::size_t column = 0; column < count && used < size; ++column) {
    std::size_t pivot = used;
    while (pivot < size && system[pivot][column] == 0) ++pivot;
    if (pivot == size) continue;
    std::swap(system[used], system[pivot]);
    for (std::size_t i = 0; i < size; ++i) {
      if (i == used || system[i][column] == 0) continue;
      const Fraction factor = system[i][column] / system[used][column];
      for (std::size_t j = column; j <= count; ++j) system[i][j] -= factor * system[used][j];
    }
    unknowns.push_back(column);
    ++used;
  }
  for (std::size_t i = used; i < size; ++i)
    if (system[i][count] != 0) return std::nullopt;
  for (std::size_t i = 0; i < used; ++i) weights[unknowns[i]] = system[i][count] / system[i][unknowns[i]];
  return weights;
}

Polyhedron::Polyhedron(std::vector<ExactHalfSpace> rows)
    : rows_(std::move(rows)), quick_(simplexOf<double>(rows_)), exact_(simplexOf<Fraction>(rows_)) {}

bool Polyhedron::solve(const Vector& a) const {
  SimplexOutcome outcome = exact_.solve(a, {0, 0, false, kMostPivots});
  if (outcome == SimplexOutcome::kStopped) outcome = exact_.solve(a, {0, 0, true, kMostBlandPivots});
  return outcome == SimplexOutcome::kOptimal;
}

std::optional<Fraction> Polyhedron::boundBy(const std::vector<std::size_t>& places, const Vector& a) const {
  std::vector<Vector> chosen;
  for (const std::size_t place : places) chosen.push_back(rows_[place].a);
  const std::optional<Vector> weights = weightsOf(chosen, a);
  if (!weights) return std::nullopt;
  Fraction bound;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if ((*weights)[k] < 0) return std::nullopt;
    bound += (*weights)[k] * rows_[places[k]].bound;
  }
  return bound;
}

std::optional<Fraction> Polyhedron::quickly(const Vector& a) const {
  std::vector<double> function;
  for (const Fraction& value : a) function.push_back(value.get_d());
  const SimplexOutcome outcome = quick_.solve(function, {kQuickFeasible, kQuickPivot, false, kMostPivots});
  return outcome == SimplexOutcome::kOptimal ? boundBy(placesOf(quick_), a) : std::nullopt;
}

std::optional<Fraction> Polyhedron::greatest(const Vector& a) const {
  const std::optional<Fraction> quick = quickly(a);
  if (quick) return quick;
  return solve(a) ? boundBy(placesOf(exact_), a) : std::nullopt;
}

bool Polyhedron::isWithin(const ExactHalfSpace& target) const {
  const std::optional<Fraction> quick = quickly(target.a);
  if (quick && *quick <= target.bound) return true;
  const std::optional<Fraction> exact = solve(target.a) ? boundBy(placesOf(exact_), target.a) : std::nullopt;
  return exact && *exact <= target.bound;
}

bool Polyhedron::isEmpty() const {
  if (exact_.solve(rows_[0].a, {0, 0, true, kMostBlandPivots}) != SimplexOutcome::kInfeasible) return false;
  Vector sum(rows_[0].a.size());
  Fraction bound;
  for (const auto& [place, weight] : exact_.multipliers(SimplexOutcome::kInfeasible)) {
    require(weight >= 0, "a multiplier is negative");
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += weight * rows_[place].a[j];
    bound += weight * rows_[place].bound;
  }
  return bound < 0 && isZero(sum);
}

bool Polyhedron::hasPoint() const {
  if (!solve(rows_[0].a)) return false;
  Vector x = exact_.point();
  for (Fraction& value : x) value *= Fraction(kBox);
  return std::all_of(rows_.begin(), rows_.end(),
                     [&](const ExactHalfSpace& row) { return productOf(row.a, x) <= row.bound; });
}

std::vector<ExactHalfSpace> withoutEntry(const std::vector<ExactHalfSpace>& rows, std::size_t place) {
  std::vector<ExactHalfSpace> result;
  for (const ExactHalfSpace& upper : rows) {
    if (upper.a[place] == 0) result.push_back(upper);
    if (upper.a[place] <= 0) continue;
    for (const ExactHalfSpace& lower : rows) {
      if (lower.a[place] >= 0) continue;
      const Fraction &from_upper = -lower.a[place], &from_lower = upper.a[place];
      ExactHalfSpace both{Vector(upper.a.size()), from_upper * upper.bound + from_lower * lower.bound};
      for (std::size_t j = 0; j < both.a.size(); ++j)
        both.a[j] = from_upper * upper.a[j] + from_lower * lower.a[j];
      result.push_back(shortest(std::move(both)));
    }
  }
  return result;
}

std::vector<ExactHalfSpace> withoutImplied(std::vector<ExactHalfSpace> rows) {
  for (std::size_t k = rows.size(); rows.size() > 1 && k-- > 0;) {
    std::vector<ExactHalfSpace> others = rows;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    if (Polyhedron(others).isWithin(rows[k])) rows = std::move(others);
  }
  return rows;
}

}  // namespace checker
