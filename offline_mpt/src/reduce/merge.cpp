#include "reduce/merge.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

namespace polyfly {
namespace {

/// A union of pieces that is convex, by number.
struct Union {
  ConvexCell piece;
  std::vector<std::size_t> members;
  std::size_t id = 0;
};

std::vector<std::size_t> joined(const std::vector<std::size_t>& a, const std::vector<std::size_t>& b) {
  std::vector<std::size_t> result;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

/// The half-spaces of some pieces that hold on all of them, with the box, without redundant ones.
class Envelopes {
 public:
  Envelopes(CellGeometry& geometry, std::vector<ConvexCell>& pieces, const RowList& box, double slack)
      : geometry_(geometry), pieces_(pieces), box_(box), slack_(slack), known_(pieces.size()) {
    for (const ConvexCell& piece : pieces) rows_.insert(rows_.end(), piece.rows.begin(), piece.rows.end());
    std::sort(rows_.begin(), rows_.end());
    rows_.erase(std::unique(rows_.begin(), rows_.end()), rows_.end());
  }

  ConvexCell of(const std::vector<std::size_t>& members) {
    std::vector<std::size_t> pool;
    for (const std::size_t member : members) {
      for (const std::int32_t row : pieces_[member].rows)
        pool.push_back(
            static_cast<std::size_t>(std::lower_bound(rows_.begin(), rows_.end(), row) - rows_.begin()));
    }
    std::sort(pool.begin(), pool.end());
    pool.erase(std::unique(pool.begin(), pool.end()), pool.end());
    ConvexCell result;
    for (const std::size_t row : pool) {
      const bool holds = std::all_of(members.begin(), members.end(),
                                     [&](std::size_t member) { return holdsOn(row, member); });
      if (holds) result.rows.push_back(rows_[row]);
    }
    for (const std::int32_t row : box_) {
      if (std::find(result.rows.begin(), result.rows.end(), row) == result.rows.end())
        result.rows.push_back(row);
    }
    result.centre = pieces_[members.front()].centre;
    geometry_.describe(result);
    if (result.radius > 0.0) result.rows = geometry_.minimal(result);
    return result;
  }

 private:
  bool holdsOn(std::size_t row, std::size_t piece) {
    constexpr char kUnknown = 0, kYes = 1, kNo = 2;
    std::vector<char>& known = known_[piece];
    if (known.empty()) known.assign(rows_.size(), kUnknown);
    if (known[row] == kUnknown)
      known[row] = geometry_.holdsOn(rows_[row], pieces_[piece], slack_) ? kYes : kNo;
    return known[row] == kYes;
  }

  CellGeometry& geometry_;
  std::vector<ConvexCell>& pieces_;
  const RowList& box_;
  double slack_;
  // Rows of all pieces, sorted.
  RowList rows_;
  // Whether each row holds on each piece, by piece and row.
  std::vector<std::vector<char>> known_;
};

class GreedyMerger {
 public:
  GreedyMerger(CellGeometry& geometry, const MergeTask& task)
      : geometry_(geometry),
        task_(task),
        p_(static_cast<std::size_t>(geometry.planes().p)),
        pieces_(task.pieces),
        envelopes_(geometry, pieces_, task.box, task.slack) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) unions_.push_back({pieces_[i], {i}, i});
    next_id_ = pieces_.size();
  }

  std::vector<ConvexCell> run() {
    for (std::size_t i = 0; i < unions_.size(); ++i) {
      for (std::size_t j = 0; j < unions_.size(); ++j) {
        if (j == i || !tryPair(i, j)) continue;
        // A pair that could not be joined before may be joined now.
        i = 0;
        j = static_cast<std::size_t>(-1);
      }
    }
    dropCovered();
    std::vector<ConvexCell> result;
    for (Union& one : unions_) result.push_back(std::move(one.piece));
    return result;
  }

 private:
  bool tryPair(std::size_t i, std::size_t j) {
    const auto pair = std::minmax(unions_[i].id, unions_[j].id);
    if (!tried_.insert(pair).second || !boxesMeet(unions_[i], unions_[j])) return false;
    Union candidate;
    candidate.members = joined(unions_[i].members, unions_[j].members);
    candidate.piece = envelopes_.of(candidate.members);
    if (!inUnion(candidate.piece)) return false;
    candidate.id = next_id_++;
    unions_[std::min(i, j)] = std::move(candidate);
    unions_.erase(unions_.begin() + static_cast<std::ptrdiff_t>(std::max(i, j)));
    return true;
  }

  bool inUnion(const ConvexCell& piece) {
    if (piece.radius <= 0.0) return false;
    for (std::size_t k = 0; k < task_.laws->size(); ++k) {
      const bool is_foreign = (*task_.laws)[k] != task_.law;
      if (is_foreign && geometry_.holds(piece.rows, task_.centres->data() + k * p_, -task_.slack))
        return false;
    }
    std::vector<const RowList*> cover;
    for (const ConvexCell& other : pieces_) cover.push_back(&other.rows);
    return geometry_.covered(piece, cover, task_.slack);
  }

  /// Regions that do not touch each other's bounding box are far apart.
  bool boxesMeet(const Union& a, const Union& b) {
    for (std::size_t axis = 0; axis < p_; ++axis) {
      const auto [low_a, high_a] = range(a, axis);
      const auto [low_b, high_b] = range(b, axis);
      if (low_a > high_b + task_.slack || low_b > high_a + task_.slack) return false;
    }
    return true;
  }

  std::pair<double, double> range(const Union& one, std::size_t axis) {
    if (ranges_.empty()) findRanges();
    std::pair<double, double> result = ranges_[one.members.front() * p_ + axis];
    for (const std::size_t member : one.members) {
      const auto& [low, high] = ranges_[member * p_ + axis];
      result = {std::min(result.first, low), std::max(result.second, high)};
    }
    return result;
  }

  void findRanges() {
    std::vector<double> direction(p_), point(p_);
    for (ConvexCell& piece : pieces_) {
      for (std::size_t axis = 0; axis < p_; ++axis) {
        std::fill(direction.begin(), direction.end(), 0.0);
        direction[axis] = 1.0;
        const double high = geometry_.support(piece, direction.data(), point.data()) ? point[axis] : 1.0;
        direction[axis] = -1.0;
        const double low = geometry_.support(piece, direction.data(), point.data()) ? point[axis] : -1.0;
        ranges_.emplace_back(low, high);
      }
    }
  }

  void dropCovered() {
    for (std::size_t i = unions_.size(); i-- > 0 && unions_.size() > 1;) {
      std::vector<const RowList*> others;
      for (std::size_t j = 0; j < unions_.size(); ++j) {
        if (j != i) others.push_back(&unions_[j].piece.rows);
      }
      if (geometry_.covered(unions_[i].piece, others, task_.slack))
        unions_.erase(unions_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }

  CellGeometry& geometry_;
  const MergeTask& task_;
  std::size_t p_;
  // The pieces of the task, with the extreme points found so far.
  std::vector<ConvexCell> pieces_;
  Envelopes envelopes_;
  std::vector<Union> unions_;
  std::size_t next_id_ = 0;
  std::set<std::pair<std::size_t, std::size_t>> tried_;
  // Range of each piece along each axis.
  std::vector<std::pair<double, double>> ranges_;
};

}  // namespace

std::vector<ConvexCell> mergeGreedily(CellGeometry& geometry, const MergeTask& task) {
  return GreedyMerger(geometry, task).run();
}

}  // namespace polyfly
