#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "lp/dictionary_kernels.hpp"
#include "lp/tolerances.hpp"

namespace polyfly {

/// Simplex dictionary of {t in R^N : a_i . t <= b_i}: each slack s_i = b_i - a_i . t, and each coordinate
/// t_q, as an affine function of the N quantities that are zero at the current vertex,
///
///     s_i = row[0] + sum_j row[1 + j] x_j,   x_j = slack of row nonbasic(j).
///
/// Free columns (before the first vertex is reached) are displacements from the starting point. Rows that are
/// not zero at the vertex stand in places 0 .. size - 1, in no order; the numbers of one column lie side by
/// side, for the processor's sake.
template <int N>
class Dictionary {
 public:
  using Row = std::array<double, N + 1>;

  static constexpr int kStallLimit = 12;    // degenerate pivots before Bland's rule
  static constexpr int kPivotLimit = 4000;  // per optimisation; never met but on numerical breakdown
  static constexpr double kGrowing = -1.0;  // directions of a column
  static constexpr double kShrinking = 1.0;

  /// Stands at `point`, which must satisfy every row, and walks to a vertex.
  bool start(const double* rows, int count, const double* point) {
    startFree(rows, count, point);
    for (int j = 0; j < N; ++j) {
      if (!enterFree(j)) return false;
    }
    return true;
  }

  /// Stands at `point`, which must satisfy every row. All columns are free.
  void startFree(const double* rows, int count, const double* point) {
    prepare(count);
    for (int i = 0; i < count; ++i) {
      const double* row = rows + static_cast<std::ptrdiff_t>(i) * (N + 1);
      double value = row[N];
      for (int j = 0; j < N; ++j) {
        value -= row[j] * point[j];
        at(i, j + 1) = -row[j];
      }
      at(i, 0) = std::max(value, 0.0);
      row_[i] = place_[i] = i;
    }
    coordinates_.fill(0.0);
    for (int q = 0; q < N; ++q) {
      coordinates_[q] = point[q];
      coordinates_[(q + 1) * kCoordinates + q] = 1.0;
      nonbasic_[q] = -1;
    }
    free_ = N;
  }

  /// For balls in {t in R^(N - 1) : a_i . t <= b_i}, whose first rows are t_j <= 1 and -t_j <= 1 in turn:
  /// coordinates are the centre and then the radius. Stands at the largest ball of the box, which no ball
  /// that the other rows allow exceeds; their slacks may be negative.
  void startInBox(const double* rows, int count) {
    static_assert(N > 1, "a ball has a radius and at least one coordinate");
    prepare(count);
    size_ = free_ = 0;
    for (int j = 0; j < N; ++j) {
      nonbasic_[j] = j < 2 ? j : 2 * j - 2;
      place_[nonbasic_[j]] = -1 - j;
    }
    for (int i = 0; i < count; ++i) {
      if (i < 2 || (i % 2 == 0 && i < 2 * N - 2)) continue;  // zero here
      const double* row = rows + static_cast<std::ptrdiff_t>(i) * N;
      double others = 0.0;
      for (int j = 1; j + 1 < N; ++j) {
        others += row[j];
        at(size_, j + 2) = row[j];
      }
      at(size_, 0) = row[N - 1] - 1.0;
      at(size_, 1) = 0.5 * (1.0 - others + row[0]);
      at(size_, 2) = 0.5 * (1.0 - others - row[0]);
      append(i);
    }
    coordinates_.fill(0.0);
    for (int q = 0; q < N;
         ++q) {  // t_0 = (x_1 - x_0) / 2, t_q = (x_0 + x_1) / 2 - x_(q+1), r = 1 - (x_0 + x_1) / 2
      const bool radius = q + 1 == N;
      coordinates_[kCoordinates + q] = q == 0 || radius ? -0.5 : 0.5;
      coordinates_[2 * kCoordinates + q] = radius ? -0.5 : 0.5;
      if (q > 0 && !radius) coordinates_[(q + 2) * kCoordinates + q] = -1.0;
    }
    coordinates_[N - 1] = 1.0;
  }

  /// Stands where N rows are zero. They are among the rows and, behind these, the sides of the box [-1, 1]^N: t_j <= 1 and
  /// -t_j <= 1 in turn. Everything is computed from factors of these rows. Slacks may be negative. False: they have no
  /// common point in doubles.
  bool startAt(const double* rows, int count, const std::array<int, N>& basis) {
    Square normals(N, N);
    Column limits(N);
    for (int j = 0; j < N; ++j) {
      const Row row = rowOrSide(rows, count, basis[j]);
      for (int q = 0; q < N; ++q) normals(j, q) = row[q];
      limits(j) = row[N];
    }
    const Eigen::PartialPivLU<Square> factors(normals);
    const Column vertex = factors.solve(limits);
    const Square inverse = factors.inverse();
    if (!vertex.allFinite() || !inverse.allFinite()) return false;
    for (int q = 0; q < N; ++q) {
      coordinates_[q] = vertex(q);
      for (int j = 0; j < N; ++j) coordinates_[(j + 1) * kCoordinates + q] = -inverse(q, j);
    }
    prepare(count + 2 * N);
    size_ = free_ = 0;
    std::fill(place_.begin(), place_.end(), kRemoved);
    for (int j = 0; j < N; ++j) {
      nonbasic_[j] = basis[j];
      place_[basis[j]] = -1 - j;
    }
    for (int i = 0; i < count + 2 * N; ++i) {
      if (place_[i] != kRemoved) continue;
      const Row row = rowOrSide(rows, count, i);
      for (int k = 0; k <= N; ++k) {
        at(size_, k) = k == 0 ? row[N] : 0.0;
        for (int q = 0; q < N; ++q) at(size_, k) -= row[q] * coordinate(q, k);
      }
      append(i);
    }
    return true;
  }

  /// Of the rows that are not zero here, the place of that which falls short most; -1: none does by more than
  /// `tolerance`.
  int worstPlace(double tolerance) const {
    int worst = -1;
    double least = -tolerance;
    for (int i = 0; i < size_; ++i) {
      if (columns_[i] >= least) continue;
      least = columns_[i];
      worst = i;
    }
    return worst;
  }

  int size() const { return size_; }
  int rowAt(int place) const { return row_[place]; }
  int place(int row) const { return place_[row]; }  ///< negative: zero at the vertex, or removed
  /// Column of a row that is zero at the vertex.
  int column(int row) const { return -1 - place_[row]; }
  int nonbasic(int j) const { return nonbasic_[j]; }
  /// No column is free.
  bool isVertex() const { return free_ == 0; }
  /// Coefficient of column k (0: the constant) in t_q.
  double coordinate(int q, int k) const { return coordinates_[k * kCoordinates + q]; }
  unsigned long long pivots() const { return pivots_; }

  double value(int place) const { return columns_[place]; }

  Row slack(int place) const {
    Row row;
    for (int k = 0; k <= N; ++k) row[k] = columns_[k * stride_ + place];
    return row;
  }

  /// The places whose coefficients are all at least -kPivot, ascending, and how many; valid until the next
  /// call.
  const int* growingPlaces(int& found) {
    found = static_cast<int>(placesAbove(columns_.data() + stride_, stride_,
                                         padded(static_cast<std::size_t>(size_)), N, -tolerance::kPivot,
                                         above_.data()));
    // Places in the padding are left out.
    while (found > 0 && above_[found - 1] >= size_) --found;
    return above_.data();
  }

  /// The row at `place` is implied by others: it leaves, and the last one takes its place.
  void remove(int place) {
    const int row = row_[place];
    vacate(place);
    place_[row] = kRemoved;
  }

  /// How far x_j can move in `direction`, and the place of the row that stops it; the row at `except` does
  /// not stop it (negative: all do).
  Blocking ratio(int j, double direction, int except = -1) {
    const std::size_t count = padded(static_cast<std::size_t>(size_));
    const std::size_t left_out = except < 0 ? count : static_cast<std::size_t>(except);
    return leastRatio(columns_.data(), columns_.data() + (j + 1) * stride_, direction, tolerance::kPivot,
                      tolerance::kRatioTie, left_out, count, quotient_.data());
  }

  /// The row at `place` becomes zero in place of column j.
  void pivot(int place, int j) {
    ++pivots_;
    const Row source = slack(place);
    const double inverse = 1.0 / source[j + 1];
    Row replacement;  // x_j in terms of the new columns
    for (int k = 0; k <= N; ++k) replacement[k] = -source[k] * inverse;
    replacement[j + 1] = inverse;
    pivotColumns(columns_.data(), stride_, padded(static_cast<std::size_t>(size_)), N + 1, replacement.data(),
                 static_cast<std::size_t>(j) + 1);
    pivotColumns(coordinates_.data(), kCoordinates, kCoordinates, N + 1, replacement.data(),
                 static_cast<std::size_t>(j) + 1);
    const int entering = row_[place];
    const int leaving = nonbasic_[j];
    if (leaving >= 0) {
      for (int k = 0; k <= N; ++k) at(place, k) = replacement[k];
      row_[place] = leaving;
      place_[leaving] = place;
    } else {
      vacate(place);
      --free_;
    }
    nonbasic_[j] = entering;
    place_[entering] = -1 - j;
  }

  /// How far the vertex lies from the rows that are zero there, relative to their bounds above 1: what pivots lost by
  /// rounding. `rows` as at the start. Not a number counts as infinite.
  double drift(const double* rows) const {
    double most = 0.0;
    for (int j = 0; j < N; ++j) {
      if (nonbasic_[j] < 0) continue;
      const double* row = rows + static_cast<std::ptrdiff_t>(nonbasic_[j]) * (N + 1);
      double distance = -row[N];
      for (int q = 0; q < N; ++q) distance += row[q] * coordinate(q, 0);
      if (std::isnan(distance)) return std::numeric_limits<double>::infinity();
      most = std::max(most, std::abs(distance) / std::max(1.0, std::abs(row[N])));
    }
    return most;
  }

  /// The vertex moved along column j by `step`.
  void point(int j, double step, double* out) const {
    for (int q = 0; q < N; ++q) out[q] = coordinate(q, 0) + step * coordinate(q, j + 1);
  }

  /// Column along which `objective` falls: steepest, or the first row index by Bland's rule; -1 at the
  /// optimum.
  int fallingColumn(const Row& objective, bool bland) const {
    int best = -1;
    double steepest = -tolerance::kPivot;
    for (int j = 0; j < N; ++j) {
      const double slope = objective[j + 1];
      if (slope >= -tolerance::kPivot) continue;
      if (bland ? (best < 0 || nonbasic_[j] < nonbasic_[best]) : slope < steepest) {
        steepest = slope;
        best = j;
      }
    }
    return best;
  }

  /// As fallingColumn, where free columns may be left: `objective` falls along those in one of both directions. The
  /// steepest; `direction` receives kGrowing or kShrinking.
  int steepestColumn(const Row& objective, double& direction) const {
    int best = -1;
    double steepest = tolerance::kPivot;
    for (int j = 0; j < N; ++j) {
      const double slope = objective[j + 1];
      const double fall = nonbasic_[j] < 0 ? std::abs(slope) : -slope;
      if (fall <= steepest) continue;
      steepest = fall;
      best = j;
      direction = slope < 0.0 ? kGrowing : kShrinking;
    }
    return best;
  }

 private:
  // Of a size that is not known to Eigen: it would unroll each N.
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, N, N>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, N, 1>;

  static constexpr std::size_t kCoordinates = padded(N);  // stride of their columns
  static constexpr int kRemoved = std::numeric_limits<int>::min();

  void prepare(int count) {
    size_ = count;
    stride_ = padded(static_cast<std::size_t>(count));
    columns_.assign((N + 1) * stride_, 0.0);
    quotient_.resize(stride_);
    above_.resize(stride_);
    row_.resize(static_cast<std::size_t>(count));
    place_.resize(static_cast<std::size_t>(count));
  }

  // The numbers of the row stand at the first free place.
  void append(int row) {
    row_[size_] = row;
    place_[row] = size_++;
  }

  static Row rowOrSide(const double* rows, int count, int index) {
    Row row;
    if (index < count) {
      std::copy_n(rows + static_cast<std::ptrdiff_t>(index) * (N + 1), N + 1, row.begin());
    } else {
      row.fill(0.0);
      row[(index - count) / 2] = (index - count) % 2 == 0 ? 1.0 : -1.0;
      row[N] = 1.0;
    }
    return row;
  }

  double& at(int place, int k) { return columns_[k * stride_ + place]; }

  // The last row moves to `place`; what it leaves behind is zero, as the padding is.
  void vacate(int place) {
    const int last = --size_;
    for (int k = 0; k <= N; ++k) {
      at(place, k) = at(last, k);
      at(last, k) = 0.0;
    }
    row_[place] = row_[last];
    place_[row_[place]] = place;
  }

  // Replaces a free column by a row that blocks it, on the side whose pivot is the safer.
  bool enterFree(int j) {
    const int up = ratio(j, kGrowing).place;
    const int down = ratio(j, kShrinking).place;
    if (up < 0 && down < 0) return false;
    const bool take_up = down < 0 || (up >= 0 && std::abs(at(up, j + 1)) >= std::abs(at(down, j + 1)));
    pivot(take_up ? up : down, j);
    return true;
  }

  int size_ = 0;
  int free_ = 0;
  std::size_t stride_ = 0;
  unsigned long long pivots_ = 0;
  // Column of constants, then the columns of the coefficients of each x_j.
  std::vector<double> columns_;
  // Work space.
  std::vector<double> quotient_;
  // Work space.
  std::vector<int> above_;
  // Row at each place.
  std::vector<int> row_;
  // Place of each row, or -1 - column, or kRemoved.
  std::vector<int> place_;
  // Coordinates, in the layout of columns_.
  std::array<double, (N + 1) * kCoordinates> coordinates_{};
  std::array<int, N> nonbasic_{};
};

}  // namespace polyfly
