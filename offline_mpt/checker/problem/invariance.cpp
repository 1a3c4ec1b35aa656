// The set that `invariance: first_step` names is robustly invariant within the bounds.
#include "problem/invariance.hpp"

#include <algorithm>

#include "dual_simplex.hpp"

namespace checker {
namespace {

using PlanRow = RobustCertificate::PlanRow;

constexpr int kMostPivots = 10000;
// Half the width of a box in which maxima are sought. A maximum at its sides proves nothing.
const Fraction kBox(Integer(1) << 100);

/// a . theta + on_input u~ <= bound.
struct HalfSpace {
  Vector a;
  Fraction bound, on_input;
};

/// Solves a A = c for a; throws Refused where A is singular.
Vector solvedFromLeft(const Matrix& A, const Vector& c) {
  const std::size_t n = A.rows;
  std::vector<Vector> system(n);  // A' a = c
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) system[i].push_back(A.at(j, i));
    system[i].push_back(c[i]);
  }
  for (std::size_t column = 0; column < n; ++column) {
    std::size_t pivot = column;
    while (pivot < n && system[pivot][column] == 0) ++pivot;
    require(pivot < n, "the model cannot be inverted, so rows of the first step are not recognised");
    std::swap(system[column], system[pivot]);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == column || system[i][column] == 0) continue;
      const Fraction factor = system[i][column] / system[column][column];
      for (std::size_t j = column; j <= n; ++j) system[i][j] -= factor * system[column][j];
    }
  }
  Vector a;
  for (std::size_t i = 0; i < n; ++i) a.emplace_back(system[i][n] / system[i][i]);
  return a;
}

class Invariance {
 public:
  Invariance(const RobustCertificate& certificate, const RobustProblem& problem)
      : models_(certificate.models()), problem_(problem), p_(problem.ranges.rows) {}

  void confirm(const std::vector<const PlanRow*>& rows) {
    for (const PlanRow* row : rows) add(*row);
    for (const auto& [state, range] : problem_.state_ranges)
      for (const int sign : {1, -1})
        require(holdsInSet(shifted(problem_.errors[state], problem_.state_shift, state, sign, range)),
                "a bound of a state does not hold in all of the set that the first step must reach");
    for (const int sign : {1, -1}) {
      HalfSpace input = shifted(p_, problem_.input_shift, 0, sign, problem_.input_range);
      input.on_input = sign;
      next_.push_back(std::move(input));
    }
    for (const HalfSpace& row : next_) requireInput(row);
  }

 private:
  /// Of a row of the certificate: the half-space of the set, and what u~_0 must meet so that the next state is in it.
  void add(const PlanRow& row) {
    require(row.z.empty() && row.terms.empty() && row.y[p_ + 1] == 0,
            "a row of the certificate is none of the problem");
    Vector on_errors;
    for (const std::size_t error : problem_.errors) on_errors.push_back(row.y[error]);
    const Vector h = solvedFromLeft(models_.at("A"), on_errors);
    require(timesMatrix(h, models_.at("B"))[0] == row.y[p_],
            "a row of the certificate is none of the problem");
    next_.push_back(
        {Vector(row.y.begin(), row.y.begin() + static_cast<std::ptrdiff_t>(p_)), row.bound, row.y[p_]});
    HalfSpace own{next_.back().a, row.bound + timesMatrix(h, models_.at("drift"))[0], 0};
    for (std::size_t i = 0; i < h.size(); ++i) own.a[problem_.errors[i]] = h[i];
    for (const Fraction& effect : timesMatrix(h, models_.at("G"))) own.bound += abs(effect);
    set_.push_back(std::move(own));
  }

  /// A side of the range of an entry of theta with what the references add. There is no such entry p: that is u~.
  HalfSpace shifted(std::size_t entry, const Matrix& shift, std::size_t column, int sign,
                    const RobustProblem::Range& range) const {
    HalfSpace result{Vector(p_), sign > 0 ? range.second : Fraction(-range.first), 0};
    for (std::size_t j = 0; j < p_; ++j) result.a[j] = sign * shift.at(j, column);
    if (entry < p_) result.a[entry] += sign;
    return result;
  }

  /// An upper bound of u~ and each lower one leave an input between them, in all of the set.
  void requireInput(const HalfSpace& upper) const {
    static const char* const kLost = "the set that the first step must reach is not robustly invariant";
    if (upper.on_input == 0) require(holdsInSet(upper), kLost);
    if (upper.on_input <= 0) return;
    for (const HalfSpace& lower : next_) {
      if (lower.on_input >= 0) continue;
      HalfSpace both{Vector(p_), 0, 0};
      for (std::size_t j = 0; j < p_; ++j)
        both.a[j] = lower.a[j] * upper.on_input - upper.a[j] * lower.on_input;
      both.bound = lower.bound * upper.on_input - upper.bound * lower.on_input;
      require(holdsInSet(both), kLost);
    }
  }

  /// By multipliers: weights >= 0 with sum of weight * a = target and sum of weight * bound <= its bound.
  bool holdsInSet(const HalfSpace& target) const {
    Vector normals, limits;
    for (const HalfSpace& row : set_) {
      normals.insert(normals.end(), row.a.begin(), row.a.end());
      limits.push_back(row.bound / kBox);
    }
    DualSimplex<Fraction> simplex(std::move(normals), std::move(limits), p_);
    const SimplexOutcome outcome = simplex.solve(target.a, {0, 0, true, kMostPivots});
    if (outcome != SimplexOutcome::kOptimal) return false;
    Vector rest = target.a;
    Fraction bound;
    for (const auto& [place, weight] : simplex.multipliers(outcome)) {
      require(weight >= 0, "a multiplier is negative");
      for (std::size_t j = 0; j < p_; ++j) rest[j] -= weight * set_[place].a[j];
      bound += weight * set_[place].bound;
    }
    return bound <= target.bound &&
           std::all_of(rest.begin(), rest.end(), [](const Fraction& value) { return value == 0; });
  }

  const Matrices& models_;
  const RobustProblem& problem_;
  const std::size_t p_;
  std::vector<HalfSpace> set_;
  /// With u~, what keeps the next state in the set and the input in its range.
  std::vector<HalfSpace> next_;
};

}  // namespace

Vector timesMatrix(const Vector& v, const Matrix& M) {
  Vector result(M.columns);
  for (std::size_t i = 0; i < M.rows; ++i)
    for (std::size_t j = 0; j < M.columns; ++j) result[j] += v[i] * M.at(i, j);
  return result;
}

void confirmInvariant(const std::vector<const PlanRow*>& rows, const RobustCertificate& certificate,
                      const RobustProblem& problem) {
  Invariance(certificate, problem).confirm(rows);
}

}  // namespace checker
