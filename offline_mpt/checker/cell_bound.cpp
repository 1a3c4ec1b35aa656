#include "cell_bound.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "dual_simplex.hpp"

namespace checker {
namespace {

// Of the method in doubles, in parameters scaled to [-1, 1]. Thin cells must not count as empty.
constexpr double kFeasible = 1e-13;
constexpr double kPivot = 1e-11;
constexpr int kMostPivots = 100;
// Of the method in rational numbers, which ends; cells have some 60 rows.
constexpr int kMostExactPivots = 2000;
// A sum of n terms has a relative error of n halves of this in each term; twice that is counted.
constexpr double kUnit = std::numeric_limits<double>::epsilon();
// More than all underflows of a sum together.
constexpr double kUnderflow = 1e-290;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double asDouble(double value) { return value; }
double asDouble(const mpq_class& value) { return value.get_d(); }

template <class Number>
typename DualSimplex<Number>::Rules rules() {
  if constexpr (std::is_same_v<Number, double>) {
    return {kFeasible, kPivot, false, kMostPivots};
  } else {
    return {Number(0), Number(0), true, kMostExactPivots};
  }
}

}  // namespace

double Box::greatest(std::size_t i) const { return std::max(std::abs(lower[i]), std::abs(upper[i])); }

/// multipliers . limits + constant + the greatest of (function - multipliers . normals) . theta over the box, and
/// more than what rounding takes from it.
double Cell::weakDual(const std::vector<double>& function, double constant) const {
  double sum = constant;
  double size = std::abs(constant);
  for (const auto& [row, multiplier] : multipliers_) {
    sum += multiplier * half_spaces_[row].limit;
    size += multiplier * std::abs(half_spaces_[row].limit);
  }
  for (std::size_t i = 0; i < box_->size(); ++i) {
    double rest = function[i];
    double rest_size = std::abs(function[i]);
    for (const auto& [row, multiplier] : multipliers_) {
      const double entry = half_spaces_[row].sign * half_spaces_[row].normal[i];
      rest -= multiplier * entry;
      rest_size += multiplier * std::abs(entry);
    }
    sum += std::max(rest * box_->lower[i], rest * box_->upper[i]);
    size += rest_size * box_->greatest(i);
  }
  const auto terms = static_cast<double>(2 * multipliers_.size() + box_->size() + 8);
  return sum + terms * kUnit * size + kUnderflow;
}

/// False where the method got stuck, or its proof of an empty cell fails.
template <class Number>
bool Cell::solve(const std::vector<double>& function, double constant, double& bound) {
  const std::size_t p = box_->size();
  std::vector<Number> centre(p), half(p), normals, limits, scaled(p);
  for (std::size_t i = 0; i < p; ++i) {
    centre[i] = (Number(box_->lower[i]) + Number(box_->upper[i])) / 2;
    half[i] = (Number(box_->upper[i]) - Number(box_->lower[i])) / 2;
    scaled[i] = Number(function[i]) * half[i];
  }
  for (const HalfSpace& half_space : half_spaces_) {
    Number limit(half_space.limit);
    for (std::size_t i = 0; i < p; ++i) {
      const Number entry(half_space.sign * half_space.normal[i]);
      normals.emplace_back(entry * half[i]);
      limit -= entry * centre[i];
    }
    limits.push_back(limit);
  }
  DualSimplex<Number> simplex(std::move(normals), std::move(limits), p);
  const SimplexOutcome outcome = simplex.solve(scaled, rules<Number>());
  multipliers_.clear();
  if (outcome == SimplexOutcome::kStopped) return false;
  for (const auto& [row, multiplier] : simplex.multipliers(outcome))
    multipliers_.emplace_back(row, asDouble(multiplier));
  if (outcome == SimplexOutcome::kOptimal) {
    bound = weakDual(function, constant);
    return true;
  }
  // A contradiction bounds 0 by less than 0.
  bound = -kInfinity;
  return weakDual(std::vector<double>(p, 0.0), 0.0) < 0.0;
}

template <class Number>
std::vector<double> Cell::pointBy(const std::vector<double>& function) const {
  const std::size_t p = box_->size();
  double unit = 0.0;
  for (const HalfSpace& half_space : half_spaces_) unit = std::max(unit, half_space.weight);
  std::vector<Number> normals, limits;
  std::vector<double> middle(p), half(p);
  for (std::size_t i = 0; i < p; ++i) {
    middle[i] = 0.5 * (box_->lower[i] + box_->upper[i]);
    half[i] = 0.5 * (box_->upper[i] - box_->lower[i]);
  }
  for (const HalfSpace& half_space : half_spaces_) {
    Number limit(half_space.limit);
    for (std::size_t i = 0; i < p; ++i) {
      const Number entry(half_space.sign * half_space.normal[i]);
      normals.emplace_back(entry * Number(half[i]));
      limit -= entry * Number(middle[i]);
    }
    normals.emplace_back(unit > 0.0 ? half_space.weight / unit : 0.0);
    limits.push_back(limit);
  }
  // The distance is not negative.
  normals.insert(normals.end(), p, Number(0));
  normals.emplace_back(-1);
  limits.emplace_back(0);
  DualSimplex<Number> simplex(std::move(normals), std::move(limits), p + 1);
  const std::vector<Number> objective(function.begin(), function.end());
  if (simplex.solve(objective, rules<Number>()) != SimplexOutcome::kOptimal) return {};
  const std::vector<Number> point = simplex.point();
  std::vector<double> theta(p);
  for (std::size_t i = 0; i < p; ++i)
    theta[i] = std::clamp(middle[i] + half[i] * asDouble(point[i]), box_->lower[i], box_->upper[i]);
  return theta;
}

std::vector<double> Cell::point(const std::vector<double>& function) const {
  const std::vector<double> theta = pointBy<double>(function);
  return theta.empty() ? pointBy<mpq_class>(function) : theta;
}

double Cell::depth(const std::vector<double>& theta) const {
  double least = kInfinity;
  for (const HalfSpace& half_space : half_spaces_) {
    double rest = half_space.limit;
    for (std::size_t i = 0; i < theta.size(); ++i) rest -= half_space.sign * half_space.normal[i] * theta[i];
    least = std::min(least, rest / half_space.weight);
  }
  return least;
}

bool Cell::isEmpty() {
  // Any function serves; one without symmetry keeps dual variables apart.
  std::vector<double> function(box_->size());
  for (std::size_t i = 0; i < function.size(); ++i) {
    const double range = box_->upper[i] - box_->lower[i];
    function[i] = range > 0.0 ? (1.0 + 0.37 * static_cast<double>(i)) / range : 0.0;
  }
  return upperBound(function, 0.0) == -kInfinity;
}

double Cell::upperBound(const std::vector<double>& function, double constant) {
  double bound = 0.0;
  if (solve<double>(function, constant, bound) || solve<mpq_class>(function, constant, bound)) return bound;
  // The bound over the whole box.
  multipliers_.clear();
  return weakDual(function, constant);
}

}  // namespace checker
