#include "tree/cell_splitter.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "support/in_parallel.hpp"
#include "tree/plane_sides.hpp"
#include "tree/tolerances.hpp"

namespace polyfly {
namespace {

// Planes and members that estimates look at, evenly drawn from more.
constexpr std::size_t kPlanesScored = 200;
constexpr std::size_t kMembersScored = 1024;
// Above so many members, estimates are good enough for one plane.
constexpr std::size_t kManyMembers = 200;
// Planes tried before a cell counts as one that no plane divides.
constexpr std::size_t kMostTried = 64;
// Members that a thread takes at once.
constexpr std::uint64_t kChunk = 64;

}  // namespace

void CellSplitter::Estimate::add(unsigned sides, std::size_t rows) {
  if ((sides & kBelow) != 0) below += rows;
  if ((sides & kAbove) != 0) above += rows;
}

bool CellSplitter::Estimate::mayReach(const Estimate& other) const {
  return laws != other.laws ? laws < other.laws : fuller() <= other.fuller();
}

bool CellSplitter::Estimate::isBetterThan(const Estimate& other) const {
  if (laws != other.laws) return laws < other.laws;
  if (fuller() != other.fuller()) return fuller() < other.fuller();
  if (below + above != other.below + other.above) return below + above < other.below + other.above;
  return plane < other.plane;
}

CellSplitter::CellSplitter(const TreeRegions& regions, const TreeOptions& options)
    : regions_(regions),
      threads_(std::max(1, options.threads)),
      planes_tried_(options.planes_tried),
      all_rows_(options.all_rows),
      side_tolerance_(options.side_tolerance),
      least_cell_(options.least_cell),
      least_angle_(std::max(options.least_angle, tolerance::kSharpAngle)) {
  for (int k = 0; k < threads_; ++k)
    solvers_.emplace_back(regions, options.side_tolerance, least_cell_ > 0.0);
}

Cell CellSplitter::whole() {
  Cell cell;
  cell.members.resize(regions_.rows.size());
  const std::uint64_t chunks = (cell.members.size() + kChunk - 1) / kChunk;
  inParallel(chunks, threads_, nullptr, {}, [&](std::size_t thread, std::uint64_t chunk) {
    const std::size_t end = std::min(cell.members.size(), (chunk + 1) * kChunk);
    for (std::size_t r = chunk * kChunk; r < end; ++r)
      cell.members[r] = solvers_[thread].whole(static_cast<std::uint32_t>(r));
  });
  return cell;
}

std::size_t CellSplitter::tests(const CellMember& member) const {
  return all_rows_ ? regions_.rows[member.region].size() : member.rows.size();
}

std::size_t CellSplitter::tests(const Cell& cell) const {
  std::size_t sum = 0;
  for (const CellMember& member : cell.members) sum += tests(member);
  return sum;
}

// A row on the plane of a node becomes a bound of the cells.
std::size_t CellSplitter::testsBesides(const CellMember& member, std::size_t plane) const {
  const auto on_plane = [&](std::int32_t row) { return planeOf(row) == plane; };
  const bool saves = !all_rows_ && std::any_of(member.rows.begin(), member.rows.end(), on_plane);
  return tests(member) - (saves ? 1 : 0);
}

std::uint64_t CellSplitter::pivots() const {
  std::uint64_t sum = 0;
  for (const MemberSolver& solver : solvers_) sum += solver.pivots();
  return sum;
}

void CellSplitter::finishLeaf(Cell& cell, std::size_t thread) {
  if (all_rows_) return;
  for (CellMember& member : cell.members) solvers_[thread].addRowsForTolerance(member, cell.path);
}

std::optional<CellSplit> CellSplitter::split(Cell& cell, std::size_t thread) {
  MemberSolver& solver = solvers_[thread];
  return splitWith(cell, solver, [&](std::size_t count, const auto& work) {
    for (std::size_t i = 0; i < count; ++i) work(solver, i);
  });
}

std::optional<CellSplit> CellSplitter::splitTogether(Cell& cell) {
  return splitWith(cell, solvers_.front(), [&](std::size_t count, const auto& work) {
    const std::uint64_t chunks = (count + kChunk - 1) / kChunk;
    inParallel(chunks, threads_, nullptr, {}, [&](std::size_t thread, std::uint64_t chunk) {
      const std::size_t end = std::min<std::size_t>(count, (chunk + 1) * kChunk);
      for (std::size_t i = chunk * kChunk; i < end; ++i) work(solvers_[thread], i);
    });
  });
}

template <class ForEach>
std::optional<CellSplit> CellSplitter::splitWith(Cell& cell, MemberSolver& own, const ForEach& for_each) {
  if (cell.members.size() < 2) return std::nullopt;
  std::vector<Estimate> estimates = estimate(cell);
  std::sort(estimates.begin(), estimates.end(),
            [](const Estimate& a, const Estimate& b) { return a.isBetterThan(b); });
  const std::size_t all = tests(cell);
  const std::size_t all_laws = lawsOf(cell, std::vector<unsigned char>(cell.members.size(), kBelow), kBelow);
  const std::size_t tried = cell.members.size() > kManyMembers ? 1 : planes_tried_;
  std::vector<unsigned char> sides(cell.members.size()), best_sides;
  std::optional<Estimate> best;
  for (std::size_t i = 0; i < estimates.size() && i < kMostTried; ++i) {
    if (best && (i >= tried || !estimates[i].mayReach(*best))) break;
    if (makesSharpEdge(cell, estimates[i].plane)) continue;
    Estimate exact{estimates[i].plane};
    for_each(cell.members.size(), [&](MemberSolver& solver, std::size_t k) {
      sides[k] = static_cast<unsigned char>(solver.sides(cell.members[k], exact.plane));
    });
    for (std::size_t k = 0; k < sides.size(); ++k)
      exact.add(sides[k], testsBesides(cell.members[k], exact.plane));
    exact.laws = std::max(lawsOf(cell, sides, kBelow), lawsOf(cell, sides, kAbove));
    if ((exact.fuller() + 1 >= all && exact.laws >= all_laws) || (best && !exact.isBetterThan(*best)) ||
        hasFlatSide(cell, exact.plane, sides, own))
      continue;
    best = exact;
    best_sides = sides;
  }
  if (!best) return std::nullopt;
  return divide(cell, best->plane, best_sides, for_each);
}

bool CellSplitter::makesSharpEdge(const Cell& cell, std::size_t plane) const {
  const auto p = static_cast<std::size_t>(regions_.p);
  const double* const a = regions_.planes.data() + plane * (p + 1);
  return std::any_of(cell.path.begin(), cell.path.end(), [&](std::int32_t row) {
    const double* const b = regions_.planes.data() + planeOf(row) * (p + 1);
    for (const double sign : {1.0, -1.0}) {
      double turn = 0.0;
      for (std::size_t j = 0; j < p; ++j) turn += std::abs(a[j] - sign * b[j]);
      if (turn < least_angle_ && std::abs(a[p] - sign * b[p]) <= turn) return true;
    }
    return false;
  });
}

bool CellSplitter::hasFlatSide(const Cell& cell, std::size_t plane, const std::vector<unsigned char>& sides,
                               MemberSolver& solver) const {
  for (const unsigned side : {kBelow, kAbove}) {
    if (least_cell_ > 0.0 && solver.depthOf(cell, plane, side) < least_cell_) return true;
    bool is_empty = true, is_flat = true;
    for (std::size_t k = 0; k < sides.size() && is_flat; ++k) {
      if ((sides[k] & side) == 0) continue;
      is_empty = false;
      is_flat = solver.reachOf(cell.members[k], plane, side) < tolerance::kFlatCell;
    }
    if (is_empty) is_flat = solver.depthOf(cell, plane, side) < tolerance::kFlatCell;
    if (is_flat) return true;
  }
  return false;
}

std::vector<CellSplitter::Estimate> CellSplitter::estimate(const Cell& cell) const {
  const std::size_t step = (cell.members.size() + kMembersScored - 1) / kMembersScored;
  const auto p = static_cast<std::size_t>(regions_.p);
  const std::vector<std::size_t> planes = planesOf(cell, step);
  PlaneBlock block(regions_.planes, planes, p);
  for (std::size_t m = 0; m < cell.members.size(); m += step) {
    const CellMember& member = cell.members[m];
    block.weigh(member.inner.data(), {member.points.data(), member.points.size() / p}, side_tolerance_,
                static_cast<double>(tests(member)));
  }
  std::vector<Estimate> estimates;
  for (std::size_t i = 0; i < planes.size(); ++i)
    estimates.push_back(
        {planes[i], static_cast<std::size_t>(block.below(i)), static_cast<std::size_t>(block.above(i))});
  if (!regions_.laws.empty()) estimateLaws(cell, step, planes, estimates);
  return estimates;
}

void CellSplitter::estimateLaws(const Cell& cell, std::size_t step, const std::vector<std::size_t>& planes,
                                std::vector<Estimate>& estimates) const {
  const auto p = static_cast<std::size_t>(regions_.p);
  std::map<std::uint32_t, PlaneBlock> sides;
  for (std::size_t m = 0; m < cell.members.size(); m += step) {
    const CellMember& member = cell.members[m];
    const auto found = sides.try_emplace(regions_.laws[member.region], regions_.planes, planes, p).first;
    found->second.weigh(member.inner.data(), {member.points.data(), member.points.size() / p},
                        side_tolerance_, 1.0);
  }
  for (std::size_t i = 0; i < planes.size(); ++i) {
    std::size_t below = 0, above = 0;
    for (const auto& [law, block] : sides) {
      below += block.below(i) > 0.0 ? 1 : 0;
      above += block.above(i) > 0.0 ? 1 : 0;
    }
    estimates[i].laws = std::max(below, above);
  }
}

/// Number of laws of the members that have a side; 0 where laws do not count.
std::size_t CellSplitter::lawsOf(const Cell& cell, const std::vector<unsigned char>& sides,
                                 unsigned side) const {
  if (regions_.laws.empty()) return 0;
  std::set<std::uint32_t> laws;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    if ((sides[k] & side) != 0) laws.insert(regions_.laws[cell.members[k].region]);
  }
  return laws.size();
}

// Planes of rows to test, each once, at most kPlanesScored.
std::vector<std::size_t> CellSplitter::planesOf(const Cell& cell, std::size_t step) const {
  std::vector<std::size_t> planes;
  for (std::size_t m = 0; m < cell.members.size(); m += step) {
    for (const std::int32_t row : cell.members[m].rows) planes.push_back(planeOf(row));
  }
  std::sort(planes.begin(), planes.end());
  planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
  const std::size_t stride = (planes.size() + kPlanesScored - 1) / kPlanesScored;
  std::vector<std::size_t> drawn;
  for (std::size_t i = 0; i < planes.size(); i += stride) drawn.push_back(planes[i]);
  return drawn;
}

template <class ForEach>
CellSplit CellSplitter::divide(Cell& cell, std::size_t plane, const std::vector<unsigned char>& sides,
                               const ForEach& for_each) {
  constexpr unsigned kBoth = kBelow | kAbove;
  std::vector<CellMember> above(cell.members.size());
  for_each(cell.members.size(), [&](MemberSolver& solver, std::size_t k) {
    CellMember& member = cell.members[k];
    if (sides[k] == kBoth) {
      above[k] = solver.half(member, plane, kAbove);
      member = solver.half(member, plane, kBelow);
    } else if (sides[k] != 0) {
      solver.enter(member, plane, sides[k]);
    }
  });
  CellSplit split;
  split.plane = plane;
  const auto row = static_cast<std::int32_t>(plane) + 1;
  split.below.path = split.above.path = cell.path;
  split.below.path.push_back(row);
  split.above.path.push_back(-row);
  const auto reaching = [&](unsigned side) {
    return static_cast<std::size_t>(
        std::count_if(sides.begin(), sides.end(), [side](unsigned char k) { return (k & side) != 0; }));
  };
  split.below.members.reserve(reaching(kBelow));
  split.above.members.reserve(reaching(kAbove));
  for (std::size_t k = 0; k < cell.members.size(); ++k) {  // those on no side only touch the plane
    if (sides[k] == kBoth) split.above.members.push_back(std::move(above[k]));
    if ((sides[k] & kBelow) != 0) split.below.members.push_back(std::move(cell.members[k]));
    if (sides[k] == kAbove) split.above.members.push_back(std::move(cell.members[k]));
  }
  std::vector<CellMember>().swap(cell.members);
  return split;
}

}  // namespace polyfly
