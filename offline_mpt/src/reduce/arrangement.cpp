#include "reduce/arrangement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace polyfly {
namespace {

class Arranger {
 public:
  Arranger(CellGeometry& geometry, Arrangement& result)
      : geometry_(geometry), result_(result), p_(static_cast<std::size_t>(geometry.planes().p)) {}

  /// Divides every cell that the last plane cuts.
  void divide(std::size_t plane, double least_radius) {
    const std::int32_t row = result_.planes[plane];
    const std::size_t count = result_.cells.size();
    for (std::size_t i = 0; i < count; ++i) {
      ArrangementCell& cell = result_.cells[i];
      const bool above = geometry_.planes().value(row, cell.centre.data()) > 0.0;
      ArrangementCell other = cell;
      const std::uint64_t bit = std::uint64_t{1} << plane;
      (above ? cell : other).signs |= bit;
      const bool cell_left = fit(cell, plane, least_radius);
      const bool other_left = fit(other, plane, least_radius);
      if (!cell_left) cell = other;
      if (cell_left && other_left) result_.cells.push_back(std::move(other));
      if (!cell_left && !other_left) cell.radius = 0.0;
    }
    auto& cells = result_.cells;
    cells.erase(std::remove_if(cells.begin(), cells.end(),
                               [](const ArrangementCell& cell) { return cell.radius <= 0.0; }),
                cells.end());
  }

 private:
  /// Finds the cell's largest ball under planes 0 .. last.
  bool fit(ArrangementCell& cell, std::size_t last, double least_radius) {
    rows_.clear();
    for (const std::int32_t row : result_.hull) geometry_.planes().append(row, 0.0, rows_);
    for (std::size_t i = 0; i <= last; ++i) {
      const bool above = (cell.signs >> i & 1) != 0;
      geometry_.planes().append(above ? -result_.planes[i] : result_.planes[i], 0.0, rows_);
    }
    cell.radius = geometry_.ball(rows_, cell.centre.data());
    return cell.radius > least_radius;
  }

  CellGeometry& geometry_;
  Arrangement& result_;
  std::size_t p_;
  std::vector<double> rows_;
};

/// Planes that differ by less than the slack are one.
bool repeats(const ScaledPlanes& planes, const RowList& known, std::int32_t row, double slack) {
  std::vector<double> plane;
  planes.append(row, 0.0, plane);
  return std::any_of(known.begin(), known.end(), [&](std::int32_t other_row) {
    std::vector<double> other;
    planes.append(other_row, 0.0, other);
    double dot = 0.0;
    for (std::size_t j = 0; j + 1 < plane.size(); ++j) dot += plane[j] * other[j];
    const double sign = dot > 0.0 ? 1.0 : -1.0;
    double difference = 0.0;
    for (std::size_t j = 0; j < plane.size(); ++j) difference += std::abs(plane[j] - sign * other[j]);
    return difference <= slack;
  });
}

}  // namespace

std::optional<Arrangement> arrange(CellGeometry& geometry, std::vector<ConvexCell>& pieces,
                                   const RowList& box, double slack, const MergeLimits& limits) {
  Arrangement result;
  std::vector<std::size_t> all(pieces.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  ConvexCell hull = Envelopes(geometry, pieces, box, slack).of(all);
  result.hull = hull.rows;
  RowList rows;
  for (const ConvexCell& piece : pieces) {
    for (const std::int32_t row : piece.rows) rows.push_back(std::abs(row));
  }
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  const std::size_t most_planes = std::min(limits.planes, Arrangement::kMaxPlanes);
  for (const std::int32_t row : rows) {
    if (geometry.holdsOn(row, hull, slack) || geometry.holdsOn(-row, hull, slack)) continue;
    if (repeats(geometry.planes(), result.planes, row, slack)) continue;
    if (result.planes.size() == most_planes) return std::nullopt;
    result.planes.push_back(row);
  }
  result.cells.push_back({0, hull.centre, hull.radius, false});
  Arranger arranger(geometry, result);
  for (std::size_t i = 0; i < result.planes.size(); ++i) {
    arranger.divide(i, slack);
    if (result.cells.size() > limits.cells) return std::nullopt;
  }
  for (ArrangementCell& cell : result.cells) {
    cell.inside = std::any_of(pieces.begin(), pieces.end(), [&](const ConvexCell& piece) {
      return geometry.holds(piece.rows, cell.centre.data(), 0.0);
    });
  }
  return result;
}

}  // namespace polyfly
