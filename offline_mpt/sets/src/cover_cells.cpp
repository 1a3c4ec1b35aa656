#include "cover_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "region_maps/region_map.hpp"
#include "tolerances.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kPlanesTried = 48;  // planes weighed against each other to cut one cell

/// Least and greatest a . y - c over points, times sign.
struct Reach {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();
};

Reach reachOf(const std::vector<double>& points, const double* plane, double sign, int p) {
  Reach reach;
  for (std::size_t k = 0; k < points.size(); k += static_cast<std::size_t>(p)) {
    double value = -plane[p];
    for (int j = 0; j < p; ++j) value += plane[j] * points[k + static_cast<std::size_t>(j)];
    value *= sign;
    reach.least = std::min(reach.least, value);
    reach.greatest = std::max(reach.greatest, value);
  }
  return reach;
}

// Whether a plane has points of the cell strictly on both sides.
bool cuts(const CoverCell& cell, const CellPlane& plane) {
  bool in = false, out = false;
  for (const DoubleDescription::Ray& ray : cell.cone.rays()) {
    const Integer value = dot(plane.inside, ray.value);
    in = in || value > 0;
    out = out || value < 0;
    if (in && out) return true;
  }
  return false;
}

}  // namespace

CoverCell CoverCells::cell(DoubleDescription cone) const {
  CoverCell result{std::move(cone), {}};
  for (const DoubleDescription::Ray& ray : result.cone.rays()) {
    for (std::size_t j = 1; j < ray.value.size(); ++j)
      result.vertices.push_back(ratio(ray.value[j], ray.value[0]));
  }
  return result;
}

CoverCell CoverCells::part(const CoverCell& whole, const CellPlane& plane, bool inside) const {
  DoubleDescription cone = whole.cone;
  std::vector<Integer> row = plane.inside;
  if (!inside) {
    for (Integer& value : row) value = -value;
  }
  cone.add(row);
  return cell(std::move(cone));
}

// Of the map, p + 1: without the sign by which the region has them.
const double* CoverCells::numbers(std::uint32_t region, std::uint32_t row) const {
  const std::int32_t number = regions_.map().region(region).rows[row];
  return regions_.map().plane(static_cast<std::size_t>(std::abs(number)) - 1);
}

CellPlane CoverCells::plane(std::uint32_t region, std::uint32_t row, double move) const {
  CellPlane plane;
  plane.row = numbers(region, row);
  plane.sign = regions_.map().region(region).rows[row] > 0 ? 1.0 : -1.0;
  const ExactHalfSpace half_space = regions_.row(region, row);
  RationalVector values{half_space.b + Rational(move)};
  for (const Rational& value : half_space.a) values.emplace_back(-value);
  plane.inside = wholeNumbers(values);
  return plane;
}

std::vector<std::uint32_t> CoverCells::near(const CoverCell& cell) const {
  const int p = regions_.parameters();
  std::vector<std::uint32_t> result;
  for (const std::uint32_t region : regions_.shaped()) {
    bool apart = false;
    for (int j = 0; j < p && !apart; ++j) {
      std::vector<double> axis(static_cast<std::size_t>(p) + 1, 0.0);
      axis[static_cast<std::size_t>(j)] = 1.0;
      const Reach mine = reachOf(cell.vertices, axis.data(), 1.0, p);
      const Reach other = reachOf(regions_.shape(region), axis.data(), 1.0, p);
      apart = mine.least > other.greatest || other.least > mine.greatest;
    }
    if (!apart) result.push_back(region);
  }
  return result;
}

std::vector<std::uint32_t> CoverCells::reaching(const std::vector<std::uint32_t>& candidates,
                                                const CellPlane& plane, bool inside) const {
  if (plane.row == nullptr) return candidates;
  const double sign = inside ? plane.sign : -plane.sign;
  std::vector<std::uint32_t> result;
  for (const std::uint32_t region : candidates) {
    const Reach reach = reachOf(regions_.shape(region), plane.row, sign, regions_.parameters());
    if (reach.least < -tolerance::kReachesOver) result.push_back(region);
  }
  return result;
}

bool CoverCells::reachesOut(const CoverCell& cell, std::uint32_t region, double move) const {
  const RegionView view = regions_.map().region(region);
  for (std::uint32_t i = 0; i < view.row_count; ++i) {
    const double sign = view.rows[i] > 0 ? 1.0 : -1.0;
    const Reach reach = reachOf(cell.vertices, numbers(region, i), sign, regions_.parameters());
    if (reach.greatest > move + tolerance::kReachesOver) return true;
  }
  return false;
}

// Rows of candidates whose planes seem to cut the cell, each plane once.
std::vector<CoverCells::RowOf> CoverCells::cuttingRows(const CoverCell& cell,
                                                       const std::vector<std::uint32_t>& candidates) const {
  std::vector<RowOf> rows;
  std::vector<std::int32_t> seen;
  for (const std::uint32_t region : candidates) {
    const RegionView view = regions_.map().region(region);
    for (std::uint32_t i = 0; i < view.row_count; ++i) {
      const std::int32_t index = std::abs(view.rows[i]) - 1;
      if (std::find(seen.begin(), seen.end(), index) != seen.end()) continue;
      const Reach reach = reachOf(cell.vertices, numbers(region, i), 1.0, regions_.parameters());
      if (reach.least >= 0.0 || reach.greatest <= 0.0) continue;
      seen.push_back(index);
      rows.push_back({region, i});
    }
    if (rows.size() > 8 * kPlanesTried) break;
  }
  return rows;
}

std::optional<CellPlane> CoverCells::bestCut(const CoverCell& cell,
                                             const std::vector<std::uint32_t>& candidates) const {
  const int p = regions_.parameters();
  const std::vector<RowOf> rows = cuttingRows(cell, candidates);
  const std::size_t stride = rows.size() / kPlanesTried + 1;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  double widest = 0.0;
  std::optional<CellPlane> best;
  for (std::size_t k = 0; k < rows.size(); k += stride) {
    const double* row = numbers(rows[k].region, rows[k].row);
    std::size_t below = 0, above = 0;
    for (const std::uint32_t other : candidates) {
      const Reach reach = reachOf(regions_.shape(other), row, 1.0, p);
      below += reach.least < -tolerance::kReachesOver ? 1 : 0;
      above += reach.greatest > tolerance::kReachesOver ? 1 : 0;
    }
    const Reach reach = reachOf(cell.vertices, row, 1.0, p);
    const double width = std::min(-reach.least, reach.greatest);
    const std::size_t fuller = std::max(below, above);
    if (fuller > fewest || (fuller == fewest && width <= widest)) continue;
    CellPlane candidate = plane(rows[k].region, rows[k].row, 0.0);
    if (!cuts(cell, candidate)) continue;
    fewest = fuller;
    widest = width;
    best = std::move(candidate);
  }
  return best;
}

std::optional<CellPlane> CoverCells::anyCut(const CoverCell& cell) const {
  for (const double move : {0.0, regions_.tolerance()}) {
    for (std::uint32_t region = 0; region < regions_.count(); ++region) {
      if (std::optional<CellPlane> cut = cutOf(cell, region, move)) return cut;
    }
  }
  return std::nullopt;
}

// The first of a region's planes that cuts the cell; none where one of its half-spaces has nothing of it.
std::optional<CellPlane> CoverCells::cutOf(const CoverCell& cell, std::uint32_t region, double move) const {
  const RegionView view = regions_.map().region(region);
  std::optional<CellPlane> first;
  for (std::uint32_t i = 0; i < view.row_count; ++i) {
    const double sign = view.rows[i] > 0 ? 1.0 : -1.0;
    const Reach reach = reachOf(cell.vertices, numbers(region, i), sign, regions_.parameters());
    if (reach.least > regions_.tolerance() + tolerance::kReachesOver) return std::nullopt;
    if (first) continue;
    CellPlane candidate = plane(region, i, move);
    if (!cuts(cell, candidate)) continue;
    candidate.row = nullptr;
    first = std::move(candidate);
  }
  return first;
}

}  // namespace polyfly
