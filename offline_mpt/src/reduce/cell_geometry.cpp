#include "reduce/cell_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "reduce/tolerances.hpp"
#include "region_maps/region_map.hpp"
#include "tree/cell.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kPoints = 64;  // extreme points kept for each piece
constexpr int kCuts = 3000;          // cells that a question may be cut into

}  // namespace

ScaledPlanes ScaledPlanes::of(const RegionMap& map) {
  ScaledPlanes result;
  const std::size_t p = map.parameters().size();
  result.p = static_cast<int>(p);
  for (std::size_t i = 0; i < map.planeCount(); ++i) {
    const double* const plane = map.plane(i);
    double bound = plane[p];
    for (std::size_t j = 0; j < p; ++j) {
      const Signal& signal = map.parameters()[j];
      result.planes.push_back(plane[j] * 0.5 * (signal.upper - signal.lower));
      bound -= plane[j] * 0.5 * (signal.upper + signal.lower);
    }
    result.planes.push_back(bound);
  }
  return result;
}

void ScaledPlanes::append(std::int32_t row, double slack, std::vector<double>& out) const {
  const auto width = static_cast<std::size_t>(p) + 1;
  const double* const plane = planes.data() + planeOf(row) * width;
  const double sign = row > 0 ? 1.0 : -1.0;
  for (std::size_t j = 0; j < width; ++j) out.push_back(sign * plane[j]);
  out.back() += slack;
}

RowList ScaledPlanes::addBox() {
  const auto width = static_cast<std::size_t>(p) + 1;
  RowList rows;
  for (std::size_t side = 0; side < 2 * width - 2; ++side) {
    std::vector<double> plane(width, 0.0);
    plane[side / 2] = 1.0;
    plane.back() = side % 2 == 0 ? 1.0 : -1.0;
    std::size_t found = 0;
    for (; found < planes.size() / width; ++found) {
      const double* const other = planes.data() + found * width;
      const double sign = other[side / 2] > 0.0 ? 1.0 : -1.0;
      if (std::equal(plane.begin(), plane.end(), other,
                     [&](double a, double b) { return std::abs(a - sign * b) <= tolerance::kSameCellPlane; }))
        break;
    }
    if (found == planes.size() / width) planes.insert(planes.end(), plane.begin(), plane.end());
    const bool along = planes[found * width + side / 2] > 0.0;
    const auto number = static_cast<std::int32_t>(found) + 1;
    rows.push_back(along == (side % 2 == 0) ? number : -number);
  }
  return rows;
}

double ScaledPlanes::value(std::int32_t row, const double* point) const {
  const auto width = static_cast<std::size_t>(p) + 1;
  const double* const plane = planes.data() + planeOf(row) * width;
  double sum = -plane[p];
  for (int j = 0; j < p; ++j) sum += plane[j] * point[j];
  return row > 0 ? sum : -sum;
}

CellGeometry::CellGeometry(const ScaledPlanes& planes, const std::atomic<bool>* stop)
    : planes_(planes), stop_(stop), p_(static_cast<std::size_t>(planes.p)), solver_(planes.p) {}

void CellGeometry::throwIfStopped() const {
  if (stop_ != nullptr && stop_->load()) throw ReductionStopped();
}

void CellGeometry::appendBox(std::vector<double>& out) const {
  for (std::size_t k = 0; k < 2 * p_; ++k) {
    out.insert(out.end(), p_, 0.0);
    out[out.size() - p_ + k / 2] = k % 2 == 0 ? 1.0 : -1.0;
    out.push_back(1.0);
  }
}

void CellGeometry::gather(const RowList& rows, double slack, std::vector<double>& out) const {
  out.clear();
  for (const std::int32_t row : rows) planes_.append(row, slack, out);
  appendBox(out);
}

double CellGeometry::ball(const std::vector<double>& rows, double* centre) {
  throwIfStopped();
  ball_rows_ = rows;
  appendBox(ball_rows_);
  double radius = 0.0;
  const int count = static_cast<int>(ball_rows_.size() / (p_ + 1));
  if (!solver_.chebyshev(ball_rows_.data(), count, centre, radius)) return 0.0;
  return radius;
}

void CellGeometry::describe(ConvexCell& piece) {
  std::vector<double> rows;
  for (const std::int32_t row : piece.rows) planes_.append(row, 0.0, rows);
  if (piece.centre.empty()) piece.centre.assign(p_, 0.0);
  piece.radius = ball(rows, piece.centre.data());
}

bool CellGeometry::support(ConvexCell& piece, const double* direction, double* point) {
  throwIfStopped();
  gather(piece.rows, 0.0, work_);
  const int count = static_cast<int>(work_.size() / (p_ + 1));
  if (!solver_.support(work_.data(), count, piece.centre.data(), direction, point)) return false;
  if (piece.points.size() < kPoints * p_) piece.points.insert(piece.points.end(), point, point + p_);
  return true;
}

bool CellGeometry::holdsOn(std::int32_t row, ConvexCell& piece, double slack) {
  if (std::find(piece.rows.begin(), piece.rows.end(), row) != piece.rows.end()) return true;
  if (planes_.value(row, piece.centre.data()) > slack) return false;
  for (std::size_t i = 0; i < piece.points.size(); i += p_) {
    if (planes_.value(row, piece.points.data() + i) > slack) return false;
  }
  std::vector<double> normal;
  planes_.append(row, 0.0, normal);
  std::vector<double> point(p_);
  return support(piece, normal.data(), point.data()) && planes_.value(row, point.data()) <= slack;
}

bool CellGeometry::holds(const RowList& rows, const double* point, double slack) const {
  return std::all_of(rows.begin(), rows.end(),
                     [&](std::int32_t row) { return planes_.value(row, point) <= slack; });
}

RowList CellGeometry::minimal(const ConvexCell& piece) {
  work_.clear();
  for (const std::int32_t row : piece.rows) planes_.append(row, 0.0, work_);
  MinimalRows needed;
  const int count = static_cast<int>(piece.rows.size());
  if (!solver_.minimal(work_.data(), count, piece.centre.data(), tolerance::kNeededReach, needed))
    return piece.rows;
  RowList result;
  for (const int i : needed.facets) result.push_back(piece.rows[static_cast<std::size_t>(i)]);
  return result;
}

bool CellGeometry::covered(const ConvexCell& piece, const std::vector<const RowList*>& cover, double slack) {
  throwIfStopped();
  cuts_left_ = kCuts;
  std::vector<double> cell;
  for (const std::int32_t row : piece.rows) planes_.append(row, 0.0, cell);
  RowList held = piece.rows;
  return coverCell(cell, held, piece.centre, cover, slack);
}

// The part of the cell that lies outside one polytope is cut off row by row and must be covered by the
// others.
bool CellGeometry::coverCell(std::vector<double>& cell, RowList& held, std::vector<double> centre,
                             const std::vector<const RowList*>& cover, double slack) {
  const auto found = std::find_if(cover.begin(), cover.end(),
                                  [&](const RowList* rows) { return holds(*rows, centre.data(), slack); });
  if (found == cover.end() || --cuts_left_ < 0) return false;
  const std::vector<double> start = centre;
  const std::size_t size = cell.size(), held_size = held.size();
  for (const std::int32_t row : **found) {
    if (std::find(held.begin(), held.end(), row) != held.end()) continue;
    const std::size_t end = cell.size();
    planes_.append(-row, -slack, cell);
    centre = start;
    const bool cuts = ball(cell, centre.data()) > tolerance::kNoRest;
    held.push_back(-row);
    if (cuts && !coverCell(cell, held, centre, cover, slack)) return false;
    held.back() = row;
    cell.resize(end);
    // A row that cuts nothing off would only lengthen the programs that follow.
    if (cuts) planes_.append(row, slack, cell);
  }
  cell.resize(size);
  held.resize(held_size);
  return true;
}

}  // namespace polyfly
