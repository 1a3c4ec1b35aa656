#include "offline_mpt/search_tree.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "offline_mpt/polytope.hpp"

namespace polyfly {
namespace {

/// Regions on each side of a plane, and what they cost.
struct Split {
  std::size_t plane = 0;
  std::vector<std::uint32_t> below;
  std::vector<std::uint32_t> above;

  std::size_t fuller() const { return std::max(below.size(), above.size()); }
  std::size_t total() const { return below.size() + above.size(); }
};

bool better(const Split& a, const Split& b) {
  if (a.fuller() != b.fuller()) return a.fuller() < b.fuller();
  if (a.total() != b.total()) return a.total() < b.total();
  return a.plane < b.plane;
}

std::size_t planeOf(std::int32_t row) { return static_cast<std::size_t>(std::abs(row)) - 1; }

class TreeBuilder {
 public:
  TreeBuilder(const TreeRegions& regions, const TreeOptions& options)
      : regions_(regions), options_(options), p_(regions.p), width_(regions.p + 1), solver_(regions.p) {
    points_.resize(regions.rows.size());
    for (std::size_t r = 0; r < regions.rows.size(); ++r) samplePoints(r);
  }

  SearchTree run() {
    std::vector<std::uint32_t> all(regions_.rows.size());
    for (std::size_t r = 0; r < all.size(); ++r) all[r] = static_cast<std::uint32_t>(r);
    tree_.root = grow(all, 0);
    return std::move(tree_);
  }

 private:
  // Extreme points of the region along its own normals and the axes: they tell most planes' sides without a
  // program.
  void samplePoints(std::size_t r) {
    std::vector<double> rows;
    for (const std::int32_t row : regions_.rows[r]) appendRow(row, rows);
    const int count = static_cast<int>(regions_.rows[r].size());
    const double* centre = regions_.centres.data() + r * p_;
    std::vector<double> direction(p_), point(p_);
    const auto add = [&] {
      if (!solver_.support(rows.data(), count, centre, direction.data(), point.data())) return;
      points_[r].insert(points_[r].end(), point.begin(), point.end());
    };
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < p_; ++j) direction[j] = rows[static_cast<std::size_t>(i) * width_ + j];
      add();
      for (int j = 0; j < p_; ++j) direction[j] = -direction[j];
      add();
    }
    for (int j = 0; j < 2 * p_; ++j) {
      std::fill(direction.begin(), direction.end(), 0.0);
      direction[j / 2] = j % 2 == 0 ? 1.0 : -1.0;
      add();
    }
  }

  void appendRow(std::int32_t row, std::vector<double>& out) const {
    const double* plane = regions_.planes.data() + planeOf(row) * width_;
    const double sign = row > 0 ? 1.0 : -1.0;
    for (int j = 0; j < width_; ++j) out.push_back(sign * plane[j]);
  }

  std::uint32_t grow(const std::vector<std::uint32_t>& members, std::uint32_t depth) {
    tree_.depth = std::max(tree_.depth, depth);
    Split split;
    if (members.size() <= 1 || !choose(members, split)) return leaf(members);
    const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.push_back({static_cast<std::uint32_t>(split.plane), 0, 0});
    path_.push_back(static_cast<std::int32_t>(split.plane) + 1);
    const std::uint32_t below = grow(split.below, depth + 1);
    path_.back() = -path_.back();
    const std::uint32_t above = grow(split.above, depth + 1);
    path_.pop_back();
    tree_.nodes[index].below = below;
    tree_.nodes[index].above = above;
    return index;
  }

  std::uint32_t leaf(const std::vector<std::uint32_t>& members) {
    const auto index = static_cast<std::uint32_t>(tree_.leaves.size());
    tree_.leaves.push_back(
        {static_cast<std::uint32_t>(tree_.candidates.size()), static_cast<std::uint32_t>(members.size())});
    tree_.candidates.insert(tree_.candidates.end(), members.begin(), members.end());
    return index | MapContent::kLeaf;
  }

  // The best of the planes that bound members, by exact splits of those that look best.
  bool choose(const std::vector<std::uint32_t>& members, Split& best) {
    std::vector<Split> estimates = estimate(members);
    const std::size_t tried = std::min<std::size_t>(options_.planes_tried, estimates.size());
    std::partial_sort(estimates.begin(), estimates.begin() + static_cast<std::ptrdiff_t>(tried),
                      estimates.end(), better);
    bool found = false;
    for (std::size_t i = 0; i < estimates.size(); ++i) {
      if (i >= tried && found) break;
      Split exact;
      exact.plane = estimates[i].plane;
      splitExactly(members, exact);
      if (exact.fuller() >= members.size()) continue;
      if (!found || better(exact, best)) best = std::move(exact);
      found = true;
    }
    return found;
  }

  std::vector<Split> estimate(const std::vector<std::uint32_t>& members) const {
    std::vector<std::size_t> planes;
    for (const std::uint32_t r : members) {
      for (const std::int32_t row : regions_.rows[r]) planes.push_back(planeOf(row));
    }
    std::sort(planes.begin(), planes.end());
    planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
    planes.erase(std::remove_if(planes.begin(), planes.end(), [&](std::size_t h) { return onPath(h); }),
                 planes.end());
    const std::size_t stride = planes.size() / options_.planes_scored + 1;
    std::vector<Split> splits;
    for (std::size_t i = 0; i < planes.size(); i += stride) {
      Split split;
      split.plane = planes[i];
      for (const std::uint32_t r : members) {
        const unsigned sides = estimatedSides(r, planes[i]);
        if (sides & kBelow) split.below.push_back(r);
        if (sides & kAbove) split.above.push_back(r);
      }
      splits.push_back(std::move(split));
    }
    return splits;
  }

  bool onPath(std::size_t plane) const {
    return std::any_of(path_.begin(), path_.end(), [&](std::int32_t row) { return planeOf(row) == plane; });
  }

  unsigned estimatedSides(std::uint32_t r, std::size_t h) const {
    const double* plane = regions_.planes.data() + h * width_;
    unsigned sides = 0;
    for (std::size_t i = 0; i < points_[r].size() && sides != (kBelow | kAbove); i += p_) {
      double value = -plane[p_];
      for (int j = 0; j < p_; ++j) value += plane[j] * points_[r][i + j];
      if (value < -options_.side_tolerance) sides |= kBelow;
      if (value > options_.side_tolerance) sides |= kAbove;
    }
    return sides;
  }

  void splitExactly(const std::vector<std::uint32_t>& members, Split& split) {
    const auto below = static_cast<std::int32_t>(split.plane) + 1;
    for (const std::uint32_t r : members) {
      const auto& rows = regions_.rows[r];
      const bool bounded_above = std::find(rows.begin(), rows.end(), below) != rows.end();
      const bool bounded_below = std::find(rows.begin(), rows.end(), -below) != rows.end();
      if (!bounded_below && (bounded_above || reaches(r, below))) split.below.push_back(r);
      if (!bounded_above && (bounded_below || reaches(r, -below))) split.above.push_back(r);
    }
  }

  // Whether the part of region r in this node's cell and in the half-space `row` is full-dimensional.
  bool reaches(std::uint32_t r, std::int32_t row) {
    rows_.clear();
    for (const std::int32_t own : regions_.rows[r]) appendRow(own, rows_);
    for (const std::int32_t step : path_) appendRow(step, rows_);
    appendRow(row, rows_);
    centre_.assign(regions_.centres.begin() + static_cast<std::ptrdiff_t>(r) * p_,
                   regions_.centres.begin() + static_cast<std::ptrdiff_t>(r + 1) * p_);
    double radius = 0.0;
    const int count = static_cast<int>(rows_.size()) / width_;
    if (!solver_.chebyshev(rows_.data(), count, centre_.data(), radius))
      return true;  // keep it on both sides
    return radius > options_.side_tolerance;
  }

  static constexpr unsigned kBelow = 1;
  static constexpr unsigned kAbove = 2;

  const TreeRegions& regions_;
  const TreeOptions& options_;
  int p_;
  int width_;
  PolytopeSolver solver_;
  std::vector<std::vector<double>> points_;
  std::vector<std::int32_t> path_;
  std::vector<double> rows_;
  std::vector<double> centre_;
  SearchTree tree_;
};

}  // namespace

SearchTree buildTree(const TreeRegions& regions, const TreeOptions& options) {
  return TreeBuilder(regions, options).run();
}

}  // namespace polyfly
