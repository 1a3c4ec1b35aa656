#include "law_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <map>
#include <set>
#include <utility>

#include "clocks.hpp"
#include "lp/polytope.hpp"

namespace polyfly::bench {
namespace {

constexpr std::size_t kCandidates = 20;
// A region lies on a side of a plane if a ball of this radius fits there [scaled].
constexpr double kReach = 1e-6;

using Regions = std::vector<char>;  // one flag for each

struct Split {
  std::uint32_t plane = 0;
  Regions below, above;
};

class Builder {
 public:
  Builder(const RegionMap& map, double time_limit)
      : p_(map.parameters().size()),
        regions_(map.regionCount()),
        end_(cpuSeconds() + time_limit),
        solver_(static_cast<int>(p_)) {
    scalePlanes(map);
    for (std::size_t r = 0; r < regions_; ++r) {
      const RegionView view = map.region(r);
      laws_.push_back(view.law);
      rows_.emplace_back();
      for (std::uint32_t k = 0; k < view.row_count; ++k)
        rows_.back()[planeOf(view.rows[k])] = view.rows[k] > 0 ? 1 : -1;
      for (const auto& [plane, sign] : rows_.back()) used_.insert(plane);
    }
  }

  LawTree build(const RegionMap& map) {
    LawTree tree;
    tree.parameters = p_;
    for (std::size_t i = 0; i < map.planeCount(); ++i)
      tree.planes.insert(tree.planes.end(), map.plane(i), map.plane(i) + p_ + 1);
    const Regions all(regions_, 1);
    for (const std::uint32_t plane : used_) whole_[plane] = split(plane, all, nullptr, {});
    std::deque<Cell> open;
    if (lawsOf(all) > 1) open.push_back({all, {}, -1, false});
    for (; !open.empty() && !late(); open.pop_front()) grow(open.front(), tree, open);
    tree.is_late = late();
    return tree;
  }

 private:
  using Path = std::vector<std::pair<std::uint32_t, int>>;  // planes, and the sides on which the cell lies

  struct Cell {
    Regions regions;
    Path path;
    int parent = -1;
    bool is_above = false;
  };

  static std::uint32_t planeOf(std::int32_t row) { return static_cast<std::uint32_t>(std::abs(row)) - 1; }
  bool late() const { return cpuSeconds() > end_; }

  void scalePlanes(const RegionMap& map) {
    for (std::size_t i = 0; i < map.planeCount(); ++i) {
      const double* const plane = map.plane(i);
      double bound = plane[p_], squared = 0.0;
      for (std::size_t j = 0; j < p_; ++j) {
        const Signal& signal = map.parameters()[j];
        planes_.push_back(plane[j] * 0.5 * (signal.upper - signal.lower));
        bound -= plane[j] * 0.5 * (signal.upper + signal.lower);
        squared += planes_.back() * planes_.back();
      }
      planes_.push_back(bound);
      for (std::size_t j = 0; j <= p_; ++j) planes_[i * (p_ + 1) + j] /= std::sqrt(squared);
    }
  }

  void add(std::vector<double>& rows, std::uint32_t plane, int side) const {
    for (std::size_t j = 0; j <= p_; ++j) rows.push_back(side * planes_[plane * (p_ + 1) + j]);
  }

  /// Whether the region reaches to the side of the plane (1: below, -1: above) within the cell.
  bool reaches(std::size_t region, std::uint32_t plane, int side, const Path& path) {
    std::vector<double> rows;
    for (std::size_t j = 0; j < p_; ++j) {
      for (const double sign : {1.0, -1.0}) {
        for (std::size_t k = 0; k < p_; ++k) rows.push_back(k == j ? sign : 0.0);
        rows.push_back(1.0);
      }
    }
    for (const auto& [bound, bound_side] : path) add(rows, bound, bound_side);
    for (const auto& [bound, bound_side] : rows_[region]) add(rows, bound, bound_side);
    add(rows, plane, side);
    std::vector<double> centre(p_);
    double radius = -1.0;
    return solver_.chebyshevInBox(rows.data(), static_cast<int>(rows.size() / (p_ + 1)), centre.data(),
                                  radius) &&
           radius > kReach;
  }

  /// Of the regions those on each side of a plane. `known`: sides that a larger cell has.
  Split split(std::uint32_t plane, const Regions& regions, const Split* known, const Path& path) {
    Split result{plane, Regions(regions_), Regions(regions_)};
    for (std::size_t r = 0; r < regions_ && !late(); ++r) {
      if (regions[r] == 0) continue;
      const auto row = rows_[r].find(plane);
      const auto side = [&](int sign, const Regions* before) -> char {
        if (row != rows_[r].end()) return row->second == sign;
        return (before == nullptr || (*before)[r] != 0) && reaches(r, plane, sign, path);
      };
      result.below[r] = side(1, known == nullptr ? nullptr : &known->below);
      result.above[r] = side(-1, known == nullptr ? nullptr : &known->above);
    }
    return result;
  }

  std::size_t lawsOf(const Regions& regions) const {
    std::set<std::uint32_t> laws;
    for (std::size_t r = 0; r < regions_; ++r) {
      if (regions[r] != 0) laws.insert(laws_[r]);
    }
    return laws.size();
  }

  std::array<std::size_t, 4> criteria(const Split& split) const {
    const auto count = [](const Regions& r) {
      return static_cast<std::size_t>(std::count(r.begin(), r.end(), 1));
    };
    std::size_t both = 0;
    for (std::size_t r = 0; r < regions_; ++r) both += split.below[r] != 0 && split.above[r] != 0 ? 1 : 0;
    const std::size_t below = lawsOf(split.below), above = lawsOf(split.above);
    return {std::max(below, above), both, std::max(count(split.below), count(split.above)),
            std::min(below, above)};
  }

  void grow(const Cell& cell, LawTree& tree, std::deque<Cell>& open) {
    const Split best = choose(cell);
    const int node = static_cast<int>(tree.nodes.size());
    tree.nodes.push_back({best.plane, 0, 0});
    if (cell.parent >= 0) child(tree, cell.parent, cell.is_above) = node;
    tree.depth = std::max(tree.depth, static_cast<std::uint32_t>(cell.path.size()) + 1);
    for (const bool is_above : {false, true}) {
      const Regions& regions = is_above ? best.above : best.below;
      if (lawsOf(regions) > 1) {
        open.push_back({regions, cell.path, node, is_above});
        open.back().path.emplace_back(best.plane, is_above ? -1 : 1);
      } else {
        const auto any = std::find(regions.begin(), regions.end(), 1);
        child(tree, node, is_above) = ~static_cast<std::int32_t>(
            any == regions.end() ? 0 : laws_[static_cast<std::size_t>(any - regions.begin())]);
      }
    }
  }

  static std::int32_t& child(LawTree& tree, int node, bool is_above) {
    LawTree::Node& parent = tree.nodes[static_cast<std::size_t>(node)];
    return is_above ? parent.above : parent.below;
  }

  Split choose(const Cell& cell) {
    std::set<std::uint32_t> planes;
    for (std::size_t r = 0; r < regions_; ++r) {
      if (cell.regions[r] == 0) continue;
      for (const auto& [plane, side] : rows_[r]) planes.insert(plane);
    }
    for (const auto& [plane, side] : cell.path) planes.erase(plane);
    std::vector<Split> splits;
    std::size_t fewest = regions_ + 1;
    for (const std::uint32_t plane : planes) {
      Split one = whole_[plane];
      for (std::size_t r = 0; r < regions_; ++r) {
        one.below[r] = one.below[r] != 0 && cell.regions[r] != 0;
        one.above[r] = one.above[r] != 0 && cell.regions[r] != 0;
      }
      const std::size_t laws = std::max(lawsOf(one.below), lawsOf(one.above));
      if (laws < fewest) splits.clear();
      fewest = std::min(fewest, laws);
      if (laws == fewest && splits.size() < kCandidates) splits.push_back(std::move(one));
    }
    if (splits.empty()) return {0, Regions(regions_), Regions(regions_)};  // overlap by rounding: any law
    for (Split& one : splits) one = split(one.plane, cell.regions, &one, cell.path);
    return *std::min_element(splits.begin(), splits.end(),
                             [this](const Split& a, const Split& b) { return criteria(a) < criteria(b); });
  }

  std::size_t p_, regions_;
  double end_;
  PolytopeSolver solver_;
  std::vector<double> planes_;  // scaled
  std::vector<std::uint32_t> laws_;
  std::vector<std::map<std::uint32_t, int>> rows_;  // planes of each region, 1: below
  std::set<std::uint32_t> used_;
  std::map<std::uint32_t, Split> whole_;  // of all regions, for each plane
};

}  // namespace

std::uint32_t LawTree::law(const double* theta) const {
  std::int32_t at = nodes.empty() ? ~0 : 0;
  while (at >= 0) {
    const Node& node = nodes[static_cast<std::size_t>(at)];
    const double* const plane = planes.data() + node.plane * (parameters + 1);
    double distance = -plane[parameters];
    for (std::size_t j = 0; j < parameters; ++j) distance += plane[j] * theta[j];
    at = distance <= 0.0 ? node.below : node.above;
  }
  return static_cast<std::uint32_t>(~at);
}

std::size_t LawTree::usedPlanes() const {
  std::set<std::uint32_t> used;
  for (const Node& node : nodes) used.insert(node.plane);
  return used.size();
}

LawTree buildLawTree(const RegionMap& map, double time_limit) { return Builder(map, time_limit).build(map); }

}  // namespace polyfly::bench
