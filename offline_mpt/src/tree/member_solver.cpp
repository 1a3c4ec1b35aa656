#include "tree/member_solver.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "polyfly_base/error.hpp"
#include "region_maps/format.hpp"
#include "tree/tolerances.hpp"

namespace polyfly {
namespace {

// Points kept per member besides those on its rows and walls.
constexpr std::size_t kOtherPoints = 4;

double sign(unsigned side) { return side == kBelow ? -1.0 : 1.0; }

}  // namespace

MemberSolver::MemberSolver(const TreeRegions& regions, double side_tolerance)
    : regions_(regions),
      tolerance_(side_tolerance),
      kernels_(planeSidesFor(static_cast<std::size_t>(regions.p))),
      solver_(regions.p),
      direction_(static_cast<std::size_t>(regions.p)),
      point_(static_cast<std::size_t>(regions.p)) {
  if (regions.centres.size() != regions.rows.size() * static_cast<std::size_t>(regions.p))
    throw Error("search tree: " + std::to_string(regions.rows.size()) + " regions have " +
                std::to_string(regions.centres.size()) + " coordinates of centres, of " +
                std::to_string(regions.p) + " parameters each");
}

CellMember MemberSolver::whole(std::uint32_t region) {
  const std::size_t p = parameters();
  const double* const centre = regions_.centres.data() + region * p;
  CellMember member;
  member.region = region;
  member.inner.assign(centre, centre + p);
  for (const std::int32_t row : regions_.rows[region])
    (boundsBox(row) ? member.walls : member.rows).push_back(row);
  for (std::size_t bound = 0; bound < member.bounds(); ++bound)
    member.points.insert(member.points.end(), centre, centre + p);
  is_settled_.assign(member.bounds(), 0);
  settle(member);
  return member;
}

// A look-up has tested the box before it comes to the tree.
bool MemberSolver::boundsBox(std::int32_t row) const {
  const std::size_t p = parameters();
  const double* const a = plane(planeOf(row));
  std::size_t large = 0, axis = p;
  for (std::size_t j = 0; j < p; ++j) {
    if (std::abs(a[j]) <= tolerance::kSameAsBox) continue;
    ++large;
    axis = j;
  }
  if (large != 1) return false;
  const double bound = (row > 0 ? 1.0 : -1.0) * a[p] / std::abs(a[axis]);
  return std::abs(bound - 1.0) <= tolerance::kSameAsBox;
}

// By how much a parameter that a look-up brings to a cell may violate a bound of it.
double MemberSolver::roundingOf(std::int32_t wall) const {
  return boundsBox(wall) ? tolerance::kMissedBox : tolerance::kMissedPlane;
}

unsigned MemberSolver::seenSides(const CellMember& member, std::size_t plane) const {
  const std::size_t p = parameters();
  constexpr unsigned kBoth = kBelow | kAbove;
  const double* const row = this->plane(plane);
  const unsigned sides = kernels_.of_points(row, member.inner.data(), 1, tolerance_, kBoth, 0u, p);
  return kernels_.of_points(row, member.points.data(), member.points.size() / p, tolerance_, kBoth, sides, p);
}

double MemberSolver::reachOf(const CellMember& member, std::size_t plane, unsigned side) const {
  const std::size_t p = parameters();
  double reach = sign(side) * kernels_.distance(this->plane(plane), member.inner.data(), p);
  for (std::size_t k = 0; k < member.points.size(); k += p)
    reach = std::max(reach, sign(side) * kernels_.distance(this->plane(plane), member.points.data() + k, p));
  return reach;
}

unsigned MemberSolver::sides(CellMember& member, std::size_t plane) {
  const auto row = static_cast<std::int32_t>(plane) + 1;
  for (const std::int32_t own : member.rows) {
    if (own == row) return kBelow;
    if (own == -row) return kAbove;
  }
  unsigned sides = seenSides(member, plane);
  for (const unsigned side : {kBelow, kAbove}) {
    if ((sides & side) == 0 && reaches(member, plane, sign(side))) sides |= side;
  }
  return sides;
}

void MemberSolver::gatherRows(const CellMember& member) {
  const std::size_t width = parameters() + 1;
  rows_.resize((member.rows.size() + member.walls.size()) * width);
  double* out = rows_.data();
  for (const auto* const list : {&member.rows, &member.walls}) {
    for (const std::int32_t row : *list) {
      const double* const a = plane(planeOf(row));
      const double factor = row > 0 ? 1.0 : -1.0;
      for (std::size_t j = 0; j < width; ++j) *out++ = factor * a[j];
      if (list == &member.walls) out[-1] += tolerance::kMissedPlane;
    }
  }
}

void MemberSolver::gatherRow(std::int32_t row, double moved) {
  const std::size_t p = parameters();
  const double* const a = plane(planeOf(row));
  const double factor = row > 0 ? 1.0 : -1.0;
  for (std::size_t j = 0; j < p; ++j) rows_.push_back(factor * a[j]);
  rows_.push_back(factor * a[p] + moved);
}

// Finds the member's point that is furthest out on a side of the plane (-1: below, 1: above), and keeps it.
bool MemberSolver::reaches(CellMember& member, std::size_t plane, double side) {
  const std::size_t p = parameters();
  gatherRows(member);
  const double* const normal = this->plane(plane);
  for (std::size_t j = 0; j < p; ++j) direction_[j] = side * normal[j];
  const int count = static_cast<int>(rows_.size() / (p + 1));
  if (!solver_.furthest(rows_.data(), count, member.inner.data(), direction_.data(), point_.data())) {
    return true;  // undecided: it stays on both sides
  }
  const double reach = side * kernels_.distance(normal, point_.data(), p);
  if (reach <= tolerance_) return false;
  member.points.insert(member.points.end(), point_.begin(), point_.end());
  return true;
}

CellMember MemberSolver::half(const CellMember& member, std::size_t plane, unsigned side) {
  const std::size_t p = parameters();
  const std::size_t bounds = member.bounds();
  const auto row = static_cast<std::int32_t>(plane) + 1;
  CellMember& part = part_;
  part.region = member.region;
  part.excess = member.excess;
  part.rows = member.rows;
  part.walls = member.walls;
  part.walls.push_back(side == kBelow ? row : -row);
  part.inner = member.inner;
  moveInner(part, plane, sign(side), member.points);
  part.points.assign(member.points.begin(), member.points.begin() + static_cast<std::ptrdiff_t>(bounds * p));
  part.points.insert(part.points.end(), part.inner.begin(), part.inner.end());  // on the new wall, see below
  // Undecided members may have no known point here. Without one inside, all rows stay.
  if (sign(side) * kernels_.distance(this->plane(plane), part.inner.data(), p) <= 0.0) return part;
  is_settled_.assign(bounds + 1, 1);
  is_settled_[bounds] = crossPlane(member, plane, sign(side), part.points.data() + bounds * p) ? 1 : 0;
  for (std::size_t k = 0; k < member.points.size() / p; ++k) {
    const double* const point = member.points.data() + k * p;
    const bool is_here =
        sign(side) * kernels_.distance(this->plane(plane), point, p) > tolerance::kImpliedRow;
    if (k < bounds) {
      is_settled_[k] = is_here ? 1 : 0;
    } else if (is_here && part.points.size() < (bounds + 1 + kOtherPoints) * p) {
      part.points.insert(part.points.end(), point, point + p);
    }
  }
  settle(part);
  return part;
}

void MemberSolver::enter(CellMember& member, std::size_t plane, unsigned side) const {
  const std::size_t p = parameters();
  moveInner(member, plane, sign(side), member.points);
  const std::size_t most = (member.bounds() + kOtherPoints) * p;
  if (member.points.size() > most) {  // cells are many: no memory is left over
    member.points.resize(most);
    member.points.shrink_to_fit();
  }
  const auto own = std::find_if(member.rows.begin(), member.rows.end(),
                                [&](std::int32_t row) { return planeOf(row) == plane; });
  if (own == member.rows.end()) return;
  const auto point = member.points.begin() + (own - member.rows.begin()) * static_cast<std::ptrdiff_t>(p);
  std::rotate(point, point + static_cast<std::ptrdiff_t>(p),
              member.points.begin() + static_cast<std::ptrdiff_t>(member.bounds() * p));
  member.walls.push_back(*own);
  member.rows.erase(own);
}

// Where the way from a point on the other side of the plane to the inner point crosses it.
bool MemberSolver::crossPlane(const CellMember& member, std::size_t plane, double side,
                              double* crossing) const {
  const std::size_t p = parameters();
  const double* const row = this->plane(plane);
  const double* outer = member.inner.data();
  double least = side * kernels_.distance(row, outer, p);
  for (std::size_t k = 0; k < member.points.size(); k += p) {
    const double value = side * kernels_.distance(row, member.points.data() + k, p);
    if (value >= least) continue;
    least = value;
    outer = member.points.data() + k;
  }
  const double inside = side * kernels_.distance(row, crossing, p);
  if (least >= 0.0 || inside <= 0.0) return false;
  const double fraction = inside / (inside - least);
  for (std::size_t j = 0; j < p; ++j) crossing[j] += fraction * (outer[j] - crossing[j]);
  return true;
}

// Finds a point for each row that has none, and drops those that others imply.
void MemberSolver::settle(CellMember& member) {
  const std::size_t p = parameters();
  if (std::find(is_settled_.begin(), is_settled_.end(), 0) == is_settled_.end()) return;
  gatherRows(member);
  slacks_.resize(member.bounds());
  for (std::size_t k = 0; k < slacks_.size(); ++k)
    slacks_[k] = -kernels_.distance(rows_.data() + k * (p + 1), member.inner.data(), p);
  bool is_open = false;
  for (std::size_t k = 0; k < is_settled_.size(); ++k) {
    if (is_settled_[k] != 0) continue;
    if (castRay(member, k))
      is_settled_[k] = 1;
    else
      is_open = true;
  }
  if (is_open) decide(member);
}

// Whether the ray from the inner point straight to a bound meets it before all others. Its point is then moved there.
bool MemberSolver::castRay(CellMember& member, std::size_t bound) const {
  const std::size_t p = parameters();
  const double* const ray = rows_.data() + bound * (p + 1);
  const double reach = slacks_[bound];
  for (std::size_t k = 0; k < slacks_.size(); ++k) {
    if (k == bound) continue;
    const double* const row = rows_.data() + k * (p + 1);
    double slope = 0.0;
    for (std::size_t j = 0; j < p; ++j) slope += row[j] * ray[j];
    if (slacks_[k] - reach * slope <= tolerance::kNeededRow) return false;
  }
  for (std::size_t j = 0; j < p; ++j) member.points[bound * p + j] = member.inner[j] + reach * ray[j];
  return true;
}

// The same by linear programming.
void MemberSolver::decide(CellMember& member) {
  const std::size_t p = parameters();
  order_.clear();
  for (const char settled : {1, 0}) {
    for (std::size_t k = 0; k < is_settled_.size(); ++k) {
      if (is_settled_[k] == settled) order_.push_back(k);
    }
  }
  ordered_.resize(rows_.size());
  is_tested_.clear();
  amounts_.clear();
  for (const std::size_t k : order_) {
    const bool is_tested = k < member.rows.size();
    is_tested_.push_back(is_tested ? 1 : 0);
    amounts_.push_back(is_tested ? format::kMaxTolerance : roundingOf(member.bound(k)));
  }
  for (std::size_t k = 0; k < order_.size(); ++k)
    std::copy_n(rows_.data() + order_[k] * (p + 1), p + 1, ordered_.data() + k * (p + 1));
  const auto kept = static_cast<int>(std::count(is_settled_.begin(), is_settled_.end(), 1));
  if (!solver_.minimalBeside(
          kept, ordered_.data(), static_cast<int>(order_.size()), member.inner.data(), tolerance::kImpliedRow,
          minimal_, {amounts_.data(), is_tested_.data(), format::kMaxTolerance, tolerance::kUntestedReach})) {
    // All stay.
    for (std::size_t k = 0; k < is_settled_.size(); ++k) {
      if (is_settled_[k] == 0)
        std::copy(member.inner.begin(), member.inner.end(),
                  member.points.begin() + static_cast<std::ptrdiff_t>(k * p));
    }
    return;
  }
  member.excess *= minimal_.excess;
  for (std::size_t f = 0; f < minimal_.facets.size(); ++f) {
    const std::size_t bound = order_[static_cast<std::size_t>(minimal_.facets[f])];
    const double* const beyond = minimal_.beyond.data() + f * p;
    const double violation = kernels_.distance(rows_.data() + bound * (p + 1), beyond, p);
    const double fraction = slacks_[bound] / (slacks_[bound] + std::max(violation, 0.0));
    for (std::size_t j = 0; j < p; ++j)
      member.points[bound * p + j] = member.inner[j] + fraction * (beyond[j] - member.inner[j]);
    is_settled_[bound] = 1;
  }
  drop(member);
}

// Drops what is not settled.
void MemberSolver::drop(CellMember& member) const {
  const std::size_t p = parameters(), bounds = member.bounds();
  const std::size_t rows = member.rows.size();
  std::size_t kept = 0, kept_rows = 0, kept_walls = 0;
  for (std::size_t k = 0; k < member.points.size() / p; ++k) {
    if (k < bounds && is_settled_[k] == 0) continue;
    if (k < rows)
      member.rows[kept_rows++] = member.rows[k];
    else if (k < bounds)
      member.walls[kept_walls++] = member.walls[k - rows];
    std::copy_n(member.points.begin() + static_cast<std::ptrdiff_t>(k * p), p,
                member.points.begin() + static_cast<std::ptrdiff_t>(kept++ * p));
  }
  member.rows.resize(kept_rows);
  member.walls.resize(kept_walls);
  member.points.resize(kept * p);
}

// Moves the inner point, if it lies on the other side, to half-way between the plane and the point furthest out on
// this side. What lies between an inner point and one of the border is inside.
void MemberSolver::moveInner(CellMember& part, std::size_t plane, double side,
                             const std::vector<double>& points) const {
  const std::size_t p = parameters();
  const double inner = side * kernels_.distance(this->plane(plane), part.inner.data(), p);
  if (inner > 0.0) return;
  const double* furthest = nullptr;
  double reach = 0.0;
  for (std::size_t k = 0; k < points.size(); k += p) {
    const double value = side * kernels_.distance(this->plane(plane), points.data() + k, p);
    if (value <= reach) continue;
    reach = value;
    furthest = points.data() + k;
  }
  if (furthest == nullptr) return;
  const double fraction = (0.5 * reach - inner) / (reach - inner);
  for (std::size_t j = 0; j < p; ++j) part.inner[j] += fraction * (furthest[j] - part.inner[j]);
}

}  // namespace polyfly
