#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace checker {

enum class SimplexOutcome { kOptimal, kInfeasible, kStopped };

/// The dual simplex method for: maximise function . s over normal_k . s <= limit_k and -1 <= s_i <= 1. Number is double
/// or a rational type.
template <class Number>
class DualSimplex {
 public:
  struct Rules {
    /// Violations and pivots up to these count as none; 0 for rational numbers.
    Number feasible{}, pivot{};
    /// Bland's rule, with which the method ends. Without it, the most violated row enters.
    bool takes_first = false;
    int most_pivots = 0;
  };

  /// Rows are p numbers each.
  DualSimplex(std::vector<Number> normals, std::vector<Number> limits, std::size_t p)
      : p_(p), rows_(limits.size()), normals_(std::move(normals)), limits_(std::move(limits)) {
    for (std::size_t face = 0; face < 2 * p_; ++face) {
      for (std::size_t i = 0; i < p_; ++i) normals_.emplace_back(face / 2 != i ? 0 : face % 2 == 0 ? 1 : -1);
      limits_.emplace_back(1);
    }
  }

  SimplexOutcome solve(const std::vector<Number>& function, const Rules& rules) {
    start(function);
    for (int pivots = 0; pivots < rules.most_pivots; ++pivots) {
      const std::size_t row = entering(rules);
      if (row == limits_.size()) return SimplexOutcome::kOptimal;
      if (!pivot(row, rules)) {
        entered_ = row;
        return SimplexOutcome::kInfeasible;
      }
    }
    return SimplexOutcome::kStopped;
  }

  /// Where the rows of the basis hold with equality: after kOptimal, a maximiser.
  std::vector<Number> point() const {
    std::vector<Number> result(p_, Number(0));
    for (std::size_t j = 0; j < p_; ++j) {
      for (std::size_t i = 0; i < p_; ++i) result[i] += limits_[basis_[j]] * inverse_[j * p_ + i];
    }
    return result;
  }

  /// Nonnegative multipliers of rows, without faces of the box: of the function at the optimum, or of a contradiction.
  std::vector<std::pair<std::size_t, Number>> multipliers(SimplexOutcome outcome) const {
    std::vector<std::pair<std::size_t, Number>> result;
    if (outcome == SimplexOutcome::kInfeasible && entered_ < rows_) result.emplace_back(entered_, Number(1));
    for (std::size_t j = 0; j < p_; ++j) {
      const Number weight = outcome == SimplexOutcome::kInfeasible ? Number(-alpha_[j]) : dual_[j];
      if (basis_[j] < rows_ && weight > Number(0)) result.emplace_back(basis_[j], weight);
    }
    return result;
  }

 private:
  /// The vertex of the box at which the function is greatest is dual feasible.
  void start(const std::vector<Number>& function) {
    basis_.assign(p_, 0);
    inverse_.assign(p_ * p_, Number(0));
    dual_.assign(p_, Number(0));
    alpha_.assign(p_, Number(0));
    for (std::size_t i = 0; i < p_; ++i) {
      const bool falls = function[i] < Number(0);
      basis_[i] = rows_ + 2 * i + (falls ? 1 : 0);
      inverse_[i * p_ + i] = Number(falls ? -1 : 1);
      dual_[i] = falls ? Number(-function[i]) : function[i];
    }
  }

  Number product(std::size_t row, const Number* vector) const {
    Number sum(0);
    for (std::size_t i = 0; i < p_; ++i) sum += normals_[row * p_ + i] * vector[i];
    return sum;
  }

  /// The row that enters the basis; the number of all rows where none is violated.
  std::size_t entering(const Rules& rules) const {
    const std::vector<Number> reached = point();
    std::size_t worst = limits_.size();
    Number violation = rules.feasible;
    for (std::size_t row = 0; row < limits_.size(); ++row) {
      const Number beyond = product(row, reached.data()) - limits_[row];
      if (!(beyond > violation)) continue;
      worst = row;
      violation = beyond;
      if (rules.takes_first) break;
    }
    return worst;
  }

  /// False where no row can leave: the rows of the basis and this one contradict.
  bool pivot(std::size_t row, const Rules& rules) {
    std::size_t leaving = p_;
    Number least(0);
    for (std::size_t j = 0; j < p_; ++j) {
      alpha_[j] = product(row, inverse_.data() + j * p_);
      if (!(alpha_[j] > rules.pivot)) continue;
      const Number ratio = dual_[j] / alpha_[j];
      const bool is_tie = leaving != p_ && ratio == least && basis_[j] < basis_[leaving];
      if (leaving == p_ || ratio < least || is_tie) {
        leaving = j;
        least = ratio;
      }
    }
    if (leaving == p_) return false;
    for (std::size_t i = 0; i < p_; ++i) inverse_[leaving * p_ + i] /= alpha_[leaving];
    for (std::size_t j = 0; j < p_; ++j) {
      if (j == leaving) continue;
      for (std::size_t i = 0; i < p_; ++i) inverse_[j * p_ + i] -= alpha_[j] * inverse_[leaving * p_ + i];
      dual_[j] -= alpha_[j] * least;
      if (dual_[j] < Number(0)) dual_[j] = Number(0);
    }
    dual_[leaving] = least;
    basis_[leaving] = row;
    return true;
  }

  std::size_t p_, rows_, entered_ = 0;
  // Rows of the program, then the faces of the box: upper and lower of each variable in turn.
  std::vector<Number> normals_, limits_;
  // Constraints that hold with equality.
  std::vector<std::size_t> basis_;
  // Inverse of the basis' normals, column by column.
  std::vector<Number> inverse_;
  std::vector<Number> dual_, alpha_;
};

}  // namespace checker
