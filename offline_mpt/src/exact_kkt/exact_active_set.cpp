#include "exact_kkt/exact_active_set.hpp"

#include <algorithm>
#include <utility>

#include "exact_kkt/exact_region.hpp"

namespace polyfly {
namespace {

/// row (t, 1)
Rational valueAt(const IntegerMatrix& rows, int row, const std::vector<Rational>& t) {
  Rational value(rows(row, rows.columns() - 1));
  for (int j = 0; j + 1 < rows.columns(); ++j) value += rows(row, j) * t[static_cast<std::size_t>(j)];
  return value;
}

class DualSteps {
 public:
  DualSteps(const ExactProgram& program, const std::vector<Rational>& t) : program_(program), t_(t) {
    t_.emplace_back(1);
  }

  /// Begins with those of the rows that have no negative multiplier; false where they depend on each other.
  bool begin(std::vector<int> active) {
    active_ = std::move(active);
    for (;;) {
      ExactSolution solution;
      if (solution.solve(program_, active_) != ExactStatus::kRegion) return false;
      take(solution);
      const std::vector<Rational> multipliers = std::exchange(multipliers_, {});
      const std::vector<int> rows = std::exchange(active_, {});
      for (std::size_t k = 0; k < rows.size(); ++k) {
        if (multipliers[k] < 0) continue;
        active_.push_back(rows[k]);
        multipliers_.push_back(multipliers[k]);
      }
      if (active_.size() == rows.size()) return true;
    }
  }

  /// The row that is violated most, in shares of its greatest entry; -1: none.
  int mostViolated() const {
    int result = -1;
    Rational most;
    for (int row = 0; row < program_.m; ++row) {
      const auto at = static_cast<std::size_t>(row);
      if (program_.is_equality[at] || program_.is_dropped[at] || program_.row_size[at] == 0 || isActive(row))
        continue;
      const Rational violation = -slack(row) / program_.row_size[at];
      if (violation <= most) continue;
      most = violation;
      result = row;
    }
    return result;
  }

  /// Lets the row's multiplier grow until it holds, while rows leave whose multipliers vanish; false where it cannot hold.
  bool satisfy(int row) {
    Rational own;
    for (;;) {
      const std::vector<Rational> change = changeBy(row);
      Rational slope;
      for (int i = 0; i < program_.n; ++i) slope += program_.A(row, i) * change[static_cast<std::size_t>(i)];
      const bool can_hold = slope > 0;
      Rational step = can_hold ? Rational(-slack(row) / slope) : Rational();
      std::size_t leaving = active_.size();
      const std::size_t first = static_cast<std::size_t>(program_.n) + program_.basis.size();
      for (std::size_t k = 0; k < active_.size(); ++k) {
        if (change[first + k] <= 0) continue;
        const Rational vanishes = multipliers_[k] / change[first + k];
        if (leaving == active_.size() ? can_hold && vanishes >= step : vanishes >= step) continue;
        step = vanishes;
        leaving = k;
      }
      if (!can_hold && leaving == active_.size()) return false;
      for (std::size_t i = 0; i < z_.size(); ++i) z_[i] -= step * change[i];
      for (std::size_t k = 0; k < active_.size(); ++k) multipliers_[k] -= step * change[first + k];
      own += step;
      if (leaving == active_.size()) {
        active_.push_back(row);
        multipliers_.push_back(own);
        return true;
      }
      active_.erase(active_.begin() + static_cast<std::ptrdiff_t>(leaving));
      multipliers_.erase(multipliers_.begin() + static_cast<std::ptrdiff_t>(leaving));
    }
  }

  const std::vector<int>& active() const { return active_; }

 private:
  bool isActive(int row) const { return std::find(active_.begin(), active_.end(), row) != active_.end(); }

  void take(const ExactSolution& solution) {
    const auto value = [&](const auto& entry) {
      Rational sum;
      for (int j = 0; j <= program_.p; ++j) sum += entry(j) * t_[static_cast<std::size_t>(j)];
      return Rational(sum / solution.denominator());
    };
    z_.clear();
    multipliers_.clear();
    for (int i = 0; i < program_.n; ++i) z_.push_back(value([&](int j) { return solution.z(i, j); }));
    for (std::size_t k = program_.basis.size(); k < solution.rows().size(); ++k)
      multipliers_.push_back(value([&](int j) { return solution.multiplier(static_cast<int>(k), j); }));
  }

  Rational slack(int row) const {
    Rational sum = valueAt(program_.bound, row, t_);
    for (int i = 0; i < program_.n; ++i) sum -= program_.A(row, i) * z_[static_cast<std::size_t>(i)];
    return sum;
  }

  /// Minus the derivatives of z, and of the multipliers of basis and active rows, by the row's multiplier. The active rows are
  /// independent.
  std::vector<Rational> changeBy(int row) const {
    std::vector<int> rows = program_.basis;
    rows.insert(rows.end(), active_.begin(), active_.end());
    IntegerMatrix system = optimalityMatrix(program_, rows, 1);
    const int size = system.rows();
    for (int i = 0; i < program_.n; ++i) system(i, size) = program_.A(row, i);
    Integer determinant;
    std::vector<Rational> change;
    if (!solveExactly(system, determinant)) return change;
    for (int i = 0; i < size; ++i) {
      change.emplace_back(system(i, size), determinant);
      change.back().canonicalize();
    }
    return change;
  }

  const ExactProgram& program_;
  std::vector<Rational> t_;
  std::vector<int> active_;
  // Of active_; the equalities' are not needed.
  std::vector<Rational> multipliers_;
  std::vector<Rational> z_;
};

/// Where H is zero: the rows with a multiplier. A feasible z is optimal at t where all of them are tight, and nowhere else.
std::optional<std::vector<int>> rowsOfOptima(const ExactProgram& program, const std::vector<Rational>& t) {
  ExactLp lp = rowsAt(program, t);
  setCostAt(program, t, lp);
  if (lp.solve() != ExactLp::Status::kOptimal) return std::nullopt;
  std::vector<int> rows;
  for (int row = 0; row < program.m; ++row) {
    if (program.in_basis[static_cast<std::size_t>(row)] == 0 && lp.rowDual(row) != 0) rows.push_back(row);
  }
  return rows;
}

/// Of all optima the shortest: with the rows of all as equalities, the cost is gone.
std::optional<std::vector<int>> shortestSetAt(const ExactProgram& program, const std::vector<Rational>& t) {
  const std::optional<std::vector<int>> rows = rowsOfOptima(program, t);
  if (!rows) return std::nullopt;
  ExactProgram face = program;
  face.linear = false;
  face.cost = IntegerMatrix(program.n, program.p + 1);
  face.basis.insert(face.basis.end(), rows->begin(), rows->end());
  for (const int row : *rows) face.in_basis[static_cast<std::size_t>(row)] = 1;
  std::optional<std::vector<int>> active = activeSetAt(face, t, {});
  if (!active) return std::nullopt;
  active->insert(active->end(), rows->begin(), rows->end());
  std::sort(active->begin(), active->end());
  return active;
}

}  // namespace

ExactLp rowsAt(const ExactProgram& program, const std::vector<Rational>& t, bool of_directions) {
  ExactLp lp;
  lp.addColumns(program.n, ExactLp::Bound::kFree);
  lp.addRows(program.m);
  for (int row = 0; row < program.m; ++row) {
    const auto at = static_cast<std::size_t>(row);
    if (program.in_basis[at] == 0 && (program.is_equality[at] != 0 || program.is_dropped[at] != 0)) continue;
    const Rational bound = of_directions ? Rational(0) : valueAt(program.bound, row, t);
    lp.setRowBounds(row, program.in_basis[at] != 0 ? ExactLp::Bound::kFixed : ExactLp::Bound::kUpper, bound,
                    bound);
    for (int i = 0; i < program.n; ++i) {
      if (program.A(row, i) != 0) lp.setCoefficient(row, i, program.A(row, i));
    }
  }
  return lp;
}

void setCostAt(const ExactProgram& program, const std::vector<Rational>& t, ExactLp& lp) {
  for (int i = 0; i < program.n; ++i) lp.setObjective(i, valueAt(program.cost, i, t));
}

std::optional<std::vector<int>> activeSetAt(const ExactProgram& program, const std::vector<Rational>& t,
                                            const std::vector<int>& start) {
  if (program.linear) return shortestSetAt(program, t);
  DualSteps steps(program, t);
  if (!steps.begin(start) && !steps.begin({})) return std::nullopt;
  // Each step raises the dual cost; where several rows are tight at t it may stay, and rows could come and go for ever.
  for (int left = 20 * (program.n + program.m); left > 0; --left) {
    const int row = steps.mostViolated();
    if (row < 0) {
      std::vector<int> active = steps.active();
      std::sort(active.begin(), active.end());
      return active;
    }
    if (!steps.satisfy(row)) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace polyfly
