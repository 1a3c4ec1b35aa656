#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "lp/polytope.hpp"

namespace polyfly {

class RegionMap;

/// Rows as MapContent::rows has them: i + 1 is plane i, -(i + 1) the same with both sides negated.
using RowList = std::vector<std::int32_t>;

/// Planes in scaled parameters t, |t_j| <= 1: p + 1 numbers (a, b) each, the half-space a . t <= b, |a| = 1
/// up to rounding.
struct ScaledPlanes {
  int p = 0;
  std::vector<double> planes;

  static ScaledPlanes of(const RegionMap& map);
  /// Rows of the box's 2 p sides; planes that are missing are added.
  RowList addBox();
  /// Appends a half-space, its bound moved outwards by `slack`.
  void append(std::int32_t row, double slack, std::vector<double>& out) const;
  /// a . t - b, or its opposite for a negated row.
  double value(std::int32_t row, const double* point) const;
};

/// A polytope in t: its rows, and the box.
struct ConvexCell {
  RowList rows;
  /// Centre of the largest ball.
  std::vector<double> centre;
  /// Radius of the largest ball. <= 0: no interior.
  double radius = 0.0;
  /// Some extreme points.
  std::vector<double> points;
};

/// What questions throw once ReduceOptions::stop is set.
struct ReductionStopped {};

/// Decisions about polytopes by linear programming in floating point. What they say is proven afterwards, or
/// refused (verify_reduction.hpp). One object serves one thread.
class CellGeometry {
 public:
  /// `planes` and `stop` must outlive the object. Where `stop` is set, questions throw ReductionStopped.
  explicit CellGeometry(const ScaledPlanes& planes, const std::atomic<bool>* stop = nullptr);

  /// Fills centre and radius from the rows. A piece that the simplex fails on gets radius 0.
  void describe(ConvexCell& piece);

  /// The piece's point farthest along `direction` (p numbers), kept among its points. False when the simplex
  /// failed.
  bool support(ConvexCell& piece, const double* direction, double* point);

  /// Whether no point of the piece is farther outside `row` than `slack`.
  bool holdsOn(std::int32_t row, ConvexCell& piece, double slack);

  /// Whether a point lies in all half-spaces moved outwards by `slack`.
  bool holds(const RowList& rows, const double* point, double slack) const;

  /// The rows without which the piece would reach farther. It must have been described, and be bounded by its own rows.
  RowList minimal(const ConvexCell& piece);

  /// Whether the piece lies in the union of `cover`, their rows moved outwards by `slack`. Work is limited: a
  /// "no" may mean that the question was too long.
  bool covered(const ConvexCell& piece, const std::vector<const RowList*>& cover, double slack);

  const ScaledPlanes& planes() const { return planes_; }

 private:
  /// `held` are the rows that hold in the cell within `slack`, or beyond it where they are negated.
  bool coverCell(std::vector<double>& cell, RowList& held, std::vector<double> centre,
                 const std::vector<const RowList*>& cover, double slack);
  /// Radius of the largest ball in rows (p + 1 numbers each) and box; `centre` is a guess and receives the
  /// centre. 0 when the simplex failed.
  double ball(const std::vector<double>& rows, double* centre);
  void gather(const RowList& rows, double slack, std::vector<double>& out) const;
  void appendBox(std::vector<double>& out) const;
  void throwIfStopped() const;

  const ScaledPlanes& planes_;
  const std::atomic<bool>* stop_;
  std::size_t p_;
  PolytopeSolver solver_;
  std::vector<double> work_, ball_rows_;
  int cuts_left_ = 0;
};

}  // namespace polyfly
