#include "certify/reduction/tree_partition.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <utility>

#include "certify/facet_cover.hpp"
#include "certify/multipliers.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

using Cell = ExactCell;

bool isConstant(const ExactRow& row) {
  return std::all_of(row.value.begin(), row.value.end() - 1, [](const Integer& value) { return value == 0; });
}

bool findPoint(Cell& cell, int p) {
  Interior interior = findInterior(cell.rows, nullptr, p);
  cell.point = std::move(interior.point);
  return interior.exists;
}

/// The part of the cell where `row` is positive; false when that is known to have no interior.
bool cut(const Cell& cell, const ExactRow& row, int p, Cell& part) {
  part.rows = cell.rows;
  part.rows.push_back(&row);
  part.certain = cell.certain;
  if (valueAt(row, cell.point) > 0) {
    part.point = cell.point;
    return true;
  }
  if (isConstant(row)) return false;
  const FastInterior guess = findInteriorFast(part.rows, p, part.point);
  part.certain = guess == FastInterior::kExists;
  return guess != FastInterior::kNone;
}

bool has(const Cell& cell, const ExactRow& row) {
  return std::find(cell.rows.begin(), cell.rows.end(), &row) != cell.rows.end();
}

class CellPartitioner {
 public:
  CellPartitioner(const ExactMap& map, const LeafVisit& visit, ProofWriter& log)
      : map_(map), visit_(visit), log_(log) {}

  bool descend(std::uint32_t child, const Cell& cell) {
    const ProofWriter::Nested nested(log_);
    const std::uint32_t index = child & ~MapContent::kLeaf;
    if ((child & MapContent::kLeaf) != 0) {
      log_.countPart();
      return visit_(index, cell);
    }
    const MapContent::Node& node = map_.map().node(index);
    const auto row = static_cast<std::int32_t>(node.plane) + 1;
    log_.word('n', node.plane);
    return take(row, node.below, cell) && take(-row, node.above, cell);
  }

 private:
  bool take(std::int32_t row, std::uint32_t child, const Cell& cell) {
    if (has(cell, map_.row(row))) {
      log_.word('w');
      return descend(child, cell);
    }
    Cell part;
    if (has(cell, map_.row(-row))) {
      part.rows = cell.rows;
      part.rows.push_back(&map_.row(row));
    } else if (cut(cell, map_.row(row), map_.p(), part)) {
      log_.word('s');
      return descend(child, part);
    }
    log_.empty('e', part.rows, map_.p());
    return true;
  }

  const ExactMap& map_;
  const LeafVisit& visit_;
  ProofWriter& log_;
};

class Subtractor {
 public:
  Subtractor(const ExactMap& map, CutBy by, const RestVisit& visit, ProofWriter& log)
      : map_(map), by_(by), visit_(visit), log_(log) {}

  /// The region that holds the cell's point is cut away, row by row; if none does, the cell is divided by
  /// those that reach into it.
  bool run(Cell cell, const std::vector<std::uint32_t>& left) {
    const ProofWriter::Nested nested(log_);
    log_.countPart();
    const auto holder =
        std::find_if(left.begin(), left.end(), [&](std::uint32_t r) { return holds(r, cell); });
    std::uint32_t region = 0;
    if (holder != left.end()) {
      region = *holder;
    } else if (!findMeeting(cell, left, region)) {
      return visit_(cell);
    }
    std::vector<std::uint32_t> others = left;
    others.erase(std::remove(others.begin(), others.end(), region), others.end());
    log_.word(static_cast<char>(by_), region);
    const RegionView view = map_.map().region(region);
    for (std::uint32_t i = 0; i < view.row_count; ++i) {
      const After after = cutAway(view.rows[i], cell, others);
      if (after != After::kRemains) return after == After::kNothing;
    }
    return true;
  }

 private:
  enum class After : std::uint8_t { kRemains, kNothing, kStopped };

  /// What lies outside of the row is cut off, what remains is the cell.
  After cutAway(std::int32_t row, Cell& cell, const std::vector<std::uint32_t>& others) {
    const ExactRow& outside = map_.outside(row);
    Cell beyond, inside;
    if (has(cell, map_.row(row)) || has(cell, map_.relaxed(row))) {
      beyond.rows = cell.rows;
      beyond.rows.push_back(&outside);
    } else if (cut(cell, outside, map_.p(), beyond)) {
      log_.word('s');
      if (!run(std::move(beyond), others)) return After::kStopped;
      if (cut(cell, map_.relaxed(row), map_.p(), inside)) {
        cell = std::move(inside);
        return After::kRemains;
      }
      log_.empty('q', inside.rows, map_.p());
      return After::kNothing;
    }
    log_.empty('e', beyond.rows, map_.p());
    return After::kRemains;
  }

  bool holds(std::uint32_t region, const Cell& cell) const {
    const RegionView view = map_.map().region(region);
    return std::all_of(view.rows, view.rows + view.row_count,
                       [&](std::int32_t row) { return valueAt(map_.relaxed(row), cell.point) >= 0; });
  }

  bool findMeeting(const Cell& cell, const std::vector<std::uint32_t>& left, std::uint32_t& region) const {
    for (const std::uint32_t candidate : left) {
      const RegionView view = map_.map().region(candidate);
      ExactRows rows = cell.rows;
      for (std::uint32_t i = 0; i < view.row_count; ++i) rows.push_back(&map_.relaxed(view.rows[i]));
      std::vector<Rational> point;
      if (findInteriorFast(rows, map_.p(), point) == FastInterior::kNone) continue;
      region = candidate;
      return true;
    }
    return false;
  }

  const ExactMap& map_;
  CutBy by_;
  const RestVisit& visit_;
  ProofWriter& log_;
};

}  // namespace

ExactRow wholeRow(const std::vector<Rational>& value) {
  const Integer denominator = commonDenominator(value);
  ExactRow row;
  for (const Rational& entry : value) row.value.emplace_back(Rational(entry * denominator).get_num());
  finishRow(row);
  return row;
}

ExactMap::ExactMap(const RegionMap& map, double slack, const ExactMap* other)
    : ExactMap(map, slack, map.parameters(), other) {}

ExactMap::ExactMap(const RegionMap& map, double slack, const std::vector<Signal>& ranges,
                   const ExactMap* other)
    : map_(map), ranges_(ranges) {
  const std::size_t width = ranges_.half.size() + 1;
  std::map<std::vector<double>, std::size_t> known;
  for (std::size_t i = 0; other != nullptr && i < other->rows_.size(); ++i) {
    const double* const plane = other->map_.plane(i);
    known.emplace(std::vector<double>(plane, plane + width), i);
  }
  for (std::size_t i = 0; i < map.planeCount(); ++i) {
    const double* const plane = map.plane(i);
    const auto found = known.find(std::vector<double>(plane, plane + width));
    rows_.push_back(found != known.end() ? other->rows_[found->second]
                                         : std::make_shared<const PlaneRows>(makeRows(plane, slack)));
  }
}

ExactMap::PlaneRows ExactMap::makeRows(const double* plane, double slack) const {
  PlaneRows rows;
  for (const std::size_t first : {std::size_t{0}, std::size_t{kVariants}}) {
    std::vector<Rational> value = ranges_.inside(plane, first == 0 ? 1 : -1);
    rows[first + kRow] = wholeRow(value);
    value.back() += Rational(slack);
    rows[first + kRelaxed] = wholeRow(value);
    for (Rational& entry : value) entry = -entry;
    rows[first + kOutside] = wholeRow(value);
  }
  return rows;
}

const ExactRow& ExactMap::at(std::int32_t row, Variant variant) const {
  const auto plane = static_cast<std::size_t>(std::abs(row)) - 1;
  return (*rows_[plane])[(row > 0 ? std::size_t{0} : std::size_t{kVariants}) + variant];
}

int ExactMap::p() const { return static_cast<int>(map_.parameters().size()); }

bool cellOf(const ExactMap& map, std::uint32_t region, ExactCell& cell, const std::deque<ExactRow>& sides) {
  const RegionView view = map.map().region(region);
  cell.rows.clear();
  for (std::uint32_t i = 0; i < view.row_count; ++i) {
    const ExactRow& row = map.row(view.rows[i]);
    if (!isConstant(row) || row.value.back() < 0) cell.rows.push_back(&row);
  }
  for (const ExactRow& side : sides) cell.rows.push_back(&side);
  return findPoint(cell, map.p());
}

bool makeCertain(const ExactMap& map, ExactCell& cell) {
  cell.certain = cell.certain || findPoint(cell, map.p());
  return cell.certain;
}

ProofWriter::Nested::Nested(ProofWriter& log) : log_(log) {
  if (log.wanted_ && log.depth_ >= kDeepestCuts) {
    throw Error(log.subject_ + ": its proof nests " + std::to_string(kDeepestCuts) +
                " cuts, which no certificate may have: prove the reduction without one");
  }
  ++log.depth_;
}

void ProofWriter::word(char word) {
  if (wanted_) text_.append({' ', word});
}

void ProofWriter::word(char word, std::uint64_t number) {
  if (wanted_) text_.append({' ', word, ' '}).append(std::to_string(number));
}

void ProofWriter::empty(char word, const std::vector<const ExactRow*>& rows, int p) {
  if (!wanted_) return;
  this->word(word);
  appendWeights(findInterior(rows, nullptr, p).proof, text_);
}

bool dissect(const ExactMap& map, const ExactCell& cell, const LeafVisit& visit, ProofWriter& log) {
  return CellPartitioner(map, visit, log).descend(map.map().root(), cell);
}

bool subtract(const ExactMap& map, const ExactCell& cell, const std::vector<std::uint32_t>& regions, CutBy by,
              const RestVisit& visit, ProofWriter& log) {
  return Subtractor(map, by, visit, log).run(cell, regions);
}

}  // namespace polyfly
