#include "tree/cell_splitter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
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
// Above so many members, estimates are good enough for one plane. Of more planes than the short list holds, it has the
// best by a few members.
constexpr std::size_t kManyMembers = 200;
constexpr std::size_t kRoughMembers = 48;
constexpr std::size_t kShortList = 16;
// Planes tried before a cell counts as one that no plane divides.
constexpr std::size_t kMostTried = 64;
// Members that a thread takes at once.
constexpr std::uint64_t kChunk = 64;

/// Keeps of each number that which comes first. By a table of hashes, faster than to sort.
void dropRepeated(std::vector<std::size_t>& numbers) {
  constexpr std::uint64_t kFactor = 0x9e3779b97f4a7c15u;
  unsigned bits = 4;
  while ((std::size_t{1} << bits) < 2 * numbers.size()) ++bits;
  const std::size_t mask = (std::size_t{1} << bits) - 1;
  // One more than an index of a number that is kept, 0: none.
  std::vector<std::uint32_t> table(mask + 1, 0);
  std::size_t kept = 0;
  for (const std::size_t number : numbers) {
    std::size_t place = (number * kFactor) >> (64 - bits);
    while (table[place] != 0 && numbers[table[place] - 1] != number) place = (place + 1) & mask;
    if (table[place] != 0) continue;
    numbers[kept++] = number;
    table[place] = static_cast<std::uint32_t>(kept);
  }
  numbers.resize(kept);
}

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
      is_thorough_(options.mode == TreeMode::kSmall),
      all_rows_(options.all_rows),
      side_tolerance_(options.side_tolerance),
      least_cell_(options.least_cell),
      least_angle_(std::max(options.least_angle, tolerance::kSharpAngle)) {
  for (int k = 0; k < threads_; ++k)
    solvers_.push_back({MemberSolver(regions, options.side_tolerance), CellSolver(regions)});
}

Cell CellSplitter::whole() {
  Cell cell;
  cell.members.resize(regions_.rows.size());
  const std::uint64_t chunks = (cell.members.size() + kChunk - 1) / kChunk;
  inParallel(chunks, threads_, nullptr, {}, [&](std::size_t thread, std::uint64_t chunk) {
    const std::size_t end = std::min(cell.members.size(), (chunk + 1) * kChunk);
    for (std::size_t r = chunk * kChunk; r < end; ++r)
      cell.members[r] = solvers_[thread].members.whole(static_cast<std::uint32_t>(r));
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
  for (const Solvers& solvers : solvers_) sum += solvers.pivots();
  return sum;
}

void CellSplitter::finishLeaf(Cell& cell, std::size_t thread) {
  if (all_rows_) return;
  for (CellMember& member : cell.members) solvers_[thread].members.addRowsForTolerance(member, cell.path);
}

std::optional<CellSplit> CellSplitter::split(Cell& cell, std::size_t thread) {
  Solvers& own = solvers_[thread];
  return splitWith(cell, own, [&](std::size_t count, const auto& work) {
    for (std::size_t i = 0; i < count; ++i) work(own.members, i);
  });
}

std::optional<CellSplit> CellSplitter::splitTogether(Cell& cell) {
  return splitWith(cell, solvers_.front(), [&](std::size_t count, const auto& work) {
    const std::uint64_t chunks = (count + kChunk - 1) / kChunk;
    inParallel(chunks, threads_, nullptr, {}, [&](std::size_t thread, std::uint64_t chunk) {
      const std::size_t end = std::min<std::size_t>(count, (chunk + 1) * kChunk);
      for (std::size_t i = chunk * kChunk; i < end; ++i) work(solvers_[thread].members, i);
    });
  });
}

template <class ForEach>
std::optional<CellSplit> CellSplitter::splitWith(Cell& cell, Solvers& own, const ForEach& for_each) {
  if (cell.members.size() < 2) return std::nullopt;
  std::vector<unsigned char> sides;
  bool is_short = false;
  std::optional<Estimate> best = bestOf(cell, estimate(cell, is_short), own, for_each, sides);
  if (!best && is_short)
    best = bestOf(cell, scored(cell, planesOf(cell), kMembersScored), own, for_each, sides);
  if (!best) return std::nullopt;
  return divide(cell, best->plane, sides, for_each);
}

// Splits by the first planes, by their estimates, exactly; `best_sides` receives those of the members.
template <class ForEach>
std::optional<CellSplitter::Estimate> CellSplitter::bestOf(Cell& cell, std::vector<Estimate> estimates,
                                                           Solvers& own, const ForEach& for_each,
                                                           std::vector<unsigned char>& best_sides) {
  std::sort(estimates.begin(), estimates.end(),
            [](const Estimate& a, const Estimate& b) { return a.isBetterThan(b); });
  const std::size_t all = tests(cell);
  const std::size_t tried = cell.members.size() > kManyMembers ? 1 : planes_tried_;
  std::vector<unsigned char> sides(cell.members.size(), kBelow);
  const std::size_t all_laws = lawsOf(cell, sides, kBelow);
  std::optional<Estimate> best;
  for (std::size_t i = 0; i < estimates.size() && i < kMostTried; ++i) {
    if (best && (i >= tried || !estimates[i].mayReach(*best))) break;
    if (makesSharpEdge(cell, estimates[i].plane)) continue;
    Estimate exact{estimates[i].plane};
    if (best && !is_thorough_ && regions_.laws.empty()) {
      if (!isBetter(cell, *best, own.members, exact, sides)) continue;
    } else {
      for_each(cell.members.size(), [&](MemberSolver& solver, std::size_t k) {
        sides[k] = static_cast<unsigned char>(solver.sides(cell.members[k], exact.plane));
      });
      for (std::size_t k = 0; k < sides.size(); ++k)
        exact.add(sides[k], testsBesides(cell.members[k], exact.plane));
      exact.laws = std::max(lawsOf(cell, sides, kBelow), lawsOf(cell, sides, kAbove));
    }
    if ((exact.fuller() + 1 >= all && exact.laws >= all_laws) || (best && !exact.isBetterThan(*best)) ||
        hasBadSide(cell, exact.plane, sides, own))
      continue;
    best = exact;
    best_sides = sides;
  }
  return best;
}

// Whether the split by the plane of `exact` is better than the best. Ends as soon as it is not.
bool CellSplitter::isBetter(Cell& cell, const Estimate& best, MemberSolver& solver, Estimate& exact,
                            std::vector<unsigned char>& sides) const {
  for (std::size_t k = 0; k < sides.size(); ++k) {
    sides[k] = static_cast<unsigned char>(solver.seenSides(cell.members[k], exact.plane));
    exact.add(sides[k], testsBesides(cell.members[k], exact.plane));
  }
  for (std::size_t k = 0; k < sides.size() && exact.isBetterThan(best); ++k) {
    const auto all = static_cast<unsigned char>(solver.sides(cell.members[k], exact.plane));
    exact.add(all & ~unsigned{sides[k]}, testsBesides(cell.members[k], exact.plane));
    sides[k] = all;
  }
  return exact.isBetterThan(best);
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

// A side that is too thin, or in which rounding may take parameters far beyond a corner.
bool CellSplitter::hasBadSide(const Cell& cell, std::size_t plane, const std::vector<unsigned char>& sides,
                              Solvers& solvers) const {
  for (const unsigned side : {kBelow, kAbove}) {
    if (least_cell_ > 0.0 && solvers.cells.depthOf(cell, plane, side) < least_cell_) return true;
    bool is_empty = true, is_flat = true;
    for (std::size_t k = 0; k < sides.size() && is_flat; ++k) {
      if ((sides[k] & side) == 0) continue;
      is_empty = false;
      is_flat = solvers.members.reachOf(cell.members[k], plane, side) < tolerance::kFlatCell;
    }
    if (is_empty) is_flat = solvers.cells.depthOf(cell, plane, side) < tolerance::kFlatCell;
    if (is_flat || solvers.cells.hasSharpCorner(cell, plane, side)) return true;
  }
  return false;
}

// Of many planes and members, those of the best planes by a look at few members; `is_short` tells whether planes are
// missing.
std::vector<CellSplitter::Estimate> CellSplitter::estimate(const Cell& cell, bool& is_short) const {
  std::vector<std::size_t> planes = planesOf(cell);
  is_short = !is_thorough_ && planes.size() > kShortList && cell.members.size() > kManyMembers;
  if (is_short) {
    std::vector<Estimate> rough = scored(cell, planes, kRoughMembers);
    std::nth_element(rough.begin(), rough.begin() + kShortList, rough.end(),
                     [](const Estimate& a, const Estimate& b) { return a.isBetterThan(b); });
    for (std::size_t i = 0; i < kShortList; ++i) planes[i] = rough[i].plane;
    planes.resize(kShortList);
  }
  return scored(cell, planes, kMembersScored);
}

// By at most so many members.
std::vector<CellSplitter::Estimate> CellSplitter::scored(const Cell& cell,
                                                         const std::vector<std::size_t>& planes,
                                                         std::size_t most) const {
  const std::size_t step = (cell.members.size() + most - 1) / most;
  const auto p = static_cast<std::size_t>(regions_.p);
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

// Number of laws of the members that have a side; 0 where laws do not count.
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
std::vector<std::size_t> CellSplitter::planesOf(const Cell& cell) const {
  const std::size_t step = (cell.members.size() + kMembersScored - 1) / kMembersScored;
  std::vector<std::size_t> planes;
  for (std::size_t m = 0; m < cell.members.size(); m += step) {
    for (const std::int32_t row : cell.members[m].rows) planes.push_back(planeOf(row));
  }
  dropRepeated(planes);
  if (planes.size() <= kPlanesScored) return planes;
  std::sort(planes.begin(), planes.end());
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
