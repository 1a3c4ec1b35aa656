#include "offline_mpt/search_tree.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "offline_mpt/polytope.hpp"

namespace polyfly {
namespace {

/// A region in a node's cell, with points of it that lie in the cell: they show on which sides of a plane it
/// reaches.
struct Member {
  std::uint32_t region = 0;
  std::vector<double> points;
};

using Members = std::vector<Member>;

constexpr unsigned kBelow = 1;
constexpr unsigned kAbove = 2;

/// What a plane would leave on its sides.
struct Estimate {
  std::size_t plane = 0;
  std::size_t below = 0;
  std::size_t above = 0;

  std::size_t fuller() const { return std::max(below, above); }
};

bool better(const Estimate& a, const Estimate& b) {
  if (a.fuller() != b.fuller()) return a.fuller() < b.fuller();
  if (a.below + a.above != b.below + b.above) return a.below + a.above < b.below + b.above;
  return a.plane < b.plane;
}

std::size_t planeOf(std::int32_t row) { return static_cast<std::size_t>(std::abs(row)) - 1; }

class TreeBuilder {
 public:
  TreeBuilder(const TreeRegions& regions, const TreeOptions& options)
      : regions_(regions),
        options_(options),
        leaf_regions_(choose(options.leaf_regions, 1, 8)),
        planes_tried_(choose(options.planes_tried, 6, 1)),
        p_(regions.p),
        width_(regions.p + 1),
        solver_(regions.p),
        point_(p_) {}

  SearchTree run() {
    Members all(regions_.rows.size());
    for (std::size_t r = 0; r < all.size(); ++r) {
      all[r].region = static_cast<std::uint32_t>(r);
      samplePoints(r, all[r].points);
    }
    tree_.root = grow(std::move(all), 0);
    return std::move(tree_);
  }

 private:
  static constexpr std::size_t kLarge = 1500;       // regions above which a tree is built more cheaply
  static constexpr std::size_t kManyMembers = 200;  // members above which estimates are trusted
  static constexpr std::size_t kHopeless = 64;      // planes tried before regions count as inseparable
  static constexpr std::size_t kPointsKept = 24;    // per member

  std::size_t choose(int wanted, std::size_t small, std::size_t large) const {
    if (wanted > 0) return static_cast<std::size_t>(wanted);
    return regions_.rows.size() > kLarge ? large : small;
  }

  void appendRow(std::int32_t row, std::vector<double>& out) const {
    const double* plane = regions_.planes.data() + planeOf(row) * width_;
    const double sign = row > 0 ? 1.0 : -1.0;
    for (int j = 0; j < width_; ++j) out.push_back(sign * plane[j]);
  }

  double distance(std::size_t plane, const double* point) const {
    const double* row = regions_.planes.data() + plane * width_;
    double value = -row[p_];
    for (int j = 0; j < p_; ++j) value += row[j] * point[j];
    return value;
  }

  // Extreme points of a region: along the axes, which gives its bounding box, and along its own normals.
  void samplePoints(std::size_t r, std::vector<double>& points) {
    gather(r);
    std::vector<double> direction(p_);
    std::vector<double> low(p_), high(p_);
    const auto add = [&] {
      if (!support(r, direction.data())) return false;
      points.insert(points.end(), point_.begin(), point_.end());
      return true;
    };
    for (int j = 0; j < p_; ++j) {
      std::fill(direction.begin(), direction.end(), 0.0);
      direction[j] = 1.0;
      high[j] = add() ? point_[j] : 1.0;
      direction[j] = -1.0;
      low[j] = add() ? point_[j] : -1.0;
    }
    for (const std::int32_t row : regions_.rows[r]) {
      const double* plane = regions_.planes.data() + planeOf(row) * width_;
      const double sign = row > 0 ? -1.0 : 1.0;  // away from the facet
      for (int j = 0; j < p_; ++j) direction[j] = sign * plane[j];
      add();
    }
    low_.insert(low_.end(), low.begin(), low.end());
    high_.insert(high_.end(), high.begin(), high.end());
  }

  void gather(std::size_t r) {
    rows_.clear();
    for (const std::int32_t own : regions_.rows[r]) appendRow(own, rows_);
  }

  // Extreme point of the rows gathered last, which describe region r.
  bool support(std::size_t r, const double* direction) {
    const int count = static_cast<int>(rows_.size()) / width_;
    return solver_.support(rows_.data(), count, regions_.centres.data() + r * p_, direction, point_.data());
  }

  std::uint32_t grow(Members members, std::uint32_t depth) {
    tree_.depth = std::max(tree_.depth, depth);
    Members below, above;
    std::size_t plane = 0;
    if (members.size() <= leaf_regions_ || !choose(members, plane, below, above)) return leaf(members);
    Members().swap(members);
    const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.push_back({static_cast<std::uint32_t>(plane), 0, 0});
    path_.push_back(static_cast<std::int32_t>(plane) + 1);
    const std::uint32_t first = grow(std::move(below), depth + 1);
    path_.back() = -path_.back();
    const std::uint32_t second = grow(std::move(above), depth + 1);
    path_.pop_back();
    tree_.nodes[index].below = first;
    tree_.nodes[index].above = second;
    return index;
  }

  std::uint32_t leaf(const Members& members) {
    const auto index = static_cast<std::uint32_t>(tree_.leaves.size());
    tree_.leaves.push_back(
        {static_cast<std::uint32_t>(tree_.candidates.size()), static_cast<std::uint32_t>(members.size())});
    for (const Member& member : members) tree_.candidates.push_back(member.region);
    return index | MapContent::kLeaf;
  }

  // The best of the planes that bound members, by exact splits of those that look best.
  bool choose(Members& members, std::size_t& plane, Members& below, Members& above) {
    std::vector<Estimate> estimates = estimate(members);
    std::sort(estimates.begin(), estimates.end(), better);
    const bool many = members.size() > kManyMembers;  // estimates are good while cells are large
    const std::size_t tried = many ? 1 : planes_tried_;
    std::vector<unsigned char> sides, best_sides;
    Estimate best;
    bool found = false;
    for (std::size_t i = 0; i < estimates.size() && i < kHopeless; ++i) {
      if (i >= tried && found) break;
      if (found && estimates[i].fuller() > best.fuller()) break;
      const Estimate exact = splitExactly(members, estimates[i].plane, sides);
      if (exact.fuller() >= members.size()) continue;
      if (!found || better(exact, best)) {
        best = exact;
        best_sides = sides;
        found = true;
      }
    }
    if (!found) return false;
    plane = best.plane;
    distribute(members, plane, best_sides, below, above);
    return true;
  }

  std::vector<Estimate> estimate(const Members& members) const {
    std::vector<std::size_t> planes;
    for (const Member& member : members) {
      for (const std::int32_t row : regions_.rows[member.region]) planes.push_back(planeOf(row));
    }
    std::sort(planes.begin(), planes.end());
    planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
    planes.erase(std::remove_if(planes.begin(), planes.end(), [&](std::size_t h) { return onPath(h); }),
                 planes.end());
    const std::size_t stride = planes.size() / options_.planes_scored + 1;
    std::vector<Estimate> estimates;
    for (std::size_t i = 0; i < planes.size(); i += stride) {
      Estimate entry;
      entry.plane = planes[i];
      for (const Member& member : members) {
        const unsigned sides = seenSides(member, planes[i]);
        if (sides & kBelow) ++entry.below;
        if (sides & kAbove) ++entry.above;
      }
      estimates.push_back(entry);
    }
    return estimates;
  }

  bool onPath(std::size_t plane) const {
    return std::any_of(path_.begin(), path_.end(), [&](std::int32_t row) { return planeOf(row) == plane; });
  }

  // Sides that the region cannot reach because its bounding box does not.
  unsigned boxSides(std::uint32_t r, std::size_t plane) const {
    const double* row = regions_.planes.data() + plane * width_;
    const double* low = low_.data() + static_cast<std::size_t>(r) * p_;
    const double* high = high_.data() + static_cast<std::size_t>(r) * p_;
    double least = -row[p_];
    double greatest = -row[p_];
    for (int j = 0; j < p_; ++j) {
      least += row[j] * (row[j] > 0.0 ? low[j] : high[j]);
      greatest += row[j] * (row[j] > 0.0 ? high[j] : low[j]);
    }
    return (least < -options_.side_tolerance ? kBelow : 0u) |
           (greatest > options_.side_tolerance ? kAbove : 0u);
  }

  // Sides on which the member is known to have points in this cell.
  unsigned seenSides(const Member& member, std::size_t plane) const {
    const unsigned possible = boxSides(member.region, plane);
    unsigned sides = 0;
    for (std::size_t i = 0; i < member.points.size() && sides != possible; i += p_) {
      const double value = distance(plane, member.points.data() + i);
      if (value < -options_.side_tolerance) sides |= kBelow;
      if (value > options_.side_tolerance) sides |= kAbove;
    }
    return sides;
  }

  Estimate splitExactly(Members& members, std::size_t plane, std::vector<unsigned char>& sides) {
    Estimate result;
    result.plane = plane;
    sides.assign(members.size(), 0);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const unsigned reached = exactSides(members[i], plane);
      sides[i] = static_cast<unsigned char>(reached);
      if (reached & kBelow) ++result.below;
      if (reached & kAbove) ++result.above;
    }
    return result;
  }

  unsigned exactSides(Member& member, std::size_t plane) {
    const auto row = static_cast<std::int32_t>(plane) + 1;
    for (const std::int32_t own : regions_.rows[member.region]) {
      if (own == row) return kBelow;
      if (own == -row) return kAbove;
    }
    unsigned sides = seenSides(member, plane);
    const unsigned open = boxSides(member.region, plane) & ~sides;
    if ((open & kBelow) && reaches(member, -1.0, plane)) sides |= kBelow;
    if ((open & kAbove) && reaches(member, 1.0, plane)) sides |= kAbove;
    return sides;
  }

  // Whether the member's part in this cell has more than a touch on one side of the plane. A point found
  // there is kept.
  bool reaches(Member& member, double side, std::size_t plane) {
    gather(member.region);
    const double* normal = regions_.planes.data() + plane * width_;
    std::vector<double> direction(normal, normal + p_);
    for (double& entry : direction) entry *= side;
    if (support(member.region, direction.data()) &&
        side * distance(plane, point_.data()) <= options_.side_tolerance) {
      return false;  // not even outside the cell
    }
    for (const std::int32_t step : path_) appendRow(step, rows_);
    appendRow(side < 0.0 ? static_cast<std::int32_t>(plane) + 1 : -static_cast<std::int32_t>(plane) - 1,
              rows_);
    const double* centre = member.points.empty() ? regions_.centres.data() + std::size_t{member.region} * p_
                                                 : member.points.data() + member.points.size() - p_;
    std::copy_n(centre, p_, point_.begin());
    double radius = 0.0;
    const int count = static_cast<int>(rows_.size()) / width_;
    if (!solver_.chebyshev(rows_.data(), count, point_.data(), radius)) return true;  // keep it on both sides
    if (radius <= options_.side_tolerance) return false;
    if (member.points.size() < kPointsKept * p_) {
      member.points.insert(member.points.end(), point_.begin(), point_.end());
    } else {
      std::copy(point_.begin(), point_.end(), member.points.end() - p_);
    }
    return true;
  }

  void distribute(Members& members, std::size_t plane, const std::vector<unsigned char>& sides,
                  Members& below, Members& above) const {
    for (std::size_t i = 0; i < members.size(); ++i) {
      Member& member = members[i];
      if (sides[i] == kBelow) {
        below.push_back(std::move(member));
      } else if (sides[i] == kAbove) {
        above.push_back(std::move(member));
      } else {
        Member parts[2];
        for (std::size_t k = 0; k < member.points.size(); k += p_) {
          const double* point = member.points.data() + k;
          const double value = distance(plane, point);
          if (value <= 0.0) parts[0].points.insert(parts[0].points.end(), point, point + p_);
          if (value >= 0.0) parts[1].points.insert(parts[1].points.end(), point, point + p_);
        }
        parts[0].region = parts[1].region = member.region;
        below.push_back(std::move(parts[0]));
        above.push_back(std::move(parts[1]));
      }
    }
  }

  const TreeRegions& regions_;
  const TreeOptions& options_;
  std::size_t leaf_regions_;
  std::size_t planes_tried_;
  int p_;
  int width_;
  PolytopeSolver solver_;
  std::vector<double> low_, high_;  // bounding boxes
  std::vector<std::int32_t> path_;
  std::vector<double> rows_;
  std::vector<double> point_;
  SearchTree tree_;
};

}  // namespace

SearchTree buildTree(const TreeRegions& regions, const TreeOptions& options) {
  return TreeBuilder(regions, options).run();
}

}  // namespace polyfly
