#include "tree/tree_cells.hpp"

#include <algorithm>

#include "support/in_parallel.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kPointsKept = 24;      // per member
constexpr std::size_t kManyRegions = 20000;  // above which the first points are those along the axes only

}  // namespace

TreeGeometry::TreeGeometry(const TreeRegions& regions, double side_tolerance, int threads,
                           const std::function<void(std::uint64_t, std::uint64_t)>& progress)
    : regions_(regions),
      kernels_(planeSidesFor(static_cast<std::size_t>(regions.p))),
      tolerance_(side_tolerance),
      low_(regions.centres.size()),
      high_(regions.centres.size()),
      members_(regions.rows.size()) {
  std::vector<PolytopeSolver> solvers;
  for (int k = 0; k < std::max(1, threads); ++k) solvers.emplace_back(regions_.p);
  std::vector<std::vector<double>> rows(solvers.size());
  inParallel(members_.size(), threads, nullptr, progress,
             [&](std::size_t thread, std::uint64_t r) { sample(r, solvers[thread], rows[thread]); });
}

void TreeGeometry::appendRow(std::int32_t row, std::vector<double>& rows) const {
  const std::size_t width = static_cast<std::size_t>(regions_.p) + 1;
  const double* plane = regions_.planes.data() + planeOf(row) * width;
  const double sign = row > 0 ? 1.0 : -1.0;
  for (std::size_t j = 0; j < width; ++j) rows.push_back(sign * plane[j]);
}

// Extreme points of a region: along the axes, which gives its bounding box, and along its own normals.
void TreeGeometry::sample(std::size_t region, PolytopeSolver& solver, std::vector<double>& rows) {
  const auto p = static_cast<std::size_t>(regions_.p);
  const double* centre = regions_.centres.data() + region * p;
  CellMember& member = members_[region];
  member.region = static_cast<std::uint32_t>(region);
  member.inner.assign(centre, centre + p);
  rows.clear();
  for (const std::int32_t row : regions_.rows[region]) appendRow(row, rows);
  std::vector<double> direction(p), point(p);
  const auto add = [&] {
    const int count = static_cast<int>(regions_.rows[region].size());
    if (!solver.support(rows.data(), count, centre, direction.data(), point.data())) return false;
    member.points.insert(member.points.end(), point.begin(), point.end());
    return true;
  };
  for (std::size_t j = 0; j < p; ++j) {
    std::fill(direction.begin(), direction.end(), 0.0);
    direction[j] = 1.0;
    high_[region * p + j] = add() ? point[j] : 1.0;
    direction[j] = -1.0;
    low_[region * p + j] = add() ? point[j] : -1.0;
  }
  if (regions_.rows.size() > kManyRegions) return;
  for (std::size_t row = 0; row < regions_.rows[region].size(); ++row) {
    for (std::size_t j = 0; j < p; ++j) direction[j] = -rows[row * (p + 1) + j];  // away from the facet
    add();
  }
}

unsigned TreeGeometry::boxSides(std::uint32_t region, std::size_t plane) const {
  const std::size_t p = parameters();
  return kernels_.ofBox(row(plane), low_.data() + region * p, high_.data() + region * p, tolerance_, p);
}

unsigned TreeGeometry::seenSides(const CellMember& member, std::size_t plane) const {
  const std::size_t p = parameters();
  const unsigned possible = boxSides(member.region, plane);
  const unsigned sides = kernels_.ofPoints(row(plane), member.inner.data(), 1, tolerance_, 3u, 0u, p);
  return kernels_.ofPoints(row(plane), member.points.data(), member.points.size() / p, tolerance_, possible,
                           sides, p);
}

CellSplitter::CellSplitter(const TreeGeometry& geometry)
    : geometry_(geometry),
      solver_(geometry.regions().p),
      point_(static_cast<std::size_t>(geometry.regions().p)) {}

unsigned CellSplitter::sides(CellMember& member, std::size_t plane, const std::vector<std::int32_t>& path) {
  const auto row = static_cast<std::int32_t>(plane) + 1;
  for (const std::int32_t own : geometry_.regions().rows[member.region]) {
    if (own == row) return kBelow;
    if (own == -row) return kAbove;
  }
  unsigned sides = geometry_.seenSides(member, plane);
  const unsigned open = geometry_.boxSides(member.region, plane) & ~sides;
  if ((open & kBelow) && reaches(member, -1.0, plane, path, kPointsKept)) sides |= kBelow;
  if ((open & kAbove) && reaches(member, 1.0, plane, path, kPointsKept)) sides |= kAbove;
  return sides;
}

// The member's point that is furthest out on one side of the plane.
bool CellSplitter::reaches(CellMember& member, double side, std::size_t plane,
                           const std::vector<std::int32_t>& path, std::size_t keep) {
  const TreeRegions& regions = geometry_.regions();
  const auto p = static_cast<std::size_t>(regions.p);
  rows_.clear();
  for (const std::int32_t own : regions.rows[member.region]) geometry_.appendRow(own, rows_);
  for (const std::int32_t step : path) geometry_.appendRow(step, rows_);
  const double* normal = regions.planes.data() + plane * (p + 1);
  std::vector<double> direction(normal, normal + p);
  for (double& entry : direction) entry *= side;
  const int count = static_cast<int>(rows_.size() / (p + 1));
  if (!solver_.support(rows_.data(), count, member.inner.data(), direction.data(), point_.data())) {
    return true;  // undecided: keep it on both sides
  }
  if (side * geometry_.distance(plane, point_.data()) <= geometry_.tolerance()) return false;
  if (member.points.size() < keep * p) {
    member.points.insert(member.points.end(), point_.begin(), point_.end());
  } else {
    std::copy(point_.begin(), point_.end(), member.points.end() - static_cast<std::ptrdiff_t>(p));
  }
  return true;
}

// The point that showed a side may have given way to that of a plane tried later. Without it the inner point
// would stay on the other side, and the part would seem to reach where it does not.
void CellSplitter::recall(CellMember& member, unsigned sides, std::size_t plane,
                          const std::vector<std::int32_t>& path) {
  const auto p = static_cast<std::size_t>(geometry_.regions().p);
  const unsigned open = sides & ~geometry_.seenSides(member, plane);
  const std::size_t all = member.points.size() / p + 2;
  if (open & kBelow) reaches(member, -1.0, plane, path, all);
  if (open & kAbove) reaches(member, 1.0, plane, path, all);
}

void CellSplitter::divide(CellMembers& members, std::size_t plane, const std::vector<std::int32_t>& path,
                          const std::vector<unsigned char>& sides, CellMembers& below, CellMembers& above) {
  const auto p = static_cast<std::size_t>(geometry_.regions().p);
  for (std::size_t i = 0; i < members.size(); ++i) {
    CellMember& member = members[i];
    if (sides[i] == 0) continue;  // nothing but a touch
    recall(member, sides[i], plane, path);
    if (sides[i] == kBelow || sides[i] == kAbove) {
      enter(member, sides[i] == kBelow ? -1.0 : 1.0, plane, member.points);
      (sides[i] == kBelow ? below : above).push_back(std::move(member));
      continue;
    }
    CellMember parts[2];
    for (std::size_t k = 0; k < member.points.size(); k += p) {
      const double* point = member.points.data() + k;
      const double value = geometry_.distance(plane, point);
      if (value <= 0.0) parts[0].points.insert(parts[0].points.end(), point, point + p);
      if (value >= 0.0) parts[1].points.insert(parts[1].points.end(), point, point + p);
    }
    for (CellMember& part : parts) {
      part.region = member.region;
      part.inner = member.inner;
    }
    enter(parts[0], -1.0, plane, member.points);
    enter(parts[1], 1.0, plane, member.points);
    below.push_back(std::move(parts[0]));
    above.push_back(std::move(parts[1]));
  }
}

// Moves the inner point, if it lies on the other side, to half-way between the plane and the point furthest
// out on this side: what lies between an inner point and one of the border is inside.
void CellSplitter::enter(CellMember& part, double side, std::size_t plane,
                         const std::vector<double>& points) const {
  const auto p = static_cast<std::size_t>(geometry_.regions().p);
  const double inner = side * geometry_.distance(plane, part.inner.data());
  const double* furthest = nullptr;
  double reach = 0.0;
  for (std::size_t k = 0; k < points.size(); k += p) {
    const double value = side * geometry_.distance(plane, points.data() + k);
    if (value <= reach) continue;
    reach = value;
    furthest = points.data() + k;
  }
  if (inner > 0.0 || furthest == nullptr) return;
  const double fraction = (0.5 * reach - inner) / (reach - inner);
  for (std::size_t j = 0; j < p; ++j) part.inner[j] += fraction * (furthest[j] - part.inner[j]);
}

}  // namespace polyfly
