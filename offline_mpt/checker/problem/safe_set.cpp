// The safe set of a safety filter: within the ranges, left by no admissible input, and never without one.
#include <algorithm>

#include "problem/filter_match.hpp"
#include "problem/filter_model.hpp"
#include "problem/polyhedron.hpp"

namespace checker {
namespace {

/// The greatest a x over x in [lower, upper].
Fraction greatestInRange(const Ball& a, const Fraction& lower, const Fraction& upper) {
  return std::max((a * Ball(lower)).upper(), (a * Ball(upper)).upper());
}

class SafeSet {
 public:
  explicit SafeSet(const FilterProblem& problem)
      : problem_(problem),
        model_(filterModel(problem)),
        n_(problem.size()),
        nu_(problem.inputCount()),
        set_(rowsOf(problem.H, problem.k)) {}

  void confirm(const Progress& progress) const {
    require(set_.hasPoint(), "the safe set is empty");
    for (std::size_t i = 0; i < problem_.H.rows; ++i) requireKept(i);
    requireWithinRanges();
    requireAnInput(progress);
  }

 private:
  static ExactHalfSpace rowOf(const Matrix& matrix, std::size_t i, const Fraction& bound) {
    ExactHalfSpace row{{}, bound};
    for (std::size_t j = 0; j < matrix.columns; ++j) row.a.push_back(matrix.at(i, j));
    return row;
  }

  static std::vector<ExactHalfSpace> rowsOf(const Matrix& matrix, const Matrix& bounds) {
    std::vector<ExactHalfSpace> rows;
    for (std::size_t i = 0; i < matrix.rows; ++i) rows.push_back(rowOf(matrix, i, bounds.at(i, 0)));
    return rows;
  }

  /// So the set is bounded, too.
  void requireWithinRanges() const {
    for (std::size_t j = 0; j < n_; ++j) {
      for (const int sign : {1, -1}) {
        ExactHalfSpace side{Vector(n_), sign > 0 ? model_.upper[j] : Fraction(-model_.lower[j])};
        side.a[j] = sign;
        require(set_.isWithin(side), "the safe set is not within the ranges less errors and excursions");
      }
    }
  }

  /// H_i xi+ <= k_i where G_i u <= b_i + M_i xi. For H_i (A xi + B u) = (G_i u - M_i xi) + (H_i A + M_i) xi +
  /// (H_i B - G_i) u, of which the first term is at most b_i, and the others have little left to multiply.
  void requireKept(std::size_t i) const {
    BallMatrix h(1, n_);
    for (std::size_t j = 0; j < n_; ++j) h.at(0, j) = Ball(problem_.H.at(i, j));
    const BallMatrix on_xi = h * model_.A, on_u = h * model_.B;
    Fraction next = problem_.b.at(i, 0) + (h * model_.c).at(0, 0).upper();
    for (std::size_t j = 0; j < n_; ++j) {
      next += greatestInRange(on_xi.at(0, j) + Ball(problem_.M.at(i, j)), model_.lower[j], model_.upper[j]);
      next += abs(problem_.H.at(i, j)) * (model_.W[j] + model_.slack[j]);
    }
    for (std::size_t j = 0; j < nu_; ++j)
      next += greatestInRange(on_u.at(0, j) - Ball(problem_.G.at(i, j)), Fraction(problem_.inputs[j].first),
                              Fraction(problem_.inputs[j].second));
    require(next <= problem_.k.at(i, 0),
            "row " + std::to_string(i) + " of G, b, M does not keep row " + std::to_string(i) + " of H, k");
  }

  /// Of (xi, u), the inputs are eliminated one by one. What is left of the rows must hold in the set.
  void requireAnInput(const Progress& progress) const {
    std::vector<ExactHalfSpace> rows = set_.rows();
    for (ExactHalfSpace& row : rows) row.a.resize(n_ + nu_);
    for (std::size_t i = 0; i < problem_.G.rows; ++i) {
      ExactHalfSpace row = rowOf(problem_.M, i, problem_.b.at(i, 0));
      for (Fraction& value : row.a) value = -value;
      for (std::size_t j = 0; j < nu_; ++j) row.a.push_back(problem_.G.at(i, j));
      rows.push_back(std::move(row));
    }
    for (std::size_t j = 0; j < nu_; ++j) {
      for (const int sign : {1, -1}) {
        rows.push_back(
            {Vector(n_ + nu_), Fraction(sign > 0 ? problem_.inputs[j].second : -problem_.inputs[j].first)});
        rows.back().a[n_ + j] = sign;
      }
    }
    for (std::size_t j = 0; j < nu_; ++j) {
      if (j > 0) rows = withoutImplied(std::move(rows));
      rows = withoutEntry(rows, n_ + j);
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (progress) progress("inputs of the safe set, row", i, rows.size());
      ExactHalfSpace& row = rows[i];
      row.a.resize(n_);
      require(set_.isWithin(row), "a state of the safe set has no admissible input");
    }
  }

  const FilterProblem& problem_;
  const FilterModel model_;
  const std::size_t n_, nu_;
  const Polyhedron set_;
};

}  // namespace

void confirmSafeSet(const FilterProblem& problem, const Progress& progress) {
  SafeSet(problem).confirm(progress);
}

}  // namespace checker
