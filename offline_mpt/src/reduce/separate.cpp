#include "reduce/separate.hpp"

#include <algorithm>
#include <cmath>

#include "reduce/tolerances.hpp"

namespace polyfly {
namespace {

// Rounds of the search for points that a plane must respect, at most.
constexpr int kRounds = 400;

using Pieces = std::vector<ConvexCell>;

/// A plane between two sets of polytopes with the greatest margin, by the points of theirs that come nearest:
/// max m  s.t.  a . v - c >= m on the first, <= -m on the second, |a_j| <= 1.
class Separator {
 public:
  Separator(CellGeometry& geometry, std::uint64_t most_steps)
      : steps_left_(most_steps),
        geometry_(geometry),
        p_(static_cast<std::size_t>(geometry.planes().p)),
        solver_(geometry.planes().p + 2) {}

  /// Whether no step is left: then `find` finds nothing.
  bool isExhausted() const { return steps_left_ == 0; }

  /// plane: a . t <= c holds on `below` and nowhere on `above`. False if there is none.
  bool find(Pieces& above, Pieces& below, std::vector<double>& plane) {
    rows_.clear();
    addBounds();
    for (const ConvexCell& piece : above) addPoint(piece.centre.data(), -1.0);
    for (const ConvexCell& piece : below) addPoint(piece.centre.data(), 1.0);
    for (int round = 0; round < kRounds; ++round) {
      double margin = 0.0;
      if (!solve(plane, margin) || margin < tolerance::kPlaneMargin) return false;
      const bool above_kept = respects(above, plane, margin, -1.0);
      const bool below_kept = respects(below, plane, margin, 1.0);
      if (above_kept && below_kept) return true;
    }
    return false;
  }

 private:
  bool takeStep() {
    if (steps_left_ == 0) return false;
    --steps_left_;
    return true;
  }

  void addRow(const std::vector<double>& coefficients, double bound) {
    double squared = 0.0;
    for (const double value : coefficients) squared += value * value;
    const double factor = 1.0 / std::sqrt(squared);
    for (const double value : coefficients) rows_.push_back(factor * value);
    rows_.push_back(factor * bound);
  }

  void addBounds() {
    for (std::size_t k = 0; k < p_ + 2; ++k) {
      std::vector<double> unit(p_ + 2, 0.0);
      for (const double side : {1.0, -1.0}) {
        unit[k] = side;
        addRow(unit, k < p_ ? 1.0 : 4.0 * static_cast<double>(p_ + 1));
      }
    }
  }

  /// side (a . v - c) + m <= 0
  void addPoint(const double* point, double side) {
    std::vector<double> row(p_ + 2);
    for (std::size_t j = 0; j < p_; ++j) row[j] = side * point[j];
    row[p_] = -side;
    row[p_ + 1] = 1.0;
    addRow(row, 0.0);
  }

  bool solve(std::vector<double>& plane, double& margin) {
    std::vector<double> start(p_ + 2, 0.0), direction(p_ + 2, 0.0), best(p_ + 2);
    start[p_ + 1] = -1.0;
    direction[p_ + 1] = 1.0;
    const int count = static_cast<int>(rows_.size() / (p_ + 3));
    if (!takeStep() || !solver_.support(rows_.data(), count, start.data(), direction.data(), best.data()))
      return false;
    double squared = 0.0;
    for (std::size_t j = 0; j < p_; ++j) squared += best[j] * best[j];
    if (squared == 0.0) return false;
    const double factor = 1.0 / std::sqrt(squared);
    plane.assign(best.begin(), best.begin() + static_cast<std::ptrdiff_t>(p_) + 1);
    for (double& value : plane) value *= factor;
    margin = factor * best[p_ + 1];
    return true;
  }

  /// Adds the point of each piece that comes nearest to the plane, or lies beyond it.
  bool respects(Pieces& pieces, const std::vector<double>& plane, double margin, double side) {
    bool kept = true;
    std::vector<double> direction(plane.begin(), plane.end() - 1), point(p_);
    for (double& value : direction) value *= side;
    for (ConvexCell& piece : pieces) {
      if (!takeStep() || !geometry_.support(piece, direction.data(), point.data())) return false;
      double distance = -plane[p_];
      for (std::size_t j = 0; j < p_; ++j) distance += plane[j] * point[j];
      if (side * distance <= -tolerance::kKeptMargin * margin) continue;
      addPoint(point.data(), side);
      kept = false;
    }
    return kept;
  }

  std::uint64_t steps_left_;
  CellGeometry& geometry_;
  std::size_t p_;
  PolytopeSolver solver_;
  std::vector<double> rows_;
};

class PieceSplitter {
 public:
  PieceSplitter(CellGeometry& geometry, ScaledPlanes& planes, const ConvexCell& domain, std::size_t limit,
                std::uint64_t most_steps)
      : geometry_(geometry),
        planes_(planes),
        domain_(domain),
        limit_(limit),
        separator_(geometry, most_steps) {}

  Separation run(Pieces upper, Pieces lower) {
    RowList path;
    std::vector<double> plane;
    while (!upper.empty() && !lower.empty()) {
      if (result_.fallbacks.size() + 2 > limit_) return result_;
      if (separator_.find(upper, lower, plane)) {
        const std::int32_t row = addPlane(plane);
        addPart(path, -row, true);
        addPart(path, row, false);
        result_.done = true;
        return result_;
      }
      const bool is_cut = cutOff(upper, lower, path);
      result_.limited = separator_.isExhausted();
      if (!is_cut || result_.limited) return result_;
    }
    if (!upper.empty() || !lower.empty()) addPart(path, 0, !upper.empty());
    result_.done = true;
    return result_;
  }

 private:
  /// The plane with most pieces of one kind on one side and all of the other kind on the other. What lies on
  /// the side of one kind becomes a part.
  bool cutOff(Pieces& upper, Pieces& lower, RowList& path) {
    std::vector<double> upper_plane, lower_plane;
    const std::size_t from_upper = growSide(upper, lower, upper_plane);
    const std::size_t from_lower = growSide(lower, upper, lower_plane);
    if (from_upper == 0 && from_lower == 0) return false;
    const bool is_upper = from_upper >= from_lower;
    const std::int32_t row = addPlane(is_upper ? upper_plane : lower_plane);
    addPart(path, -row, is_upper);
    path.push_back(row);
    clip(upper, row);
    clip(lower, row);
    return true;
  }

  /// Adds pieces as long as a plane keeps them apart from all the others; returns how many.
  std::size_t growSide(const Pieces& pieces, Pieces& others, std::vector<double>& plane) {
    Pieces side;
    std::vector<double> attempt;
    for (const ConvexCell& piece : pieces) {
      side.push_back(piece);
      if (separator_.find(side, others, attempt)) {
        plane = attempt;
      } else {
        side.pop_back();
      }
    }
    return side.size();
  }

  std::int32_t addPlane(const std::vector<double>& plane) {
    planes_.planes.insert(planes_.planes.end(), plane.begin(), plane.end());
    ++result_.planes;
    return static_cast<std::int32_t>(planes_.planes.size() / plane.size());
  }

  void addPart(const RowList& path, std::int32_t last, bool upper) {
    Fallback part;
    part.upper = upper;
    part.piece.rows = domain_.rows;
    part.piece.rows.insert(part.piece.rows.end(), path.begin(), path.end());
    if (last != 0) part.piece.rows.push_back(last);
    part.piece.centre = domain_.centre;
    geometry_.describe(part.piece);
    if (part.piece.radius <= tolerance::kNoPiece) return;
    part.piece.rows = geometry_.minimal(part.piece, tolerance::kSharpFallback);
    result_.fallbacks.push_back(std::move(part));
  }

  void clip(Pieces& pieces, std::int32_t row) {
    Pieces kept;
    for (ConvexCell& piece : pieces) {
      if (!geometry_.holdsOn(row, piece, 0.0)) {
        piece.rows.push_back(row);
        piece.points.clear();
        geometry_.describe(piece);
        if (piece.radius <= tolerance::kNoPiece) continue;
      }
      kept.push_back(std::move(piece));
    }
    pieces = std::move(kept);
  }

  CellGeometry& geometry_;
  ScaledPlanes& planes_;
  const ConvexCell& domain_;
  std::size_t limit_;
  Separator separator_;
  Separation result_;
};

}  // namespace

ConvexCell domainOf(CellGeometry& geometry, std::vector<ConvexCell>& pieces, const RowList& box,
                    double slack) {
  RowList rows = box;
  for (const ConvexCell& piece : pieces) rows.insert(rows.end(), piece.rows.begin(), piece.rows.end());
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  ConvexCell domain;
  for (const std::int32_t row : rows) {
    const auto is_inside = [&](const ConvexCell& piece) {
      return geometry.planes().value(row, piece.centre.data()) <= slack;
    };
    if (!std::all_of(pieces.begin(), pieces.end(), is_inside)) continue;
    const auto is_held = [&](ConvexCell& piece) { return geometry.holdsOn(row, piece, slack); };
    if (std::all_of(pieces.begin(), pieces.end(), is_held)) domain.rows.push_back(row);
  }
  domain.centre = pieces.front().centre;
  geometry.describe(domain);
  domain.rows = geometry.minimal(domain, tolerance::kSharpFallback);
  return domain;
}

Separation separate(CellGeometry& geometry, ScaledPlanes& planes, const ConvexCell& domain,
                    const std::vector<ConvexCell>& upper, const std::vector<ConvexCell>& lower,
                    std::size_t limit, std::uint64_t most_steps) {
  return PieceSplitter(geometry, planes, domain, limit, most_steps).run(upper, lower);
}

}  // namespace polyfly
