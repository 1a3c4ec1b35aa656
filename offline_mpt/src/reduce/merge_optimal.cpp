#include <algorithm>
#include <cstdlib>
#include <set>

#include "reduce/arrangement.hpp"
#include "reduce/minimum_cover.hpp"
#include "reduce/tolerances.hpp"

namespace polyfly {
namespace {

/// Whether two pieces share more than an edge of a facet; a wrong "yes" costs time only.
bool areNeighbours(CellGeometry& geometry, const ConvexCell& a, const ConvexCell& b, double slack) {
  const ScaledPlanes& planes = geometry.planes();
  const auto p = static_cast<std::size_t>(planes.p);
  std::vector<double> first, second, rows;
  for (const std::int32_t own : a.rows) {
    first.clear();
    planes.append(own, 0.0, first);
    for (const std::int32_t theirs : b.rows) {
      second.clear();
      planes.append(theirs, 0.0, second);
      double difference = 0.0;
      for (std::size_t j = 0; j <= p; ++j) difference += std::abs(first[j] + second[j]);
      if (difference > 4.0 * slack) continue;
      rows.clear();
      for (const std::int32_t row : a.rows)
        planes.append(row, row == own ? tolerance::kNearPlane : slack, rows);
      for (const std::int32_t row : b.rows)
        planes.append(row, row == theirs ? tolerance::kNearPlane : slack, rows);
      std::vector<double> centre = a.centre;
      if (geometry.ball(rows, centre.data()) > 4.0 * slack) return true;
    }
  }
  return false;
}

/// Connected parts: only these can have convex unions.
std::vector<std::vector<std::size_t>> parts(CellGeometry& geometry, const MergeTask& task) {
  std::vector<std::size_t> part(task.pieces.size());
  for (std::size_t i = 0; i < part.size(); ++i) part[i] = i;
  for (std::size_t i = 0; i < part.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (part[i] == part[j] || !areNeighbours(geometry, task.pieces[i], task.pieces[j], task.slack))
        continue;
      const std::size_t from = std::max(part[i], part[j]), to = std::min(part[i], part[j]);
      std::replace(part.begin(), part.end(), from, to);
    }
  }
  std::vector<std::vector<std::size_t>> result;
  for (std::size_t head = 0; head < part.size(); ++head) {
    std::vector<std::size_t> members;
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (part[i] == head) members.push_back(i);
    }
    if (!members.empty()) result.push_back(std::move(members));
  }
  return result;
}

/// Sets of planes, one bit each, such that each of `families` has a plane in the set, and none can be spared:
/// the half-spaces that must be kept about a cell so that every cell outside is cut off.
class Transversals {
 public:
  Transversals(std::vector<std::uint64_t> families, std::size_t limit) : limit_(limit) {
    std::sort(families.begin(), families.end(), [](std::uint64_t a, std::uint64_t b) {
      const int bits_a = __builtin_popcountll(a), bits_b = __builtin_popcountll(b);
      return bits_a != bits_b ? bits_a < bits_b : a < b;
    });
    for (const std::uint64_t family : families) {
      const bool implied = std::any_of(families_.begin(), families_.end(),
                                       [&](std::uint64_t smaller) { return (smaller & ~family) == 0; });
      if (!implied) families_.push_back(family);
    }
  }

  /// False when there are more than the limit.
  bool find(std::vector<std::uint64_t>& found) {
    found_ = &found;
    return grow(0, 0);
  }

 private:
  bool grow(std::uint64_t chosen, std::size_t next) {
    while (next < families_.size() && (families_[next] & chosen) != 0) ++next;
    if (next == families_.size()) {
      if (isMinimal(chosen)) found_->push_back(chosen);
      return ++seen_ <= limit_;
    }
    for (std::uint64_t rest = families_[next]; rest != 0; rest &= rest - 1) {
      const std::uint64_t with = chosen | (rest & (~rest + 1));
      if (!isMinimalSoFar(with, next)) continue;
      if (!grow(with, next + 1)) return false;
    }
    return true;
  }

  /// Every plane chosen is the only one for some family among the first ones.
  bool isMinimalSoFar(std::uint64_t chosen, std::size_t last) const {
    std::uint64_t needed = 0;
    for (std::size_t i = 0; i <= last && i < families_.size(); ++i) {
      const std::uint64_t hit = families_[i] & chosen;
      if ((hit & (hit - 1)) == 0) needed |= hit;
    }
    return needed == chosen;
  }

  bool isMinimal(std::uint64_t chosen) const { return isMinimalSoFar(chosen, families_.size()); }

  std::vector<std::uint64_t> families_;
  std::size_t limit_;
  std::size_t seen_ = 0;
  std::vector<std::uint64_t>* found_ = nullptr;
};

/// A convex union of cells: those that agree with `signs` on the planes of `mask`.
struct Cube {
  std::uint64_t mask = 0;
  std::uint64_t signs = 0;
  // Cells of the union, numbered among the cells inside the pieces.
  BitSet cells;

  bool operator<(const Cube& other) const {
    if (!(cells == other.cells)) return cells < other.cells;
    const int bits = __builtin_popcountll(mask), other_bits = __builtin_popcountll(other.mask);
    if (bits != other_bits) return bits < other_bits;
    return mask != other.mask ? mask < other.mask : signs < other.signs;
  }
};

/// Keeps one cube for each set of cells, and of the sets those that no other holds.
void keepMaximal(std::vector<Cube>& cubes) {
  std::sort(cubes.begin(), cubes.end());
  cubes.erase(std::unique(cubes.begin(), cubes.end(),
                          [](const Cube& a, const Cube& b) { return a.cells == b.cells; }),
              cubes.end());
  std::vector<Cube> kept;
  for (const Cube& cube : cubes) {
    const bool held = std::any_of(cubes.begin(), cubes.end(), [&](const Cube& other) {
      return !(cube.cells == other.cells) && cube.cells.subsetOf(other.cells);
    });
    if (!held) kept.push_back(cube);
  }
  cubes = std::move(kept);
}

/// All maximal convex unions of the cells inside. False when the limit is reached.
bool findCubes(const Arrangement& arrangement, const MergeLimits& limits, std::vector<Cube>& cubes,
               std::size_t& cells) {
  std::vector<std::uint64_t> inside, outside;
  for (const ArrangementCell& cell : arrangement.cells)
    (cell.inside ? inside : outside).push_back(cell.signs);
  cells = inside.size();
  std::set<Cube> all;
  std::size_t left = limits.unions;
  for (const std::uint64_t signs : inside) {
    std::vector<std::uint64_t> families;
    for (const std::uint64_t other : outside) families.push_back(signs ^ other);
    std::vector<std::uint64_t> masks;
    if (!Transversals(std::move(families), left).find(masks)) return false;
    left -= std::min(left, masks.size());
    for (const std::uint64_t mask : masks) {
      Cube cube{mask, signs & mask, BitSet(inside.size())};
      for (std::size_t i = 0; i < inside.size(); ++i) {
        if (((inside[i] ^ signs) & mask) == 0) cube.cells.set(i);
      }
      all.insert(std::move(cube));
    }
  }
  cubes.assign(all.begin(), all.end());
  keepMaximal(cubes);
  return true;
}

ConvexCell pieceOf(CellGeometry& geometry, const Arrangement& arrangement, const Cube& cube,
                   const RowList& box) {
  ConvexCell piece;
  piece.rows = arrangement.hull;
  for (std::size_t i = 0; i < arrangement.planes.size(); ++i) {
    if ((cube.mask >> i & 1) == 0) continue;
    const bool above = (cube.signs >> i & 1) != 0;
    piece.rows.push_back(above ? -arrangement.planes[i] : arrangement.planes[i]);
  }
  for (const std::int32_t row : box) {
    if (std::find(piece.rows.begin(), piece.rows.end(), row) == piece.rows.end()) piece.rows.push_back(row);
  }
  geometry.describe(piece);
  piece.rows = geometry.minimal(piece);
  return piece;
}

Merged mergePart(CellGeometry& geometry, const MergeTask& task, const MergeLimits& limits) {
  Merged greedy = mergeGreedily(geometry, task);
  if (greedy.optimal) return greedy;
  std::vector<ConvexCell> pieces = task.pieces;
  const auto arrangement = arrange(geometry, pieces, task.box, task.slack, limits);
  std::vector<Cube> cubes;
  std::size_t cells = 0;
  if (!arrangement || !findCubes(*arrangement, limits, cubes, cells)) return greedy;
  std::vector<BitSet> sets;
  for (const Cube& cube : cubes) sets.push_back(cube.cells);
  const MinimumCover cover = minimumCover(cells, sets, limits.covers);
  if (cover.chosen.size() >= greedy.pieces.size()) {
    greedy.optimal = cover.proven;
    return greedy;
  }
  Merged result;
  result.optimal = cover.proven;
  for (const std::size_t chosen : cover.chosen)
    result.pieces.push_back(pieceOf(geometry, *arrangement, cubes[chosen], task.box));
  return result;
}

}  // namespace

Merged mergeOptimally(CellGeometry& geometry, const MergeTask& task, const MergeLimits& limits) {
  Merged result;
  result.optimal = true;
  for (const std::vector<std::size_t>& members : parts(geometry, task)) {
    MergeTask part = task;
    part.pieces.clear();
    for (const std::size_t member : members) part.pieces.push_back(task.pieces[member]);
    Merged merged = mergePart(geometry, part, limits);
    result.optimal = result.optimal && merged.optimal;
    for (ConvexCell& piece : merged.pieces) result.pieces.push_back(std::move(piece));
  }
  return result;
}

}  // namespace polyfly
