#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace polyfly {

/// Simplex dictionary of {t in R^N : a_i . t <= b_i}: each slack s_i = b_i - a_i . t, and each coordinate
/// t_q, as an affine function of the N quantities that are zero at the current vertex,
///
///     s_i = row[0] + sum_j row[1 + j] x_j,   x_j = slack of row nonbasic(j).
///
/// Free columns (before the first vertex is reached) are displacements from the starting point.
template <int N>
class Dictionary {
 public:
  using Row = std::array<double, N + 1>;

  static constexpr double kPivot = 1e-10;   // coefficients below this do not count as a direction
  static constexpr int kStallLimit = 12;    // degenerate pivots before Bland's rule
  static constexpr int kPivotLimit = 4000;  // per optimisation; never met but on numerical breakdown
  static constexpr double kInfinite = std::numeric_limits<double>::infinity();

  /// Places the dictionary at `start`, which must satisfy every row, and walks to a vertex.
  bool start(const double* rows, int count, const double* point) {
    count_ = count;
    slack_.resize(count);
    slot_.assign(count, -1);
    enforced_.assign(count, 1);
    for (int i = 0; i < count; ++i) {
      const double* row = rows + static_cast<long>(i) * (N + 1);
      Row& out = slack_[i];
      double value = row[N];
      for (int j = 0; j < N; ++j) {
        value -= row[j] * point[j];
        out[j + 1] = -row[j];
      }
      out[0] = std::max(value, 0.0);
    }
    for (int q = 0; q < N; ++q) {
      coordinate_[q].fill(0.0);
      coordinate_[q][0] = point[q];
      coordinate_[q][q + 1] = 1.0;
      nonbasic_[q] = -1;
    }
    for (int j = 0; j < N; ++j) {
      if (!enterFree(j)) return false;
    }
    return true;
  }

  const Row& slack(int i) const { return slack_[i]; }
  const Row& coordinate(int q) const { return coordinate_[q]; }
  int nonbasic(int j) const { return nonbasic_[j]; }
  int slot(int i) const { return slot_[i]; }
  bool enforced(int i) const { return enforced_[i] != 0; }
  int count() const { return count_; }
  unsigned long long pivots() const { return pivots_; }

  /// Row i no longer bounds the polytope (it is implied by others).
  void relax(int i) { enforced_[i] = 0; }

  /// How far x_j can grow, and the row that stops it (-1: none); `except` does not stop it.
  double ratio(int j, int except, int& blocking) const {
    double step = kInfinite;
    double best_pivot = 0.0;
    blocking = -1;
    for (int i = 0; i < count_; ++i) {
      const double coefficient = slack_[i][j + 1];
      if (coefficient >= -kPivot || slot_[i] >= 0 || !enforced_[i] || i == except) continue;
      const double candidate = std::max(slack_[i][0], 0.0) / -coefficient;
      if (candidate < step - kTie || (candidate <= step + kTie && -coefficient > best_pivot)) {
        step = std::min(step, candidate);
        best_pivot = -coefficient;
        blocking = i;
      }
    }
    return step;
  }

  /// As ratio, for x_j shrinking below zero (row nonbasic(j) being violated).
  double ratioBelow(int j, int& blocking) const {
    double step = kInfinite;
    double best_pivot = 0.0;
    blocking = -1;
    for (int i = 0; i < count_; ++i) {
      const double coefficient = slack_[i][j + 1];
      if (coefficient <= kPivot || slot_[i] >= 0 || !enforced_[i]) continue;
      const double candidate = std::max(slack_[i][0], 0.0) / coefficient;
      if (candidate < step - kTie || (candidate <= step + kTie && coefficient > best_pivot)) {
        step = std::min(step, candidate);
        best_pivot = coefficient;
        blocking = i;
      }
    }
    return step;
  }

  /// Row `entering` becomes tight in place of column j.
  void pivot(int entering, int j) {
    ++pivots_;
    const Row source = slack_[entering];
    const double inverse = 1.0 / source[j + 1];
    Row replacement;  // x_j in terms of the new columns
    for (int k = 0; k <= N; ++k) replacement[k] = -source[k] * inverse;
    replacement[j + 1] = inverse;
    for (int i = 0; i < count_; ++i) substitute(slack_[i], replacement, j);
    for (int q = 0; q < N; ++q) substitute(coordinate_[q], replacement, j);
    const int leaving = nonbasic_[j];
    if (leaving >= 0) {
      slack_[leaving] = replacement;
      slot_[leaving] = -1;
    }
    nonbasic_[j] = entering;
    slot_[entering] = j;
    slack_[entering].fill(0.0);
    slack_[entering][j + 1] = 1.0;
  }

  /// The vertex moved along column j by `step`.
  void point(int j, double step, double* out) const {
    for (int q = 0; q < N; ++q) out[q] = coordinate_[q][0] + step * coordinate_[q][j + 1];
  }

  /// Column along which `objective` falls: steepest, or the first row index by Bland's rule; -1 at the
  /// optimum.
  int fallingColumn(const Row& objective, bool bland) const {
    int best = -1;
    double steepest = -kPivot;
    for (int j = 0; j < N; ++j) {
      const double slope = objective[j + 1];
      if (slope >= -kPivot) continue;
      if (bland ? (best < 0 || nonbasic_[j] < nonbasic_[best]) : slope < steepest) {
        steepest = slope;
        best = j;
      }
    }
    return best;
  }

 private:
  static constexpr double kTie = 1e-14;

  static void substitute(Row& row, const Row& replacement, int j) {
    const double factor = row[j + 1];
    if (factor == 0.0) return;
    row[j + 1] = 0.0;
    for (int k = 0; k <= N; ++k) row[k] += factor * replacement[k];
  }

  // Replaces a free column by a row that blocks it, on the side whose pivot is the safer.
  bool enterFree(int j) {
    int up = -1;
    int down = -1;
    ratio(j, -1, up);
    ratioBelow(j, down);
    if (up < 0 && down < 0) return false;
    const bool take_up =
        down < 0 || (up >= 0 && std::abs(slack_[up][j + 1]) >= std::abs(slack_[down][j + 1]));
    pivot(take_up ? up : down, j);
    return true;
  }

  int count_ = 0;
  unsigned long long pivots_ = 0;
  std::vector<Row> slack_;
  std::vector<int> slot_;
  std::vector<char> enforced_;
  std::array<Row, N> coordinate_{};
  std::array<int, N> nonbasic_{};
};

}  // namespace polyfly
